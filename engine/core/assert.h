// ASSERT(cond, "remedy"): stops the program on a programming error. Compiled into every build; user data is checked with Result instead.
#pragma once

namespace rivulet {
[[noreturn]] void assertFailed(const char* condition, const char* remedy, const char* file, int line);
}

#define ASSERT(cond, remedy) ((cond) ? (void)0 : ::rivulet::assertFailed(#cond, remedy, __FILE__, __LINE__))
