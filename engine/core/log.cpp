#include "engine/core/log.h"

#include <cstdio>
#include <cstdlib>

#include "engine/core/assert.h"

namespace rivulet {

Log stderrLog(LogLevel least) {
    return Log{[least](LogLevel level, std::string_view text) {
        if (level < least) return;
        std::fprintf(stderr, "rivulet: %.*s\n", static_cast<int>(text.size()), text.data());
    }};
}

void assertFailed(const char* condition, const char* remedy, const char* file, int line) {
    std::fprintf(stderr, "%s:%d: assertion '%s' failed: %s\n", file, line, condition, remedy);
    std::abort();
}

}  // namespace rivulet
