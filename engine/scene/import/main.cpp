// rivulet_import AS FILE MEMORY SECONDS: reads one model or picture and writes it to stdout (model_wire.h). rivulet starts it
// (engine/scene/import_process.h).
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <new>

#include "engine/core/readable_bytes.h"
#include "engine/scene/import/read_model.h"
#include "engine/scene/import/sandbox.h"
#include "engine/scene/model_check.h"
#include "engine/scene/model_wire.h"

namespace rivulet {
namespace {

namespace fs = std::filesystem;

bool answering = false;  // after the first byte, the answer cannot become another one

bool answerWith(std::span<const std::byte> bytes) {
    answering = true;
    while (!bytes.empty()) {
        const ssize_t sent = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
        if (sent < 0 && errno == EINTR) continue;
        if (sent < 0) return false;
        bytes = bytes.subspan(static_cast<size_t>(sent));
    }
    return true;
}

void* reserve = nullptr;  // memory for the last sentence

// Where memory ends, assimp and its libraries cannot be relied on to stop.
[[noreturn]] void endForLackOfMemory() {
    std::set_new_handler(nullptr);
    std::free(reserve);
    const std::string phrase =
        fmt::format("needs more than {} of memory to be read; it is damaged or too large: simplify it, or export it again",
                    readableBytes(memoryLimit()));
    ::_exit(!answering && sendFault(phrase, answerWith) ? 0 : 1);
}

Result<Model> answerFor(const std::string& as, const std::string& path) {
    std::error_code error;
    const fs::path folder = fs::canonical(fs::absolute(path).parent_path(), error);
    (void)confine(folder.string(), path);  // FolderFiles keeps the rule about files in any case
    Result<Model> model = readModel(path, as == "mesh"    ? ReadAs::mesh
                                          : as == "model" ? ReadAs::model
                                          : as == "image" ? ReadAs::image
                                                          : ReadAs::whole);
    if (!model) return model;
    if (std::string fault = faultOf(*model); !fault.empty()) return badInput(std::move(fault));
    return model;
}

}  // namespace
}  // namespace rivulet

// Builds with sanitizers have no limit of address space (sandbox.h); this one stands in for it.
extern "C" const char* __asan_default_options() { return "max_allocation_size_mb=2048"; }  // NOLINT(readability-identifier-naming)
extern "C" const char* __tsan_default_options() { return "max_allocation_size_mb=2048"; }  // NOLINT(readability-identifier-naming)

int main(int count, char** words) {
    using namespace rivulet;
    if (count != 5) {
        fmt::print(stderr, "rivulet_import reads models and pictures for rivulet, which starts it; run rivulet instead\n");
        return 2;
    }
    limitProcess(std::strtoull(words[3], nullptr, 10), std::atoi(words[4]));
    reserve = std::malloc(size_t{1} << 20U);
    std::set_new_handler(endForLackOfMemory);
    const Result<Model> model = answerFor(words[1], words[2]);
    const bool sent = model ? sendModel(*model, answerWith) : sendFault(model.error().message, answerWith);
    ::_exit(sent ? 0 : 1);  // the importer's scene is not worth tidying up
}
