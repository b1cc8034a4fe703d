// What a thread has worked, whatever others did on its core meanwhile.
#pragma once

#include <ctime>

namespace rivulet {

// s, of the thread that asks.
inline double threadSeconds() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace rivulet
