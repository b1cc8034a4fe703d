// A libFuzzer program of the target that RIVULET_FUZZ_TARGET names. With RIVULET_FUZZ_SEEDS=FOLDER it writes the seeds of all targets to
// FOLDER/NAME/ and ends. tests/fuzz.sh starts it.
#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "tests/fuzzers/target.h"

using rivulet::fuzzers::Target;

namespace {
const Target* target = nullptr;
}

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
    if (const char* folder = std::getenv("RIVULET_FUZZ_SEEDS")) {
        for (const Target& t : rivulet::fuzzers::targets()) {
            const std::filesystem::path of = std::filesystem::path(folder) / t.name;
            std::filesystem::create_directories(of);
            int number = 0;
            for (const std::string& bytes : t.seeds()) std::ofstream(of / fmt::format("seed_{:04}", number++), std::ios::binary) << bytes;
        }
        std::exit(0);
    }
    const char* name = std::getenv("RIVULET_FUZZ_TARGET");
    target = rivulet::fuzzers::findTarget(name != nullptr ? name : "");
    if (target != nullptr) return 0;
    fmt::print(stderr, "RIVULET_FUZZ_TARGET must name one of:");
    for (const Target& t : rivulet::fuzzers::targets()) fmt::print(stderr, " {}", t.name);
    fmt::print(stderr, "\n");
    std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    target->run(std::as_bytes(std::span(data, size)));
    return 0;
}
