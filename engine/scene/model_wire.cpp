// One list of members serves the writer and the reader: pass(wire, x) sends or receives x.
#include "engine/scene/model_wire.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <type_traits>

#include "engine/scene/model_check.h"

namespace rivulet {
namespace {

constexpr std::array<char, 8> kModelMagic = {'R', 'V', 'M', 'O', 'D', 'E', 'L', '1'};
constexpr std::array<char, 8> kFaultMagic = {'R', 'V', 'F', 'A', 'U', 'L', 'T', '1'};
constexpr std::array<char, 8> kEnd = {'R', 'V', 'E', 'N', 'D', '-', '-', '1'};
constexpr size_t kLongestName = 8192, kLongestFault = 400;  // bytes
constexpr const char* kNoAnswer =
    "cannot be read: the answer of its reader is damaged; the file is damaged or hostile: export it again, for example as glTF";

// No byte of a name may act on a terminal. The bytes 0x80 to 0x9F are control characters after 0xC2 (UTF-8).
void makeReadable(std::string& text) {
    for (size_t k = 0; k < text.size(); ++k) {
        const auto c = static_cast<unsigned char>(text[k]);
        const bool second = k > 0 && static_cast<unsigned char>(text[k - 1]) == 0xC2U && c >= 0x80U && c <= 0x9FU;
        if (c < 0x20U || c == 0x7FU || second) text[k] = '?';
    }
}

class WireWriter {
  public:
    explicit WireWriter(const WireSink& sink) : sink_(sink) {}

    template <class T>
    bool plain(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        return bytes(std::as_bytes(std::span(&value, 1)));
    }
    template <class T>
    bool array(const std::vector<T>& items) {
        static_assert(std::is_trivially_copyable_v<T>);
        return plain(uint64_t{items.size()}) && bytes(std::as_bytes(std::span(items)));
    }
    template <class T, class Fn>
    bool list(const std::vector<T>& items, const Fn& fn) {
        return plain(uint64_t{items.size()}) && std::ranges::all_of(items, fn);
    }
    bool text(const std::string& value) {
        const std::string_view kept = std::string_view(value).substr(0, kLongestName);
        return plain(static_cast<uint32_t>(kept.size())) && bytes(std::as_bytes(std::span(kept)));
    }
    // A number in the list of images that was sent before; 0: none.
    bool image(const std::shared_ptr<const Image>& value) { return plain(value ? images_.at(value.get()) : uint32_t{0}); }
    void add(const Image* image) { images_.emplace(image, static_cast<uint32_t>(images_.size() + 1)); }
    bool flush() {
        const bool sent = buffer_.empty() || sink_(buffer_);
        buffer_.clear();
        return sent;
    }

  private:
    bool bytes(std::span<const std::byte> all) {
        constexpr size_t kSmall = size_t{1} << 16U;
        if (all.size() >= kSmall) return flush() && sink_(all);
        buffer_.insert(buffer_.end(), all.begin(), all.end());
        return buffer_.size() < kSmall || flush();
    }
    const WireSink& sink_;
    std::vector<std::byte> buffer_;
    std::map<const Image*, uint32_t> images_;
};

class WireReader {
  public:
    explicit WireReader(std::span<const std::byte> all) : left_(all) {}

    template <class T>
    bool plain(T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        return bytes(std::as_writable_bytes(std::span(&value, 1)));
    }
    bool plain(bool& value) {
        uint8_t byte = 0;
        if (!plain(byte) || byte > 1) return false;
        value = byte == 1;
        return true;
    }
    template <class T>
    bool array(std::vector<T>& items) {
        static_assert(std::is_trivially_copyable_v<T>);
        uint64_t count = 0;
        if (!plain(count) || count > left_.size() / sizeof(T)) return false;
        items.resize(count);
        return bytes(std::as_writable_bytes(std::span(items)));
    }
    // Every item takes at least one byte, and memory only once it is read.
    template <class T, class Fn>
    bool list(std::vector<T>& items, const Fn& fn) {
        uint64_t count = 0;
        if (!plain(count) || count > left_.size()) return false;
        for (uint64_t k = 0; k < count; ++k)
            if (!fn(items.emplace_back())) return false;
        return true;
    }
    bool text(std::string& value) {
        uint32_t count = 0;
        if (!plain(count) || count > kLongestName || count > left_.size()) return false;
        value.assign(reinterpret_cast<const char*>(left_.data()), count);
        left_ = left_.subspan(count);
        makeReadable(value);
        return true;
    }
    bool image(std::shared_ptr<const Image>& value) {
        uint32_t number = 0;
        if (!plain(number) || number > images_.size()) return false;
        if (number > 0) value = images_[number - 1];
        return true;
    }
    void add(std::shared_ptr<const Image> image) { images_.push_back(std::move(image)); }
    bool ended() const { return left_.empty(); }
    std::span<const std::byte> left() const { return left_; }

  private:
    bool bytes(std::span<std::byte> into) {
        if (into.size() > left_.size()) return false;
        if (!into.empty()) std::memcpy(into.data(), left_.data(), into.size());
        left_ = left_.subspan(into.size());
        return true;
    }
    std::span<const std::byte> left_;
    std::vector<std::shared_ptr<const Image>> images_;
};

// Below, `Wire` is one of the two, and an object is const for the writer.
template <class Wire, class T>
bool passImage(Wire& w, T& image) {
    return w.text(image.name) && w.plain(image.width) && w.plain(image.height) && w.array(image.rgba);
}

template <class Wire, class T>
bool passMaterial(Wire& w, T& m) {
    return w.plain(m.baseColour) && w.plain(m.roughness) && w.plain(m.metallic) && w.plain(m.emission) && w.plain(m.opacity) &&
           w.plain(m.blended) && w.plain(m.cutoff) && w.plain(m.doubleSided) && w.image(m.colour) && w.image(m.metallicRoughness) &&
           w.image(m.normals) && w.image(m.occlusion) && w.image(m.glow);
}

template <class Wire, class T>
bool passPart(Wire& w, T& part) {
    return w.text(part.name) && w.text(part.mesh.name) && w.array(part.mesh.positions) && w.array(part.mesh.normals) &&
           w.array(part.mesh.uvs) && w.array(part.mesh.indices) && passMaterial(w, part.material) && w.text(part.materialName) &&
           w.plain(part.hasMaterial) && w.plain(part.node) &&
           w.list(part.morphs, [&w](auto& morph) { return w.text(morph.name) && w.array(morph.vertices) && w.array(morph.offsets); }) &&
           w.array(part.restWeights) && w.array(part.bones) && w.array(part.grips);
}

template <class Wire, class T>
bool passClip(Wire& w, T& clip) {
    const auto keys = [&w](auto& k) { return w.array(k.times) && w.array(k.values); };
    return w.text(clip.name) && w.plain(clip.seconds) &&
           w.list(clip.nodes, [&](auto& t) { return w.plain(t.node) && keys(t.position) && keys(t.rotation) && keys(t.scale); }) &&
           w.list(clip.morphs, [&](auto& t) {
               return w.plain(t.node) && w.array(t.weights.times) && w.list(t.weights.values, [&w](auto& v) { return w.array(v); });
           });
}

template <class Wire, class T>
bool passModel(Wire& w, T& model) {
    return w.list(model.nodes, [&w](auto& n) { return w.text(n.name) && w.plain(n.local) && w.plain(n.parent); }) &&
           w.list(model.parts, [&w](auto& p) { return passPart(w, p); }) && w.list(model.clips, [&w](auto& c) { return passClip(w, c); }) &&
           w.list(model.cameras,
                  [&w](auto& c) {
                      return w.text(c.name) && w.plain(c.node) && w.plain(c.position) && w.plain(c.direction) && w.plain(c.fieldOfView);
                  }) &&
           w.list(model.lights, [&w](auto& l) { return w.text(l.name) && w.plain(l.node) && w.plain(l.direction) && w.plain(l.colour); });
}

// The images of all materials, each once.
std::vector<const Image*> imagesOf(const Model& model) {
    std::vector<const Image*> all;
    for (const ModelPart& part : model.parts)
        for (const auto* image : {&part.material.colour, &part.material.metallicRoughness, &part.material.normals, &part.material.occlusion,
                                  &part.material.glow})
            if (*image && std::ranges::find(all, image->get()) == all.end()) all.push_back(image->get());
    return all;
}

}  // namespace

bool sendModel(const Model& model, const WireSink& sink) {
    WireWriter w(sink);
    const std::vector<const Image*> images = imagesOf(model);
    for (const Image* image : images) w.add(image);
    return w.plain(kModelMagic) && w.list(images, [&w](const Image* image) { return passImage(w, *image); }) && passModel(w, model) &&
           w.plain(kEnd) && w.flush();
}

bool sendFault(std::string_view phrase, const WireSink& sink) {
    WireWriter w(sink);
    return w.plain(kFaultMagic) && w.text(std::string(phrase)) && w.plain(kEnd) && w.flush();
}

Result<Model> receiveModel(std::span<const std::byte> bytes) {
    WireReader w(bytes);
    std::array<char, 8> magic{}, end{};
    if (!w.plain(magic)) return badInput(kNoAnswer);
    if (magic == kFaultMagic) {
        std::string phrase;
        if (!w.text(phrase) || phrase.empty() || !w.plain(end) || end != kEnd || !w.ended()) return badInput(kNoAnswer);
        if (phrase.size() > kLongestFault) phrase = phrase.substr(0, kLongestFault) + "...";
        return badInput(phrase);
    }
    if (magic != kModelMagic) return badInput(kNoAnswer);
    std::vector<Image> images;
    if (!w.list(images, [&w](Image& image) { return passImage(w, image); })) return badInput(kNoAnswer);
    for (Image& image : images) w.add(std::make_shared<const Image>(std::move(image)));
    Model model;
    if (!passModel(w, model) || !w.plain(end) || end != kEnd || !w.ended()) return badInput(kNoAnswer);
    if (std::string fault = faultOf(model); !fault.empty()) return badInput(std::move(fault));
    return model;
}

}  // namespace rivulet
