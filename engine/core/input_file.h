// Opening a file to read it, without trust in what its name leads to.
#pragma once

#include <string>

#include "engine/core/descriptor.h"
#include "engine/core/result.h"

namespace rivulet {

// Opens a regular file for reading and never waits. Error (badInput): it cannot be opened; or it is a folder, a pipe, a device, a socket,
// or belongs to a file system that the kernel makes up (/proc, /sys).
Result<Descriptor> openInput(const std::string& path);

// Whether openInput succeeds: for a library that opens the file by its name.
Status checkInput(const std::string& path);

}  // namespace rivulet
