// What rivulet_import takes from itself before it reads a file that may be hostile.
#pragma once

#include <cstddef>
#include <string>

namespace rivulet {

// Limits for the rest of the process: `memory` bytes of address space and `seconds` of processor time, no file written, 32 files open, no
// core dump. It ends with the process that started it. Builds with sanitizers keep their address space and have ten times the time.
void limitProcess(size_t memory, int seconds);

// Raises both limits for a file of `bytes` that is to be read: 64 bytes of memory per byte and 1 s per MB, up to 16 GiB and 10 minutes.
void allowFor(size_t bytes);

// The limit of memory at present, for error messages.
size_t memoryLimit();

// What the kernel refuses from now on.
struct Confinement {
    bool files = false, calls = false;
};

// From here on the kernel refuses to open any file outside `folder` but `file` (Landlock), and all calls that reading a model does not
// need: sockets, programs, processes, signals, files for writing (seccomp). A system without these continues without them, and so do
// builds with sanitizers; FolderFiles keeps the rule about files in any case.
Confinement confine(const std::string& folder, const std::string& file);

}  // namespace rivulet
