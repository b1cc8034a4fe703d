// Fuzz targets: each is a function that must return for any bytes, without a crash, a hang, or a complaint of a sanitizer. A broken promise
// of a public header counts as a crash.
//
// `bash tests/fuzz.sh` builds them with libFuzzer and runs them for as long as asked. fuzzers_test.cpp runs each on its seeds, on bytes
// that failed once (finds/NAME/), and on some thousand mutations, in every build.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/compute/device_cpu.h"

namespace rivulet::fuzzers {

using Bytes = std::span<const std::byte>;

struct Target {
    const char* name;
    void (*run)(Bytes);
    std::vector<std::string> (*seeds)();  // valid input, for mutations to begin from
    int mutations;                        // that fuzzers_test tries
};
std::span<const Target> targets();
const Target* findTarget(std::string_view name);

// Prints `promise` and aborts if it does not hold; `holds`: a bool, a Status or a Result.
[[noreturn]] void broken(std::string_view promise);
template <class T>
void require(const T& holds, std::string_view promise) {
    if (!static_cast<bool>(holds)) broken(promise);
}
// Of an Error: a sentence, which may quote the input. What shows it makes it one line (message_line.h).
void requireSentence(std::string_view message);

// Reads numbers out of bytes; after their end, zeros.
class Feed {
  public:
    explicit Feed(Bytes bytes) : bytes_(bytes) {}
    bool empty() const { return bytes_.empty(); }
    uint8_t u8();
    uint32_t u32();
    uint32_t below(uint32_t count) { return count == 0 ? 0 : u32() % count; }  // [0, count)
    // Often one of the values at which code breaks (0, -0, the smallest, the largest, infinite, no number), else any bits.
    float real();
    float within(float least, float most);  // finite
    std::string text(size_t most);
    Bytes rest() const { return bytes_; }

  private:
    Bytes bytes_;
};

Bytes bytesOf(std::string_view text);
// A file of these bytes for a target that reads a path; the same file each time, of this process alone.
std::string fileOf(Bytes bytes, const char* ending);
std::string contentsOf(const std::filesystem::path& file);
// The device of this process's targets: cpu, one thread, at most 256 MB.
Device& device();

void runScene(Bytes);
void runSceneFile(Bytes);
void runMarks(Bytes);
void runSet(Bytes);
void runImage(Bytes);
void runVoxelFile(Bytes);
void runStateFile(Bytes);
void runState(Bytes);
void runRecording(Bytes);
void runModel(Bytes);
void runModelFile(Bytes);
void runFlow(Bytes);
void runGrid(Bytes);
void runHost(Bytes);
std::vector<std::string> sceneSeeds();
std::vector<std::string> sceneFileSeeds();
std::vector<std::string> marksSeeds();
std::vector<std::string> setSeeds();
std::vector<std::string> imageSeeds();
std::vector<std::string> voxelFileSeeds();
std::vector<std::string> stateFileSeeds();
std::vector<std::string> stateSeeds();
std::vector<std::string> recordingSeeds();
std::vector<std::string> modelSeeds();
std::vector<std::string> modelFileSeeds();
std::vector<std::string> flowSeeds();
std::vector<std::string> gridSeeds();
std::vector<std::string> hostSeeds();

}  // namespace rivulet::fuzzers
