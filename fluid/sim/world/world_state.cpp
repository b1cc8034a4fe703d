#include "fluid/sim/world/world_state.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <new>

#include "engine/core/assert.h"
#include "engine/core/file.h"
#include "fluid/voxel/packed_array.h"

namespace rivulet {
namespace {

// The first byte is no letter and a line's end follows, so that a transfer as text shows.
constexpr std::array<uint8_t, 8> kMagic = {0x89, 'R', 'S', 'T', 'A', '\r', '\n', 0x1A};
constexpr uint32_t kByteOrder = 0x01020304, kOtherByteOrder = 0x04030201;
constexpr uint32_t kVersion = 2;  // 2: absorption's w is scattering
constexpr uint32_t kMostSections = 4096;

struct Header {
    std::array<uint8_t, 8> magic;
    uint32_t byteOrder, version;
    uint32_t sections;  // how many
    uint32_t zero;
    uint64_t fileBytes;  // all of it
    uint64_t checksum;   // XXH3 of all above and of the table of sections below
};
static_assert(sizeof(Header) == 40 && std::is_trivially_copyable_v<Header>);

struct Section {
    std::array<char, WorldState::kLongestName + 1> name;  // zeros behind it
    uint64_t offset, packedBytes;                         // in the file
    uint64_t bytes;                                       // of its numbers
    uint64_t checksum;                                    // XXH3 of the packed bytes
};
static_assert(sizeof(Section) == 64 && std::is_trivially_copyable_v<Section>);

uint64_t checksumOfHead(std::span<const std::byte> bytes, size_t sections) {
    std::vector<std::byte> head(bytes.begin(), bytes.begin() + offsetof(Header, checksum));
    const auto table = bytes.subspan(sizeof(Header), sections * sizeof(Section));
    head.insert(head.end(), table.begin(), table.end());
    return checksum(head);
}

// Writes "path.to.param = value" for what is fixed.
class FixedValues final : public ParamVisitor {
  public:
    std::string text;

    void value(const ParamInfo& info, float& v) override { line(info, fmt::format("{}", v)); }
    void value(const ParamInfo& info, int& v) override { line(info, fmt::format("{}", v)); }
    void value(const ParamInfo& info, bool& v) override { line(info, fmt::format("{}", v)); }
    void value(const ParamInfo& info, std::string& v) override { line(info, v); }
    void value(const ParamInfo& info, vec3& v) override { line(info, fmt::format("{}, {}, {}", v.x, v.y, v.z)); }
    void colour(const ParamInfo& info, vec3& v) override { value(info, v); }
    void choice(const ParamInfo& info, std::string& v, std::span<const std::string>) override { line(info, v); }

  protected:
    bool beginGroup(const ParamInfo& info) override {
        path_.emplace_back(info.name);
        return true;
    }
    void endGroup() override { path_.pop_back(); }
    size_t beginList(const ParamInfo& info, size_t current) override {
        if (info.fixed) line(info, fmt::format("{} items", current));
        path_.emplace_back(info.name);
        return current;
    }
    void beginItem(size_t index) override { path_.push_back(std::to_string(index)); }
    void endItem() override { path_.pop_back(); }
    void endList() override { path_.pop_back(); }

  private:
    void line(const ParamInfo& info, const std::string& shown) {
        if (!info.fixed) return;
        for (const std::string& part : path_) text += part + ".";
        text += fmt::format("{} = {}\n", info.name, shown);
    }
    std::vector<std::string> path_;
};

// Each step believes only what those before it have proven.
class Reader {
  public:
    Reader(std::span<const std::byte> bytes, std::string_view name, size_t memoryLimit)
        : bytes_(bytes), name_(name), memoryLimit_(memoryLimit) {}

    Result<WorldState> read() {
        if (Status head = readHead(); !head) return head.error();
        WorldState state;
        size_t at = sizeof(Header) + table_.size() * sizeof(Section), held = 0;
        std::string before;
        for (const Section& s : table_) {
            const std::string title(s.name.data(), strnlen(s.name.data(), s.name.size()));
            const bool named = !title.empty() && title > before && title.size() <= WorldState::kLongestName &&
                               std::ranges::all_of(title, [](char c) { return c > ' ' && c < 127; });
            if (!named || s.offset != at || s.packedBytes > bytes_.size() - at || s.bytes / kMostBytesPerPackedByte > s.packedBytes)
                return damaged("its table of sections is invalid");
            held += s.bytes;
            if (held > memoryLimit_) return failed(fmt::format("{}: it holds more than {} bytes of memory", name_, memoryLimit_));
            const auto packed = bytes_.subspan(at, s.packedBytes);
            if (checksum(packed) != s.checksum) return damaged(fmt::format("section {} was damaged: its checksum is wrong", title));
            WorldState::Bytes numbers;
            ArrayUnpacker unpacker(packed);
            if (!unpacker.take(s.bytes, numbers) || !unpacker.finish())
                return damaged(fmt::format("section {} was damaged: {}", title, unpacker.why()));
            state.putBytes(title, std::move(numbers));
            at += s.packedBytes;
            before = title;
        }
        if (at != bytes_.size()) return damaged("there is more after its last section");
        return state;
    }

  private:
    Error damaged(const std::string& what) const {
        return badInput(fmt::format("{}: {}; save the state again with rivulet run --save", name_, what));
    }

    Status readHead() {
        const size_t seen = std::min(bytes_.size(), kMagic.size());
        if (bytes_.empty()) return damaged("it is empty, not a saved state");
        if (std::memcmp(bytes_.data(), kMagic.data(), seen) != 0) return damaged("this is not the beginning of a saved state");
        Header header{};
        if (bytes_.size() < sizeof(Header)) return damaged(fmt::format("it is cut off after {} bytes", bytes_.size()));
        std::memcpy(&header, bytes_.data(), sizeof(Header));
        if (header.byteOrder == kOtherByteOrder) return damaged("it was written on a machine of the other byte order");
        if (header.byteOrder != kByteOrder) return damaged("the mark of the byte order was damaged");
        if (header.version != kVersion)
            return damaged(fmt::format("its version is {}, this program reads version {}", header.version, kVersion));
        if (header.fileBytes > bytes_.size())
            return damaged(fmt::format("it is cut off: it has {} of its {} bytes", bytes_.size(), header.fileBytes));
        if (header.fileBytes < bytes_.size()) return damaged("there is more after its end");
        if (header.sections > kMostSections || header.zero != 0 || bytes_.size() < sizeof(Header) + header.sections * sizeof(Section))
            return damaged(fmt::format("{} sections are not possible", header.sections));
        if (checksumOfHead(bytes_, header.sections) != header.checksum) return damaged("its header was damaged: the checksum is wrong");
        table_.resize(header.sections);
        if (!table_.empty()) std::memcpy(table_.data(), bytes_.data() + sizeof(Header), table_.size() * sizeof(Section));
        return ok();
    }

    std::span<const std::byte> bytes_;
    std::string_view name_;
    size_t memoryLimit_;
    std::vector<Section> table_;
};

}  // namespace

void WorldState::putBytes(const std::string& name, Bytes bytes) {
    ASSERT(!name.empty() && name.size() <= kLongestName, "a section's name has 1 to 31 letters");
    const bool fresh = sections_.emplace(name, std::move(bytes)).second;
    ASSERT(fresh, "two parts of a state must not have the same name");
}

Result<WorldState::Bytes> WorldState::takeBytes(const std::string& name) {
    auto node = sections_.extract(name);
    if (node.empty())
        return badInput(fmt::format("the saved state has no section {}: it belongs to another scene or another version", name));
    return std::move(node.mapped());
}

Result<std::string> WorldState::takeText(const std::string& name) {
    Result<Bytes> bytes = takeBytes(name);
    if (!bytes) return bytes.error();
    return std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size());
}

Error WorldState::otherSize(const std::string& name, size_t bytes, size_t expected) {
    return badInput(
        fmt::format("section {} of the saved state holds {} bytes, this scene needs {}: resume it with the scene it was saved from", name,
                    bytes, expected));
}

Status WorldState::allTaken() const {
    if (sections_.empty()) return ok();
    return badInput(
        fmt::format("the saved state has a section {}, which this scene does not need: resume it with the scene it was saved from",
                    sections_.begin()->first));
}

std::string fixedValues(const VisitFn& visit) {
    FixedValues values;
    visit(values);
    return std::move(values.text);
}

namespace {

// True if `line` is of a parameter that `saved` lacks in a group that it has, or of a group that it lacks in one that it has: a later
// version added it. The items of a list have numbers as names; they do not count as groups, unless `saved` lacks the list.
bool isLater(std::string_view line, std::string_view saved) {
    const auto has = [&](std::string_view start) {
        return saved.starts_with(start) || saved.find(fmt::format("\n{}", start)) != std::string_view::npos;
    };
    const std::string_view name = line.substr(0, line.find(" = ") + 3);
    if (has(name)) return false;
    size_t end = name.rfind('.');
    const bool inGroup = end != std::string_view::npos || line.ends_with(" items");  // the number of items of a list
    while (end != std::string_view::npos && !has(name.substr(0, end + 1))) {
        const size_t before = end == 0 ? std::string_view::npos : name.rfind('.', end - 1);
        const std::string_view group = name.substr(before + 1, end - before - 1);
        if (group.empty()) return false;
        if (group.find_first_not_of("0123456789") == std::string_view::npos) {
            const std::string_view list = name.substr(0, std::min(before, name.size()));
            if (before == std::string_view::npos || has(fmt::format("{}.", list)) || has(fmt::format("{} = ", list))) return false;
        }
        end = before;
    }
    return inGroup;
}

}  // namespace

Status sameFixedValues(std::string_view saved, std::string_view now) {
    const std::string_view all = saved;
    const auto next = [](std::string_view& text) {
        const size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        return line.empty() ? std::string_view("nothing more") : line;
    };
    while (!saved.empty() || !now.empty()) {
        const std::string_view is = next(now);
        if (isLater(is, all)) continue;
        const std::string_view was = next(saved);
        if (was != is)
            return badInput(
                fmt::format("the state was saved with {}, this scene has {}: resume it with the scene it was saved from", was, is));
    }
    return ok();
}

Result<std::string> packState(const WorldState& state) {
    try {
        std::string out(sizeof(Header) + state.sections().size() * sizeof(Section), '\0');
        std::vector<Section> table;
        for (const auto& [name, bytes] : state.sections()) {
            Section section{{}, out.size(), 0, bytes.size(), 0};
            std::copy(name.begin(), name.end(), section.name.begin());
            ArrayPacker packer(out);
            packer.put(std::span<const std::byte>(bytes));
            packer.finish();
            section.packedBytes = out.size() - section.offset;
            section.checksum = checksum(std::as_bytes(std::span(out)).subspan(section.offset));
            table.push_back(section);
        }
        Header header{kMagic, kByteOrder, kVersion, static_cast<uint32_t>(table.size()), 0, out.size(), 0};
        if (!table.empty()) std::memcpy(out.data() + sizeof(Header), table.data(), table.size() * sizeof(Section));
        std::memcpy(out.data(), &header, sizeof(Header));
        header.checksum = checksumOfHead(std::as_bytes(std::span(out)), table.size());
        std::memcpy(out.data(), &header, sizeof(Header));
        return out;
    } catch (const std::bad_alloc&) {
        return failed("there is not enough memory to pack the state");
    }
}

Result<WorldState> unpackState(std::span<const std::byte> bytes, std::string_view name, size_t memoryLimit) {
    try {
        return Reader(bytes, name, memoryLimit).read();
    } catch (const std::bad_alloc&) {
        return failed(fmt::format("{}: there is not enough memory for its content", name));
    }
}

Result<size_t> writeState(const std::string& path, const WorldState& state) {
    Result<std::string> bytes = packState(state);
    if (!bytes) return bytes.error();
    if (Status written = writeFileAtomic(path, *bytes); !written) return written.error();
    return bytes->size();
}

Result<WorldState> readState(const std::string& path) {
    try {
        Result<std::string> bytes = readFile(path, size_t{16} << 30U);
        if (!bytes) return bytes.error();
        return unpackState(std::as_bytes(std::span(*bytes)), path);
    } catch (const std::bad_alloc&) {
        return failed(fmt::format("{}: there is not enough memory to read it", path));
    }
}

}  // namespace rivulet
