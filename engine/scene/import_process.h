// Starts the program rivulet_import, which reads one model or picture in a process of its own: a file that crashes, blocks or takes over
// assimp or stb_image reaches neither this process nor files outside its folder (docs/decisions/0029-import-process.md).
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include "engine/core/result.h"
#include "engine/scene/model.h"

namespace rivulet {

struct ImportLimits {
    // Address space (bytes) and processor time (s) of the child for small files. Both grow with the bytes of the files that it opens
    // (import/sandbox.h).
    size_t memory = size_t{2} << 30U;
    int seconds = 20;
    std::chrono::milliseconds wall{900'000};  // for a child that waits; one that computes is stopped earlier
    size_t answer = size_t{4} << 30U;         // bytes
};

// rivulet_import beside the running program, with which it was built; "": it is not there.
std::string importProgram();

// `as`: mesh, model, whole or image (import/read_model.h). The result has no fault (model_check.h). Error (badInput): one sentence that
// names `path`, also if the child crashes, exceeds a limit or answers anything else than a model. (failed): the program cannot be started.
Result<Model> importThrough(const std::string& program, const std::string& as, const std::string& path, const ImportLimits& limits = {});

}  // namespace rivulet
