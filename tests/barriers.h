// A watch over glMemoryBarrier, independent of the code that places them: what OpenGL's specification requires (4.5 core, section 7.12.2)
// is checked at each call of OpenGL, for each buffer and image.
//
// Stores of shaders (storage buffers, images) are visible to a later use only behind a glMemoryBarrier with the bit of that use; and a
// later store must not overtake a use before it, which takes the bit of the store. Drivers often order more than that by themselves: zink
// does, and no result then shows that a barrier is missing.
//
// Part of every test program. It takes the place of eglGetProcAddress, by which contexts without a window find OpenGL's functions.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace rivulet::barriers {

// What was watched since the program began.
struct Watched {
    size_t dispatches = 0, draws = 0, copies = 0, barriers = 0;
    size_t uses = 0;  // of buffers and images, that were checked
};
Watched watched();

// Sentences on uses without a barrier since the last call, each once: "flow/paint reads the storage buffer film, which flow/born wrote
// ...".
std::vector<std::string> takeMissing();

// For tests of the watch: the `n`-th glMemoryBarrier from now on is left out, for OpenGL and for the watch; 0: none.
void leaveOutBarrier(size_t n);

}  // namespace rivulet::barriers
