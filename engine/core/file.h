// Whole files: read into memory with a limit, written by temporary name and rename.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "engine/core/result.h"

namespace rivulet {

// The bytes of a file. Error (badInput): the file cannot be read, is a folder or is larger than `maxBytes`.
Result<std::string> readFile(const std::string& path, size_t maxBytes = size_t{1} << 30);

// Writes a whole file by temporary name and rename: a reader never sees a part of it. A link is followed; a device or pipe is written into.
// A new file gets the permissions `mode`, less the umask. Error (failed): disk full, not writable; the old file stays.
Status writeFileAtomic(const std::string& path, std::string_view bytes, unsigned mode = 0666);

}  // namespace rivulet
