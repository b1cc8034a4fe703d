// Part of every test program: what it caches, and what the programs that it starts cache, lies in the build folder, never in the user's.
#include <cstdlib>

namespace {
const int kCacheIsOwn = ::setenv("XDG_CACHE_HOME", RIVULET_TEST_CACHE, 1);
}
