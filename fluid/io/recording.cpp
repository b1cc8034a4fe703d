#include "fluid/io/recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <new>

#include "engine/core/assert.h"
#include "engine/core/file_system.h"
#include "engine/core/input_file.h"
#include "fluid/sim/sources/dry.h"
#include "fluid/voxel/packed_array.h"

namespace rivulet {

namespace {

// The first byte is no letter and a line end follows, so that a transfer as text is detected.
constexpr std::array<uint8_t, 8> kMagic = {0x89, 'R', 'R', 'E', 'C', '\r', '\n', 0x1A};
constexpr uint32_t kByteOrder = 0x01020304, kOtherByteOrder = 0x04030201;
constexpr uint32_t kVersion = 1;
constexpr uint32_t kMostAbout = 1U << 20U;  // bytes of the text
constexpr uint32_t kFrame = 0x4D415246, kIndex = 0x58444E49;
constexpr size_t kArrays = 12;
constexpr uint32_t kHalves = 1, kDryBit = 8;
constexpr std::string_view kRunVersion = "\nrun.version = ", kRunDevice = "\nrun.device = ", kRunScene = "\nrun.scene = ";
constexpr float kMostRecorded = 1e15F;  // m, or any other unit: the square still is a float

struct Header {
    std::array<uint8_t, 8> magic;
    uint32_t byteOrder, version;
    uint32_t aboutBytes, zero;
    uint64_t checksum;  // of all members above, then of the text that follows
};
static_assert(sizeof(Header) == 32 && std::is_trivially_copyable_v<Header>);

struct FrameHead {
    uint32_t mark, number;
    double time;
    uint64_t packedBytes, bytes;  // in the file; unpacked
    uint64_t checksum;            // of the packed bytes
    uint64_t headChecksum;        // of all above
};
static_assert(sizeof(FrameHead) == 48 && std::is_trivially_copyable_v<FrameHead>);

struct IndexHead {
    uint32_t mark, count;  // count: of the offsets that follow, then the tail
};
static_assert(sizeof(IndexHead) == 8);

struct Tail {
    uint64_t index;     // where it is
    uint64_t checksum;  // of the index's head and offsets, and of the number above
};
static_assert(sizeof(Tail) == 16);

// The head of a frame's bytes.
struct Counts {
    std::array<uint64_t, kArrays> items;
    Bounds box;
    float spacing;
    uint32_t flags;  // 1: halves; from kDryBit on: the number of dry volumes, whose array is the last
};
static_assert(sizeof(Counts) == 8 * kArrays + 32 && std::is_trivially_copyable_v<Counts>);

template <class T>
std::span<const std::byte> bytesOf(const T& one) {
    return std::as_bytes(std::span(&one, 1));
}

uint64_t headSum(const FrameHead& head) { return checksum(bytesOf(head).first(offsetof(FrameHead, headChecksum))); }

uint64_t headerSum(const Header& header, std::string_view about) {
    return checksum(std::as_bytes(std::span(about)), checksum(bytesOf(header).first(offsetof(Header, checksum))));
}

uint64_t indexSum(const IndexHead& head, std::span<const uint64_t> offsets, uint64_t at) {
    return checksum(bytesOf(at), checksum(std::as_bytes(offsets), checksum(bytesOf(head))));
}

// f(array, k) for each array of a frame, in the order of the file.
template <class Frame, class F>
void eachArray(Frame& frame, F f) {
    size_t k = 0;
    f(frame.position, k++);
    f(frame.velocity, k++);
    f(frame.id, k++);
    f(frame.normal, k++);
    f(frame.absorption, k++);
    for (auto& part : frame.ellipsoids) f(part, k++);
    f(frame.foam, k++);
    f(frame.foamVelocity, k++);
    f(frame.places, k++);
    f(frame.corners, k++);
}

// The first bytes of all items, then their second bytes: similar bytes are adjacent and compress better.
template <class T>
std::vector<uint8_t> planesOf(const std::vector<T>& items) {
    std::vector<uint8_t> planes(items.size() * sizeof(T));
    const auto* from = reinterpret_cast<const uint8_t*>(items.data());
    for (size_t b = 0; b < sizeof(T); ++b)
        for (size_t i = 0; i < items.size(); ++i) planes[b * items.size() + i] = from[i * sizeof(T) + b];
    return planes;
}

template <class T>
void itemsOf(const std::vector<uint8_t>& planes, std::vector<T>& items) {
    items.resize(planes.size() / sizeof(T));
    auto* to = reinterpret_cast<uint8_t*>(items.data());
    for (size_t b = 0; b < sizeof(T); ++b)
        for (size_t i = 0; i < items.size(); ++i) to[i * sizeof(T) + b] = planes[b * items.size() + i];
}

std::string pack(const RecordedFrame& frame, uint64_t& bytes) {
    const auto volumes = static_cast<uint32_t>(std::min(frame.dry.size(), kMostDry));
    Counts counts{{}, frame.box, frame.spacing, (frame.halves ? kHalves : 0U) | volumes << kDryBit};
    bytes = sizeof(Counts) + volumes * sizeof(DryVolume);
    eachArray(frame, [&](const auto& array, size_t k) {
        counts.items[k] = array.size();
        bytes += array.size() * sizeof(array[0]);
    });
    std::string out;
    ArrayPacker packer(out);
    packer.put(std::span<const Counts>(&counts, 1));
    eachArray(frame, [&](const auto& array, size_t) {
        const std::vector<uint8_t> planes = planesOf(array);
        packer.put(std::span<const uint8_t>(planes));
    });
    packer.put(std::span<const DryVolume>(frame.dry).first(volumes));
    packer.finish();
    return out;
}

// Nothing: `why` has the fault.
bool unpack(std::span<const std::byte> packed, uint64_t bytes, RecordedFrame& frame, std::string& why) {
    ArrayUnpacker unpacker(packed);
    std::vector<Counts> counts;
    bool whole = unpacker.take(1, counts);
    uint64_t left = bytes - sizeof(Counts);
    if (whole) {
        frame.box = counts[0].box;
        frame.spacing = counts[0].spacing;
        frame.halves = (counts[0].flags & kHalves) != 0;
    }
    eachArray(frame, [&](auto& array, size_t k) {
        const size_t size = sizeof(array[0]);
        if (!whole || !why.empty()) return;
        if (counts[0].items[k] > left / size) {
            why = "its arrays are larger than itself";
            return;
        }
        left -= counts[0].items[k] * size;
        std::vector<uint8_t> planes;
        whole = unpacker.take(counts[0].items[k] * size, planes);
        if (whole) itemsOf(planes, array);
    });
    const size_t volumes = whole ? counts[0].flags >> kDryBit : 0;
    if (why.empty() && volumes > std::min(kMostDry, static_cast<size_t>(left / sizeof(DryVolume))))
        why = "its arrays are larger than itself";
    if (why.empty() && whole) {
        left -= volumes * sizeof(DryVolume);
        whole = unpacker.take(volumes, frame.dry);
    }
    if (why.empty() && (!whole || !unpacker.finish())) why = unpacker.why();
    if (why.empty() && left != 0) why = "its arrays are smaller than itself";
    return why.empty();
}

// Arrays of the particles are all equally long, or empty.
bool sensible(const RecordedFrame& f) {
    const size_t n = f.position.size();
    const auto fits = [n](const std::vector<vec4>& array) { return array.empty() || array.size() == n; };
    const bool ellipsoids = std::all_of(f.ellipsoids.begin(), f.ellipsoids.end(), [&](const std::vector<vec4>& part) {
        return fits(part) && part.empty() == f.ellipsoids[0].empty();
    });
    return f.velocity.size() == n && f.id.size() == n && fits(f.normal) && fits(f.absorption) && ellipsoids &&
           f.foam.size() == f.foamVelocity.size();
}

bool plain(float x) { return std::abs(x) <= kMostRecorded; }  // no NaN either
bool plain(const vec3& v) { return plain(v.x) && plain(v.y) && plain(v.z); }
bool plain(const vec4& v) { return plain(v.x) && plain(v.y) && plain(v.z) && plain(v.w); }
bool plain(const mat4& m) { return plain(m[0]) && plain(m[1]) && plain(m[2]) && plain(m[3]); }
bool plain(uint32_t) { return true; }

// Whether all numbers can be drawn.
bool drawable(RecordedFrame& f) {
    bool all = std::isfinite(f.time) && plain(f.spacing) && f.spacing > 0 && plain(f.box.min) && plain(f.box.max);
    eachArray(f, [&](const auto& array, size_t) { all = all && std::ranges::all_of(array, [](const auto& item) { return plain(item); }); });
    const auto sound = [](const DryVolume& v) { return plain(v.centre) && plain(v.reach) && plain(v.turn); };
    return all && std::ranges::all_of(f.dry, sound);
}

}  // namespace

std::string textOf(const RecordedRun& run) {
    return fmt::format("{}{}{}{}{}{}", kRunVersion, run.version, kRunDevice, run.device, kRunScene, run.scene);
}

// A line end in the scene's JSON is never followed by the name of the version.
size_t endOfAbout(std::string_view text) { return std::min(text.rfind(kRunVersion), text.size()); }

RecordedRun recordedRun(const std::string& text) {
    const size_t version = endOfAbout(text), device = text.find(kRunDevice, version), scene = text.find(kRunScene, device);
    if (scene == std::string::npos) return {};
    const auto between = [&text](size_t from, std::string_view name, size_t to) {
        return text.substr(from + name.size(), to - from - name.size());
    };
    return {between(version, kRunVersion, device), between(device, kRunDevice, scene), text.substr(scene + kRunScene.size())};
}

Result<RecordingWriter> RecordingWriter::open(const std::string& path, const std::string& about) {
    Result<NewFile> file = NewFile::open(path);
    if (!file) return file.error();
    RecordingWriter writer(std::move(*file), path);
    const std::string text = about.substr(0, kMostAbout);
    Header header{kMagic, kByteOrder, kVersion, static_cast<uint32_t>(text.size()), 0, 0};
    header.checksum = headerSum(header, text);
    if (Status put = writer.put(std::string(reinterpret_cast<const char*>(&header), sizeof(header)) + text, "its header"); !put)
        return put.error();
    return writer;
}

Status RecordingWriter::put(const std::string& bytes, const std::string& what) {
    if (Status written = file_.write(bytes, what); !written) return written;
    at_ += bytes.size();
    return ok();
}

Status RecordingWriter::add(const RecordedFrame& frame) {
    try {
        FrameHead head{kFrame, static_cast<uint32_t>(offsets_.size()), frame.time, 0, 0, 0, 0};
        const std::string packed = pack(frame, head.bytes);
        head.packedBytes = packed.size();
        head.checksum = checksum(std::as_bytes(std::span(packed)));
        head.headChecksum = headSum(head);
        const uint64_t at = at_;
        if (Status done =
                put(std::string(reinterpret_cast<const char*>(&head), sizeof(head)) + packed, fmt::format("frame {}", head.number));
            !done)
            return done;
        offsets_.push_back(at);
        if (offsets_.size() == 1) file_.publish();
        return ok();
    } catch (const std::bad_alloc&) {
        return failed(fmt::format("{}: there is not enough memory to pack frame {}", path_, offsets_.size()));
    }
}

Status RecordingWriter::close() {
    const IndexHead head{kIndex, static_cast<uint32_t>(offsets_.size())};
    const Tail tail{at_, indexSum(head, offsets_, at_)};
    std::string out(reinterpret_cast<const char*>(&head), sizeof(head));
    out.append(reinterpret_cast<const char*>(offsets_.data()), offsets_.size() * sizeof(uint64_t));
    out.append(reinterpret_cast<const char*>(&tail), sizeof(tail));
    if (Status done = put(out, "its index"); !done) return done;
    return file_.commit();
}

bool isRecording(const std::string& path) {
    if (path.ends_with(".rrec")) return true;
    if (factsOf(path).kind != FileFacts::Kind::regular) return false;  // a pipe would lose what is read
    const Result<Descriptor> file = openInput(path);
    std::array<uint8_t, 8> magic{};
    return file && readAt(*file, magic.data(), magic.size(), 0) == std::ptrdiff_t{8} && magic == kMagic;
}

Error RecordingReader::damaged(const std::string& what) const {
    return badInput(fmt::format("{}: {}; record the run again with rivulet run --record", path_, what));
}

bool RecordingReader::take(uint64_t at, void* to, size_t bytes) const {
    if (at > size_ || bytes > size_ - at) return false;
    for (size_t done = 0; done < bytes;) {
        const std::ptrdiff_t got = readAt(file_, static_cast<char*>(to) + done, bytes - done, at + done);
        if (got <= 0) return false;
        done += static_cast<size_t>(got);
    }
    return true;
}

Result<RecordingReader> RecordingReader::open(const std::string& path) {
    try {
        Result<Descriptor> file = openInput(path);
        if (!file) return file.error();
        const FileFacts facts = factsOf(*file);
        if (facts.error != 0) return badInput(fmt::format("{} cannot be read: {}", path, reasonOf(facts.error)));
        RecordingReader reader(std::move(*file), path);
        reader.size_ = facts.bytes;
        if (Status head = reader.readHeader(); !head) return head.error();
        if (!reader.readIndex())
            if (Status found = reader.scan(); !found) return found.error();
        if (reader.offsets_.empty()) return reader.damaged("it has no frame");
        return reader;
    } catch (const std::bad_alloc&) {
        return failed(fmt::format("{}: there is not enough memory to read it", path));
    }
}

Status RecordingReader::readHeader() {
    if (size_ == 0) return damaged("it is empty, not a recording");
    std::array<uint8_t, 8> magic{};
    const size_t seen = std::min<uint64_t>(size_, magic.size());
    if (!take(0, magic.data(), seen)) return damaged("its beginning cannot be read");
    if (std::memcmp(magic.data(), kMagic.data(), seen) != 0) return damaged("this is not the beginning of a recording");
    Header header{};
    if (!take(0, &header, sizeof(header))) return damaged(fmt::format("it is cut off after {} bytes", size_));
    if (header.byteOrder == kOtherByteOrder) return damaged("it was written on a machine of the other byte order");
    if (header.byteOrder != kByteOrder) return damaged("the mark of the byte order was damaged");
    if (header.version != kVersion)
        return damaged(fmt::format("its version is {}, this program reads version {}", header.version, kVersion));
    if (header.aboutBytes > kMostAbout || header.zero != 0) return damaged("its header was damaged");
    first_ = sizeof(header) + header.aboutBytes;
    if (first_ > size_) return damaged(fmt::format("it is cut off after {} bytes, in its header", size_));
    about_.resize(header.aboutBytes);
    if (!take(sizeof(header), about_.data(), about_.size())) return damaged("its header cannot be read");
    if (headerSum(header, about_) != header.checksum) return damaged("its header was damaged: the checksum is wrong");
    return ok();
}

// False: there is no index, or it is damaged.
bool RecordingReader::readIndex() {
    Tail tail{};
    IndexHead head{};
    constexpr uint64_t kLeast = sizeof(IndexHead) + sizeof(Tail);
    if (size_ < first_ + kLeast || !take(size_ - sizeof(tail), &tail, sizeof(tail))) return false;
    if (tail.index < first_ || tail.index > size_ - kLeast || !take(tail.index, &head, sizeof(head)) || head.mark != kIndex) return false;
    if (size_ - kLeast - tail.index != uint64_t{head.count} * sizeof(uint64_t)) return false;
    offsets_.resize(head.count);
    const bool whole = take(tail.index + sizeof(head), offsets_.data(), offsets_.size() * sizeof(uint64_t)) &&
                       indexSum(head, offsets_, tail.index) == tail.checksum;
    if (!whole) offsets_.clear();
    return whole;
}

// Finds the frames one by one, up to the last whole one.
Status RecordingReader::scan() {
    uint64_t at = first_;
    FrameHead head{};
    while (take(at, &head, sizeof(head)) && head.mark == kFrame && headSum(head) == head.headChecksum && head.number == offsets_.size() &&
           head.packedBytes <= size_ - at - sizeof(head)) {
        offsets_.push_back(at);
        at += sizeof(head) + head.packedBytes;
    }
    if (offsets_.empty()) return damaged(fmt::format("it is cut off or damaged at byte {}, before its first frame is whole", at));
    cut_ = fmt::format("{} has no end: it is cut off or damaged at byte {}; only its whole frames, 0 to {}, are used", path_, at,
                       offsets_.size() - 1);
    return ok();
}

size_t RecordingReader::largest() const {
    constexpr uint64_t kFirstBlock = size_t{1} << 18U;  // bytes that surely hold a zstd frame's first block
    size_t most = 0;
    std::vector<std::byte> packed;
    std::vector<Counts> counts;
    for (const uint64_t offset : offsets_) {
        FrameHead head{};
        if (!take(offset, &head, sizeof(head)) || head.mark != kFrame) continue;
        packed.resize(std::min(head.packedBytes, kFirstBlock));
        if (take(offset + sizeof(head), packed.data(), packed.size()) && ArrayUnpacker(packed).take(1, counts))
            most = std::max<size_t>(most, counts[0].items[0]);
    }
    return most;
}

Result<RecordedFrame> RecordingReader::read(size_t k, size_t memoryLimit) {
    ASSERT(k < frames(), "ask for a frame that there is");
    try {
        const auto wrong = [&](std::string_view why) {
            return damaged(fmt::format("frame {} at byte {} was damaged: {}", k, offsets_[k], why));
        };
        FrameHead head{};
        if (!take(offsets_[k], &head, sizeof(head))) return wrong("the file has become shorter");
        const uint64_t at = offsets_[k] + sizeof(head);
        if (head.mark != kFrame || head.number != k || headSum(head) != head.headChecksum) return wrong("its head's checksum is wrong");
        if (head.packedBytes > size_ - at) return wrong("it is cut off");
        if (head.bytes < sizeof(Counts) || head.bytes / kMostBytesPerPackedByte > head.packedBytes) return wrong("its size is impossible");
        if (head.bytes > memoryLimit) return failed(fmt::format("{}: frame {} holds more than {} bytes of memory", path_, k, memoryLimit));
        std::vector<std::byte> packed(head.packedBytes);
        if (!take(at, packed.data(), packed.size())) return wrong("it cannot be read");
        if (checksum(packed) != head.checksum) return wrong("its checksum is wrong");
        RecordedFrame frame;
        std::string why;
        if (!unpack(packed, head.bytes, frame, why)) return wrong(why);
        frame.time = head.time;
        if (!sensible(frame)) return wrong("its arrays have inconsistent sizes");
        if (!drawable(frame)) return wrong("it has a value that is not finite or is beyond 1e15");
        return frame;
    } catch (const std::bad_alloc&) {
        return failed(fmt::format("{}: there is not enough memory for frame {}", path_, k));
    }
}

}  // namespace rivulet
