#include "tests/fuzzers/target.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

#include "engine/core/message_line.h"
#include "fluid/sim/world/cpu_kernels.h"

namespace rivulet::fuzzers {

std::span<const Target> targets() {
    static constexpr std::array kAll = {
        Target{"scene", runScene, sceneSeeds, 3000},
        Target{"scene_file", runSceneFile, sceneFileSeeds, 1000},
        Target{"marks", runMarks, marksSeeds, 1000},
        Target{"set", runSet, setSeeds, 3000},
        Target{"image", runImage, imageSeeds, 2000},
        Target{"voxel_file", runVoxelFile, voxelFileSeeds, 3000},
        Target{"state_file", runStateFile, stateFileSeeds, 3000},
        Target{"state", runState, stateSeeds, 200},
        Target{"recording", runRecording, recordingSeeds, 1000},
        Target{"model", runModel, modelSeeds, 3000},
        Target{"model_file", runModelFile, modelFileSeeds, 40},
        Target{"flow", runFlow, flowSeeds, 300},
        Target{"grid", runGrid, gridSeeds, 300},
        Target{"host", runHost, hostSeeds, 60},
    };
    return kAll;
}

const Target* findTarget(std::string_view name) {
    for (const Target& t : targets())
        if (name == t.name) return &t;
    return nullptr;
}

void broken(std::string_view promise) {
    fmt::print(stderr, "broken: {}\n", promise);
    std::abort();
}

void requireSentence(std::string_view message) { require(!messageLine(message).empty(), "an error has a sentence"); }

uint8_t Feed::u8() {
    if (bytes_.empty()) return 0;
    const auto value = static_cast<uint8_t>(bytes_.front());
    bytes_ = bytes_.subspan(1);
    return value;
}

uint32_t Feed::u32() {
    uint32_t value = 0;
    const size_t count = std::min(sizeof value, bytes_.size());
    std::memcpy(&value, bytes_.data(), count);
    bytes_ = bytes_.subspan(count);
    return value;
}

float Feed::real() {
    constexpr float kInfinite = std::numeric_limits<float>::infinity();
    const std::array kEdges = {0.0F,    -0.0F,    1.0F,      -1.0F,      1.0e-38F,      1.0e-45F,
                               3.4e38F, -3.4e38F, kInfinite, -kInfinite, std::nanf(""), 1.0e10F};
    const uint8_t kind = u8();
    if (kind < kEdges.size()) return kEdges[kind];
    if (kind < 128) return within(-2.0F, 2.0F);
    float value = 0;
    const uint32_t bits = u32();
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

float Feed::within(float least, float most) { return least + (most - least) * static_cast<float>(u32()) / 4294967295.0F; }

std::string Feed::text(size_t most) {
    const size_t count = std::min<size_t>({most, u8(), bytes_.size()});
    std::string text(count, ' ');
    std::memcpy(text.data(), bytes_.data(), count);
    bytes_ = bytes_.subspan(count);
    return text;
}

Bytes bytesOf(std::string_view text) { return std::as_bytes(std::span(text.data(), text.size())); }

std::string fileOf(Bytes bytes, const char* ending) {
    const std::string path = (std::filesystem::temp_directory_path() / fmt::format("rivulet_fuzz_{}{}", getpid(), ending)).string();
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    require(file.good(), "the temporary folder can be written to");
    return path;
}

std::string contentsOf(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::stringstream bytes;
    bytes << stream.rdbuf();
    return bytes.str();
}

Device& device() {
    static const std::vector<CpuKernelRow> rows = cpuKernels();
    static const std::unique_ptr<CpuDevice> one = [] {
        auto made = makeCpuDevice(rows, {.threads = 1});
        made->limitMemory(size_t{256} << 20U);
        return made;
    }();
    return *one;
}

}  // namespace rivulet::fuzzers
