// The layout of .rvox, and all checks of a file.
#include "fluid/voxel/voxel_file.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <array>
#include <cstring>
#include <new>

#include "engine/core/assert.h"
#include "engine/core/file.h"
#include "engine/core/readable_bytes.h"
#include "fluid/voxel/packed_array.h"

namespace rivulet {
namespace {

// The first byte is not ASCII and a line end follows, so a transfer as text is detected.
constexpr std::array<uint8_t, 8> kMagic = {0x89, 'R', 'V', 'O', 'X', '\r', '\n', 0x1A};
constexpr uint32_t kByteOrder = 0x01020304, kOtherByteOrder = 0x04030201;
constexpr uint32_t kVersion = 1;
constexpr size_t kMostKeyBytes = 1024;
constexpr int kLongestSide = 65536;  // voxels: products of three stay far below 2^63

struct Header {
    std::array<uint8_t, 8> magic;
    uint32_t byteOrder, version;
    uint32_t mode;      // VoxelMode
    uint32_t sections;  // number of them
    std::array<int32_t, 3> size;
    std::array<float, 3> origin;
    float voxel;
    float band;       // m; 0: the file has no band
    uint32_t closed;  // 0 or 1: the band's distances have signs
    uint32_t zero;
    uint64_t fileBytes;  // size of the file
    uint64_t checksum;   // XXH3 of all above and of the table of sections below
};
static_assert(sizeof(Header) == 80 && std::is_trivially_copyable_v<Header>);

// In the order of the file. For the arrays in each see write() and read().
enum class Kind : uint32_t { bits = 1, labels, materials, distance, normal, key, end };
constexpr const char* kNames[] = {"", "bits", "labels", "materials", "distance", "normal", "key"};
static_assert(std::size(kNames) == static_cast<size_t>(Kind::end));

struct Section {
    Kind kind;
    uint32_t zero;
    uint64_t offset, packedBytes;  // in the file
    uint64_t bytes;                // of its arrays
    uint64_t checksum;             // XXH3 of the packed bytes
};
static_assert(sizeof(Section) == 40 && std::is_trivially_copyable_v<Section>);

struct MaterialRecord {
    uint64_t voxels;
    double volume;
    std::array<int32_t, 3> low, high;
    uint32_t solid, zero;
};
static_assert(sizeof(MaterialRecord) == 48 && std::is_trivially_copyable_v<MaterialRecord>);

// The arrays of the band, one item per grid point. A new array needs one line here and a Kind.
template <class Band, class Fn>
void eachColumn(Band& band, const Fn& fn) {
    fn(Kind::distance, band.distance);
    fn(Kind::normal, band.normal);
}

size_t pointsOf(const ivec3& size) {
    return (static_cast<size_t>(size.x) + 1) * (static_cast<size_t>(size.y) + 1) * (static_cast<size_t>(size.z) + 1);
}

size_t bitBytesOf(const VoxelGrid& grid) { return (grid.count() + 31) / 32 * 4; }

std::string_view asText(std::span<const std::byte> bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

class Writer {
  public:
    std::string write(const VoxelFile& file) {
        check(file);
        const size_t sections = 1 + (file.labels ? 2 : 0) + (file.band ? countColumns(*file.band) : 0) + (file.key.empty() ? 0 : 1);
        out_.resize(sizeof(Header) + sections * sizeof(Section));
        add<uint8_t>(Kind::bits, file.bits.bits);
        if (file.labels) addLabels(*file.labels);
        if (file.band) eachColumn(*file.band, [this](Kind kind, const auto& items) { add(kind, std::span(items)); });
        if (!file.key.empty()) add<char>(Kind::key, file.key);

        Header header{};
        header.magic = kMagic;
        header.byteOrder = kByteOrder;
        header.version = kVersion;
        header.mode = static_cast<uint32_t>(file.mode);
        header.sections = static_cast<uint32_t>(table_.size());
        for (size_t k = 0; k < 3; ++k) {
            header.size[k] = file.bits.size[static_cast<int>(k)];
            header.origin[k] = file.bits.origin[static_cast<int>(k)];
        }
        header.voxel = file.bits.voxel;
        header.band = file.band ? file.band->band : 0.0F;
        header.closed = file.band && file.band->closed ? 1 : 0;
        header.fileBytes = out_.size();
        const size_t tableBytes = table_.size() * sizeof(Section);
        std::memcpy(out_.data() + sizeof(Header), table_.data(), tableBytes);
        std::memcpy(out_.data(), &header, sizeof(Header));
        header.checksum = checksumOfHead(std::as_bytes(std::span(out_)), tableBytes);
        std::memcpy(out_.data(), &header, sizeof(Header));
        return std::move(out_);
    }

    static uint64_t checksumOfHead(std::span<const std::byte> bytes, size_t tableBytes) {
        std::vector<std::byte> head(bytes.begin(), bytes.begin() + offsetof(Header, checksum));
        const auto table = bytes.subspan(sizeof(Header), tableBytes);
        head.insert(head.end(), table.begin(), table.end());
        return XXH3_64bits(head.data(), head.size());
    }

  private:
    static void check(const VoxelFile& file) {
        const VoxelGrid& grid = file.bits;
        ASSERT(grid.count() > 0 && grid.bits.size() == bitBytesOf(grid), "the number of bits must match the size of the grid");
        ASSERT(!file.labels || (file.labels->size == grid.size && file.labels->rowStart.size() == rowsOf(grid.size) + 1),
               "labels must have the size of the grid");
        ASSERT(file.key.size() <= kMostKeyBytes, "the key of a voxel file has at most 1,024 bytes");
        if (!file.band) return;
        ASSERT(file.band->band > 0, "the width of a band must be above 0");
        eachColumn(*file.band, [&grid](Kind, const auto& items) {
            ASSERT(items.size() == pointsOf(grid.size), "a band needs one value per grid point");
        });
    }

    static size_t countColumns(const VoxelBand& band) {
        size_t count = 0;
        eachColumn(band, [&count](Kind, const auto&) { ++count; });
        return count;
    }

    template <class... T>
    void add(Kind kind, std::span<const T>... arrays) {
        Section section{kind, 0, out_.size(), 0, (arrays.size_bytes() + ...), 0};
        ArrayPacker packer(out_);
        (packer.put(arrays), ...);
        packer.finish();
        section.packedBytes = out_.size() - section.offset;
        section.checksum = XXH3_64bits(out_.data() + section.offset, section.packedBytes);
        table_.push_back(section);
    }

    // Runs a row, then all runs' x, then all runs' labels.
    void addLabels(const VoxelLabels& labels) {
        std::vector<uint32_t> runs(rowsOf(labels.size)), x, label;
        for (size_t row = 0; row < runs.size(); ++row) runs[row] = labels.rowStart[row + 1] - labels.rowStart[row];
        x.reserve(labels.runs.size());
        label.reserve(labels.runs.size());
        for (const LabelRun& run : labels.runs) {
            x.push_back(run.x);
            label.push_back(run.label);
        }
        add<uint32_t, uint32_t, uint32_t>(Kind::labels, runs, x, label);
        std::vector<MaterialRecord> records;
        records.reserve(labels.materials.size());
        for (const VoxelMaterial& m : labels.materials)
            records.push_back({m.voxels, m.volume, {m.low.x, m.low.y, m.low.z}, {m.high.x, m.high.y, m.high.z}, m.solid ? 1U : 0U, 0});
        add<MaterialRecord>(Kind::materials, records);
    }

    std::string out_;
    std::vector<Section> table_;
};

// Each step relies only on the checks before it; the first failure stores its message in error_.
class Reader {
  public:
    Reader(std::span<const std::byte> bytes, std::string_view name, size_t memoryLimit)
        : bytes_(bytes), name_(name), memoryLimit_(memoryLimit) {}

    Result<VoxelFile> read() {
        try {
            if (readHead() && readFrame() && readTable() && checkMemory() && readBits() && readLabels() && readBand() && readKey())
                return std::move(file_);
            return *error_;
        } catch (const std::bad_alloc&) {
            return failed(fmt::format("{}: not enough memory for its content", name_));
        }
    }

  private:
    static constexpr const char* kRemedy = "make it again with rivulet voxelize";

    bool refuse(const std::string& what) {
        error_ = badInput(fmt::format("{}: {}", name_, what));
        return false;
    }
    // `at`: the byte; `what`: the fault.
    bool damaged(size_t at, const std::string& what) { return refuse(fmt::format("byte {}: {}; {}", at, what, kRemedy)); }
    bool damaged(const Section& section, const std::string& what) {
        return refuse(
            fmt::format("section {} at byte {}: {}; {}", kNames[static_cast<size_t>(section.kind)], section.offset, what, kRemedy));
    }

    bool readHead() {
        const auto magic = std::as_bytes(std::span(kMagic));
        const size_t seen = std::min(bytes_.size(), kMagic.size());
        if (bytes_.empty()) return refuse(fmt::format("it is empty, not a voxel file; {}", kRemedy));
        if (asText(bytes_.first(seen)) != asText(magic.first(seen))) return damaged(0, "this is not the beginning of a voxel file (.rvox)");
        if (bytes_.size() < sizeof(Header)) return refuse(fmt::format("it is cut off after {} bytes; {}", bytes_.size(), kRemedy));
        std::memcpy(&header_, bytes_.data(), sizeof(Header));
        if (header_.byteOrder == kOtherByteOrder)
            return damaged(offsetof(Header, byteOrder), "it was written on a machine with the other byte order");
        if (header_.byteOrder != kByteOrder) return damaged(offsetof(Header, byteOrder), "the byte order mark is damaged");
        if (header_.version != kVersion)
            return damaged(offsetof(Header, version),
                           fmt::format("its version is {}, this program reads version {}", header_.version, kVersion));
        if (header_.fileBytes > bytes_.size())
            return refuse(fmt::format("it is cut off: it has {} of {} bytes; {}", bytes_.size(), header_.fileBytes, kRemedy));
        if (header_.fileBytes < bytes_.size()) return damaged(header_.fileBytes, "there are bytes after the file's end");
        if (header_.sections == 0 || header_.sections >= static_cast<uint32_t>(Kind::end) ||
            bytes_.size() < sizeof(Header) + header_.sections * sizeof(Section))
            return damaged(offsetof(Header, sections), fmt::format("{} is not a possible number of sections", header_.sections));
        if (Writer::checksumOfHead(bytes_, header_.sections * sizeof(Section)) != header_.checksum)
            return damaged(offsetof(Header, checksum), "the header's checksum is wrong: the file is damaged");
        return true;
    }

    bool readFrame() {
        VoxelGrid& grid = file_.bits;
        if (header_.mode > static_cast<uint32_t>(VoxelMode::surface))
            return damaged(offsetof(Header, mode), fmt::format("{} is not a mode", header_.mode));
        file_.mode = static_cast<VoxelMode>(header_.mode);
        const auto& s = header_.size;
        grid.size = {s[0], s[1], s[2]};
        for (int32_t side : s) {
            if (side < 1 || side > kLongestSide)
                return damaged(offsetof(Header, size), fmt::format("a grid of {} x {} x {} voxels is not possible (1 to {} per side)", s[0],
                                                                   s[1], s[2], kLongestSide));
        }
        grid.origin = {header_.origin[0], header_.origin[1], header_.origin[2]};
        if (!isFinite(grid.origin)) return damaged(offsetof(Header, origin), "the origin is not finite");
        grid.voxel = header_.voxel;
        if (!std::isnormal(grid.voxel) || grid.voxel < 0)
            return damaged(offsetof(Header, voxel), fmt::format("{} is not a possible edge of a voxel", grid.voxel));
        if (!std::isfinite(header_.band) || header_.band < 0)
            return damaged(offsetof(Header, band), fmt::format("{} is not a possible width of the band", header_.band));
        if (header_.closed > 1 || header_.zero != 0)
            return damaged(offsetof(Header, closed), fmt::format("the flag of signed distances is {}, not 0 or 1", header_.closed));
        return true;
    }

    bool readTable() {
        table_.resize(header_.sections);
        std::memcpy(table_.data(), bytes_.data() + sizeof(Header), table_.size() * sizeof(Section));
        size_t at = sizeof(Header) + table_.size() * sizeof(Section);
        Kind before{};
        for (size_t k = 0; k < table_.size(); ++k) {
            const Section& s = table_[k];
            const size_t place = sizeof(Header) + k * sizeof(Section);
            if (s.kind <= before || s.kind >= Kind::end || s.zero != 0)
                return damaged(place, fmt::format("a section of kind {} is not possible here", static_cast<uint32_t>(s.kind)));
            before = s.kind;
            if (s.offset != at || s.packedBytes > bytes_.size() - at) return damaged(place, "the section has a wrong offset or size");
            at += s.packedBytes;
            if (s.bytes / kMostBytesPerPackedByte > s.packedBytes)
                return damaged(place, fmt::format("{} bytes cannot be packed into {}", s.bytes, s.packedBytes));
            if (XXH3_64bits(bytes_.data() + s.offset, s.packedBytes) != s.checksum)
                return damaged(s, "its checksum is wrong: the section is damaged");
        }
        if (at != bytes_.size()) return damaged(at, "these bytes belong to no section");
        return true;
    }

    const Section* find(Kind kind) const {
        const auto found = std::find_if(table_.begin(), table_.end(), [kind](const Section& s) { return s.kind == kind; });
        return found == table_.end() ? nullptr : &*found;
    }

    // Checks that all required sections exist, have the sizes of the grid, and fit into memory together.
    bool checkMemory() {
        const auto needs = [this](Kind kind, bool wanted, size_t bytes) {
            const Section* section = find(kind);
            const char* name = kNames[static_cast<size_t>(kind)];
            if (wanted != (section != nullptr))
                return refuse(fmt::format("the section {} is {}; {}", name, wanted ? "missing" : "not expected here", kRemedy));
            return section == nullptr || section->bytes == bytes ||
                   damaged(*section, fmt::format("it holds {} bytes; the size of the grid requires {}", section->bytes, bytes));
        };
        const VoxelGrid& grid = file_.bits;
        if (!needs(Kind::bits, true, bitBytesOf(grid))) return false;
        bool columns = true;
        VoxelBand shape;
        eachColumn(shape, [&](Kind kind, const auto& items) {
            columns = columns && needs(kind, header_.band > 0, pointsOf(grid.size) * sizeof(items[0]));
        });
        if (!columns) return false;
        const Section* key = find(Kind::key);
        if (key != nullptr && (key->bytes == 0 || key->bytes > kMostKeyBytes))
            return damaged(*key, fmt::format("a key of {} bytes is not possible (1 to {})", key->bytes, kMostKeyBytes));
        const Section* labels = find(Kind::labels);
        const Section* materials = find(Kind::materials);
        if ((labels == nullptr) != (materials == nullptr))
            return refuse(fmt::format("labels and materials must both be present; {}", kRemedy));
        double bytes = 0;
        for (const Section& s : table_) bytes += static_cast<double>(s.bytes);
        if (bytes > static_cast<double>(memoryLimit_))
            return refuse(fmt::format("it needs {}, more than the {} allowed; voxelise the mesh at a lower resolution",
                                      readableBytes(bytes), readableBytes(static_cast<double>(memoryLimit_))));
        if (labels == nullptr) return true;
        const size_t rows = rowsOf(grid.size), each = sizeof(uint32_t);
        const size_t runs = (labels->bytes - std::min<size_t>(labels->bytes, rows * each)) / (2 * each);
        if (labels->bytes != rows * each + runs * 2 * each || runs < rows || runs > grid.count() || runs > UINT32_MAX)
            return damaged(*labels, fmt::format("{} bytes do not match the runs of {} rows", labels->bytes, rows));
        if (materials->bytes % sizeof(MaterialRecord) != 0 || materials->bytes / sizeof(MaterialRecord) > runs)
            return damaged(*materials, fmt::format("{} bytes do not match a list of materials", materials->bytes));
        return true;
    }

    std::span<const std::byte> packed(const Section& section) const { return bytes_.subspan(section.offset, section.packedBytes); }

    template <class T>
    bool unpack(const Section& section, std::vector<T>& to) {
        ArrayUnpacker from(packed(section));
        return (from.take(section.bytes / sizeof(T), to) && from.finish()) || damaged(section, from.why());
    }

    bool readBits() {
        const Section& section = *find(Kind::bits);
        VoxelGrid& grid = file_.bits;
        if (!unpack(section, grid.bits)) return false;
        for (size_t k = grid.count(); k < grid.bits.size() * 8; ++k) {
            if (((grid.bits[k >> 3U] >> (k & 7U)) & 1U) != 0) return damaged(section, "bits are set after the last voxel");
        }
        return true;
    }

    bool readLabels() {
        const Section* section = find(Kind::labels);
        if (section == nullptr) return true;
        VoxelLabels& labels = file_.labels.emplace();
        labels.size = file_.bits.size;
        std::vector<MaterialRecord> records;
        if (!unpack(*find(Kind::materials), records)) return false;

        const size_t rows = rowsOf(labels.size);
        std::vector<uint32_t> runs, x, label;
        ArrayUnpacker from(packed(*section));
        const size_t total = (section->bytes / sizeof(uint32_t) - rows) / 2;
        if (!from.take(rows, runs) || !from.take(total, x) || !from.take(total, label) || !from.finish())
            return damaged(*section, from.why());
        size_t sum = 0;
        labels.rowStart.reserve(rows + 1);
        for (uint32_t count : runs) {
            if (count < 1 || count > total - sum) return damaged(*section, "the numbers of runs of the rows do not match the runs");
            labels.rowStart.push_back(static_cast<uint32_t>(sum));
            sum += count;
        }
        if (sum != total) return damaged(*section, "the numbers of runs of the rows do not match the runs");
        labels.rowStart.push_back(static_cast<uint32_t>(sum));
        labels.runs.reserve(total);
        for (size_t k = 0; k < total; ++k) labels.runs.push_back({x[k], label[k]});
        labels.materials.resize(records.size());
        return countVoxels(*section, labels) && checkMaterials(records, labels);
    }

    // Checks the runs, and computes voxels, volume and bounds of each material from them.
    bool countVoxels(const Section& section, VoxelLabels& labels) {
        for (VoxelMaterial& m : labels.materials) {
            m.low = labels.size;
            m.high = ivec3(-1);
        }
        for (int z = 0; z < labels.size.z; ++z) {
            for (int y = 0; y < labels.size.y; ++y) {
                const size_t row = static_cast<size_t>(z) * static_cast<size_t>(labels.size.y) + static_cast<size_t>(y);
                for (size_t k = labels.rowStart[row]; k < labels.rowStart[row + 1]; ++k) {
                    const LabelRun& run = labels.runs[k];
                    const bool first = k == labels.rowStart[row], last = k + 1 == labels.rowStart[row + 1];
                    const uint32_t end = last ? static_cast<uint32_t>(labels.size.x) : labels.runs[k + 1].x;
                    if ((first && run.x != 0) || run.x >= end || end > static_cast<uint32_t>(labels.size.x) ||
                        (!first && run.label == labels.runs[k - 1].label) ||
                        (run.label >= kFirstMaterial && run.label - kFirstMaterial >= labels.materials.size()))
                        return damaged(section, fmt::format("run {} is not valid", k));
                    const size_t voxels = end - run.x;
                    if (run.label == kOutside) labels.outside += voxels;
                    if (run.label == kInsideSurface) labels.surface += voxels;
                    if (run.label < kFirstMaterial) continue;
                    VoxelMaterial& m = labels.materials[run.label - kFirstMaterial];
                    m.voxels += voxels;
                    m.low = glm::min(m.low, ivec3(static_cast<int>(run.x), y, z));
                    m.high = glm::max(m.high, ivec3(static_cast<int>(end) - 1, y, z));
                }
            }
        }
        return true;
    }

    bool checkMaterials(const std::vector<MaterialRecord>& records, VoxelLabels& labels) {
        const auto edge = static_cast<double>(file_.bits.voxel);
        for (size_t k = 0; k < records.size(); ++k) {
            const MaterialRecord& r = records[k];
            VoxelMaterial& m = labels.materials[k];
            const double volume = static_cast<double>(m.voxels) * edge * edge * edge;
            if (m.voxels == 0 || r.voxels != m.voxels || ivec3(r.low[0], r.low[1], r.low[2]) != m.low ||
                ivec3(r.high[0], r.high[1], r.high[2]) != m.high || !(std::abs(r.volume - volume) <= 1e-6 * volume) || r.solid > 1 ||
                r.zero != 0)
                return damaged(*find(Kind::materials), fmt::format("material {} does not match the labels", k));
            m.volume = r.volume;
            m.solid = r.solid != 0;
        }
        return true;
    }

    bool readBand() {
        if (!(header_.band > 0)) return true;
        VoxelBand& band = file_.band.emplace();
        band.band = header_.band;
        band.closed = header_.closed != 0;
        bool read = true;
        eachColumn(band, [&](Kind kind, auto& items) { read = read && unpack(*find(kind), items); });
        if (!read) return false;
        const auto wrong = std::find_if_not(band.distance.begin(), band.distance.end(),
                                            [&band](float d) { return std::abs(d) <= band.band && (band.closed || d >= 0); });
        return wrong == band.distance.end() ||
               damaged(*find(Kind::distance), fmt::format("distance {} is {}, which is outside the band of {} m",
                                                          wrong - band.distance.begin(), *wrong, band.band));
    }

    bool readKey() {
        const Section* section = find(Kind::key);
        std::vector<char> key;
        if (section != nullptr && !unpack(*section, key)) return false;
        file_.key.assign(key.begin(), key.end());
        return true;
    }

    std::span<const std::byte> bytes_;
    std::string_view name_;
    size_t memoryLimit_;
    Header header_{};
    std::vector<Section> table_;
    VoxelFile file_;
    std::optional<Error> error_;
};

}  // namespace

Result<std::string> packVoxelFile(const VoxelFile& file) {
    try {
        return Writer().write(file);
    } catch (const std::bad_alloc&) {
        return failed("Not enough memory to pack the voxels; lower the resolution.");
    }
}

Result<VoxelFile> unpackVoxelFile(std::span<const std::byte> bytes, std::string_view name, size_t memoryLimit) {
    return Reader(bytes, name, memoryLimit).read();
}

Result<size_t> writeVoxelFile(const std::string& path, const VoxelFile& file) {
    Result<std::string> bytes = packVoxelFile(file);
    if (!bytes) return bytes.error();
    if (Status written = writeFileAtomic(path, *bytes); !written) return written.error();
    return bytes->size();
}

Result<VoxelFile> readVoxelFile(const std::string& path, size_t memoryLimit) {
    try {
        Result<std::string> bytes = readFile(path, memoryLimit);  // a packed file is smaller
        if (!bytes) return bytes.error();
        return unpackVoxelFile(std::as_bytes(std::span(*bytes)), path, memoryLimit);
    } catch (const std::bad_alloc&) {
        return failed(fmt::format("{}: not enough memory to read it", path));
    }
}

}  // namespace rivulet
