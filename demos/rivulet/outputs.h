// Which files a verb reads and writes, checked before it starts.
#pragma once

#include <span>
#include <string>

#include "engine/core/result.h"

namespace rivulet {

struct NamedFile {
    std::string option;  // "--stats"; for messages
    std::string path;    // empty: not used
    // `path` is a pattern. Its last '*' stands for the number of a frame if a '_' is before it ("out/dam_break_*.png"), else for any text.
    bool series = false;
};

// Error (badInput): two outputs are the same file, an output is an input, or stdout is redirected to an output; by this or another path.
Status checkOutputs(std::span<const NamedFile> outputs, std::span<const NamedFile> inputs);

}  // namespace rivulet
