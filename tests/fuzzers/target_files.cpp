// Targets voxel_file, state_file and recording: the project's own files. libFuzzer's builds have no checksums (packed_array.cpp).
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "fluid/io/recording.h"
#include "fluid/sim/world/world_state.h"
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
    Result<VoxelModel> made = voxelizeMesh(device(), meshes, {.mode = VoxelMode::solid, .resolution = 12});
    require(made, "a cube can be voxelised");
    file.mode = made->mode;
    file.bits = std::move(made->bits);
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

std::string contents(const std::string& path) {
    std::string text;
    if (std::FILE* file = std::fopen(path.c_str(), "rb")) {
        text.resize(std::filesystem::file_size(path));
        text.resize(std::fread(text.data(), 1, text.size(), file));
        (void)std::fclose(file);
    }
    return text;
}

}  // namespace

void runVoxelFile(Bytes bytes) {
    const Result<VoxelFile> file = unpackVoxelFile(bytes, "file.rvox", kMost);
    if (!file) {
        requireSentence(file.error().message);
        return;
    }
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
    return all;
}

void runStateFile(Bytes bytes) {
    const Result<WorldState> state = unpackState(bytes, "file.rstate", kMost);
    if (!state) {
        requireSentence(state.error().message);
        return;
    }
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
    return {*packed};
}

void runRecording(Bytes bytes) {
    Result<RecordingReader> file = RecordingReader::open(fileOf(bytes, ".rrec"));
    if (!file) {
        requireSentence(file.error().message);
        return;
    }
    require(file->frames() >= 1, "a recording has a frame");
    for (size_t k = 0; k < std::min<size_t>(file->frames(), 8); ++k) {
        const Result<RecordedFrame> frame = file->read(k, kMost);
        if (!frame) {
            requireSentence(frame.error().message);
            continue;
        }
        require(frame->velocity.size() == frame->position.size() && frame->id.size() == frame->position.size(),
                "one velocity and id a particle");
    }
}

std::vector<std::string> recordingSeeds() {
    std::vector<std::string> all;
    const std::string path = fileOf({}, "_seed.rrec");
    for (const size_t count : {0UL, 1UL, 200UL}) {
        Result<RecordingWriter> file = RecordingWriter::open(path, "{}");
        require(file && file->add(frameOf(0.0F, count)) && file->add(frameOf(0.1F, count)) && file->close(), "a recording can be written");
        all.push_back(contents(path));
    }
    std::filesystem::remove(path);
    return all;
}

}  // namespace rivulet::fuzzers
