// ASSERT(cond, "what to do"): a programmer's mistake. Always on; never for user data (that is Result).
#pragma once

namespace rivulet {
[[noreturn]] void assertFailed(const char* condition, const char* remedy, const char* file, int line);
}

#define ASSERT(cond, remedy) ((cond) ? (void)0 : ::rivulet::assertFailed(#cond, remedy, __FILE__, __LINE__))
