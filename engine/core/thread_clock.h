// CPU time of a thread: time during which other threads use its core is not counted.
#pragma once

#include <ctime>

namespace rivulet {

// CPU time of the calling thread, s.
inline double threadSeconds() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace rivulet
