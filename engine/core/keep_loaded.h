// Shared libraries that cannot be unloaded, because threads of theirs run until the process ends.
#pragma once

namespace rivulet {

// Keeps the shared library that holds the function at `address` in memory until the process ends, also where the library that needs it is
// unloaded (dlclose). Where the system has no such libraries, nothing happens.
void keepLoaded(const void* address);

}  // namespace rivulet
