// Targets voxel_file, state_file and recording: the project's own files. The first byte says what is made to fit before the rest is read:
// checksums (1), sizes (2). Else a fuzzer would not come past them.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "fluid/io/recording.h"
#include "fluid/sim/world/world_state.h"
#include "fluid/voxel/packed_array.h"
#include "fluid/voxel/voxel_file.h"
#include "tests/fuzzers/target.h"

namespace rivulet::fuzzers {

namespace {

constexpr size_t kMost = size_t{64} << 20U;

VoxelFile cube(bool labels, bool band) {
    VoxelFile file;
    const std::vector<vec3> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
    const std::vector<uint32_t> faces = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                         2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    const std::array meshes = {MeshView{corners, faces, {}, {}}};
    VoxelizeOptions options;
    options.mode = VoxelMode::solid;
    options.resolution = 12;
    Result<VoxelModel> made = voxelizeMesh(device(), meshes, options);
    require(made, "a cube can be voxelised");
    file.mode = made->mode;
    file.bits = std::move(made->bits);
    file.key = "key";
    if (labels) file.labels = std::move(made->labels);
    if (band) {
        const ivec3 size = file.bits.size + 1;
        const size_t points = static_cast<size_t>(size.x) * static_cast<size_t>(size.y) * static_cast<size_t>(size.z);
        file.band = VoxelBand{0.1F, true, std::vector<float>(points, 0.05F), std::vector<uint32_t>(points, 0)};
    }
    return file;
}

RecordedFrame frameOf(float time, size_t count) {
    RecordedFrame f;
    f.time = double{time};
    f.spacing = 0.02F;
    f.box.max = vec3(1.0F);
    for (size_t k = 0; k < count; ++k) {
        f.position.emplace_back(0.01F * static_cast<float>(k), 0.5F, 0.5F, 1.0F);
        f.velocity.emplace_back(0.0F, time, 0.0F, 0.0F);
        f.id.push_back(static_cast<uint32_t>(k));
    }
    f.places.emplace_back(1.0F);
    return f;
}

constexpr unsigned kChecksums = 1, kSizes = 2;

uint64_t wordAt(const std::string& file, size_t at) {
    uint64_t word = 0;
    std::memcpy(&word, file.data() + at, sizeof word);
    return word;
}
void putWord(std::string& file, size_t at, uint64_t word) { std::memcpy(file.data() + at, &word, sizeof word); }
uint64_t sumOf(std::string_view part, uint64_t seed = 0) { return checksum(bytesOf(part), seed); }

// Of a file that has a table of sections: bytes of its header, which ends with the size of the file and a checksum; where the number of
// sections is; bytes of an entry, which ends with a checksum; where the offset and the size of the section are in it.
struct Layout {
    size_t header, sections, entry, offset;
};
constexpr Layout kVoxelFile{80, 20, 40, 8}, kStateFile{40, 16, 64, 32};

std::string fitted(Bytes bytes, const Layout& of) {
    if (bytes.empty()) return {};
    const auto what = static_cast<unsigned>(bytes[0]);
    std::string file(reinterpret_cast<const char*>(bytes.data()) + 1, bytes.size() - 1);
    if (file.size() < of.header) return file;
    const size_t sections = wordAt(file, of.sections) & 0xFFFFFFFFU;
    if (sections > (file.size() - of.header) / of.entry) return file;
    size_t at = of.header + sections * of.entry;
    if ((what & kSizes) != 0) putWord(file, of.header - 16, file.size());
    for (size_t k = 0; k < sections; ++k) {
        const size_t entry = of.header + k * of.entry;
        if ((what & kSizes) != 0) {
            putWord(file, entry + of.offset, at);
            if (k + 1 == sections) putWord(file, entry + of.offset + 8, file.size() - at);
        }
        const uint64_t from = wordAt(file, entry + of.offset), size = wordAt(file, entry + of.offset + 8);
        if (from > file.size() || size > file.size() - from) return file;
        at = from + size;
        if ((what & kChecksums) != 0) putWord(file, entry + of.entry - 8, sumOf(std::string_view(file).substr(from, size)));
    }
    if ((what & kChecksums) != 0)
        putWord(file, of.header - 8, sumOf(file.substr(0, of.header - 8) + file.substr(of.header, sections * of.entry)));
    return file;
}

// The same of a recording: a header with a text, frames, an index.
std::string fittedRecording(Bytes bytes) {
    constexpr size_t kHeader = 32, kFrame = 48, kIndexHead = 8, kTail = 16;
    constexpr uint64_t kFrameMark = 0x4D415246;
    if (bytes.empty()) return {};
    const auto what = static_cast<unsigned>(bytes[0]);
    std::string file(reinterpret_cast<const char*>(bytes.data()) + 1, bytes.size() - 1);
    const std::string_view all = file;
    if (file.size() < kHeader || (what & kChecksums) == 0) return file;
    const size_t about = wordAt(file, 16) & 0xFFFFFFFFU;
    if (about > file.size() - kHeader) return file;
    putWord(file, kHeader - 8, sumOf(all.substr(kHeader, about), sumOf(all.substr(0, kHeader - 8))));
    size_t at = kHeader + about;
    while (at + kFrame <= file.size() && (wordAt(file, at) & 0xFFFFFFFFU) == kFrameMark) {
        const uint64_t size = wordAt(file, at + 16);
        if (size > file.size() - at - kFrame) return file;
        putWord(file, at + kFrame - 16, sumOf(all.substr(at + kFrame, size)));
        putWord(file, at + kFrame - 8, sumOf(all.substr(at, kFrame - 8)));
        at += kFrame + size;
    }
    if (at + kIndexHead + kTail > file.size()) return file;
    if ((what & kSizes) != 0) putWord(file, file.size() - kTail, at);
    const std::string_view offsets = all.substr(at + kIndexHead, file.size() - at - kIndexHead - kTail);
    putWord(file, file.size() - 8, sumOf(all.substr(file.size() - kTail, 8), sumOf(offsets, sumOf(all.substr(at, kIndexHead)))));
    return file;
}

// Each with everything made to fit, and as it is.
std::vector<std::string> bothWays(const std::vector<std::string>& files) {
    std::vector<std::string> all;
    for (const std::string& file : files)
        for (const unsigned what : {kChecksums | kSizes, 0U}) all.push_back(static_cast<char>(what) + file);
    return all;
}

}  // namespace

void runVoxelFile(Bytes bytes) {
    const Result<VoxelFile> file = unpackVoxelFile(bytesOf(fitted(bytes, kVoxelFile)), "file.rvox", kMost);
    if (!file) return requireSentence(file.error().message);
    if (file->band)
        for (const float d : file->band->distance)
            require(std::isfinite(d) && std::abs(d) <= file->band->band, "distances are within the band");
    const Result<std::string> packed = packVoxelFile(*file);
    require(packed, "what was unpacked can be packed");
    const Result<VoxelFile> again = unpackVoxelFile(bytesOf(*packed), "again.rvox", kMost);
    require(again, "and unpacked again");
}

std::vector<std::string> voxelFileSeeds() {
    std::vector<std::string> all;
    for (int k = 0; k < 4; ++k)
        if (const Result<std::string> packed = packVoxelFile(cube((k & 1) != 0, (k & 2) != 0))) all.push_back(*packed);
    return bothWays(all);
}

void runStateFile(Bytes bytes) {
    const Result<WorldState> state = unpackState(bytesOf(fitted(bytes, kStateFile)), "file.rstate", kMost);
    if (!state) return requireSentence(state.error().message);
    const Result<std::string> packed = packState(*state);
    require(packed, "what was unpacked can be packed");
    const Result<WorldState> again = unpackState(bytesOf(*packed), "again.rstate", kMost);
    require(again && again->sections() == state->sections(), "and unpacked again, to the same");
}

std::vector<std::string> stateFileSeeds() {
    WorldState state;
    state.putText("text", "fluid.spacing = 0.02");
    std::vector<float> numbers(300, 1.5F);
    state.put<float>("numbers", numbers);
    state.put<uint32_t>("none", {});
    const Result<std::string> packed = packState(state);
    require(packed, "a state can be packed");
    return bothWays({*packed});
}

void runRecording(Bytes bytes) {
    Result<RecordingReader> file = RecordingReader::open(fileOf(bytesOf(fittedRecording(bytes)), ".rrec"));
    if (!file) return requireSentence(file.error().message);
    require(file->frames() >= 1, "a recording has a frame");
    const std::string other = fileOf({}, "_again.rrec");
    Result<RecordingWriter> again = RecordingWriter::open(other, file->about());
    require(again, "a recording can be written");
    for (size_t k = 0; k < std::min<size_t>(file->frames(), 8); ++k) {
        const Result<RecordedFrame> frame = file->read(k, kMost);
        if (!frame) {
            requireSentence(frame.error().message);
            continue;
        }
        require(frame->velocity.size() == frame->position.size() && frame->id.size() == frame->position.size(),
                "one velocity and id a particle");
        for (const vec4& x : frame->position)
            require(std::isfinite(x.x + x.y + x.z + x.w) && std::isfinite(glm::dot(x, x)), "positions can be drawn");
        require(again->add(*frame), "what was read can be written");
    }
    const size_t whole = again->frames();
    require(again->close(), "and completed");
    if (whole == 0) return;
    Result<RecordingReader> read = RecordingReader::open(other);
    require(read && read->frames() == whole && read->about() == file->about(), "and read again");
    for (size_t k = 0; k < whole; ++k) require(read->read(k), "each frame of it");
}

std::vector<std::string> recordingSeeds() {
    std::vector<std::string> all;
    const std::string path = fileOf({}, "_seed.rrec");
    for (const size_t count : {0UL, 1UL, 200UL}) {
        Result<RecordingWriter> file = RecordingWriter::open(path, "{}");
        require(file && file->add(frameOf(0.0F, count)) && file->add(frameOf(0.1F, count)) && file->close(), "a recording can be written");
        all.push_back(contentsOf(path));
    }
    std::filesystem::remove(path);
    return bothWays(all);
}

}  // namespace rivulet::fuzzers
