// Whole files: read into memory with a limit, written by temporary name and rename.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "engine/core/new_file.h"
#include "engine/core/result.h"

namespace rivulet {

// The bytes of a file. Error (badInput): as openInput; the file is larger than `maxBytes`.
Result<std::string> readFile(const std::string& path, size_t maxBytes = size_t{1} << 30);

// Writes a whole file by NewFile: a reader never sees a part of it. Error (failed): disk full, not writable; the old file stays.
Status writeFileAtomic(const std::string& path, std::string_view bytes, unsigned mode = 0666, Sync sync = Sync::disk);

// Error (failed) if a file of this name cannot be made. Leaves nothing behind. Call it before long work, not after.
Status checkWritable(const std::string& path);

}  // namespace rivulet
