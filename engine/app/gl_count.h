// Counts calls of OpenGL by name, for a library that looks its functions up with countingFind().
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "engine/gpu/load.h"

namespace rivulet {

// As eglGetProcAddress, of functions that count.
gpu::FunctionPointer countingFind(const char* name);

struct GlCalls {
    std::map<std::string, size_t> byName;
    size_t all() const;
    size_t of(const std::string& beginning) const;  // of names that begin so
    size_t questions() const;                       // state that the driver is asked for: not the results of queries
    std::string text() const;                       // the most frequent first, for a person
};
// The calls of `work`.
void startGlCount();
GlCalls glCount();
template <class Work>
GlCalls glCallsOf(const Work& work) {
    startGlCount();
    work();
    return glCount();
}

}  // namespace rivulet
