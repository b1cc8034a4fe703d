#include "engine/core/log.h"

#if defined(_WIN32)
#include <io.h>
#else
#include <unistd.h>
#endif

#include <cstdio>
#include <cstdlib>

#include "engine/core/assert.h"
#include "engine/core/message_line.h"

namespace rivulet {

Log stderrLog(LogLevel least) {
    return Log{[least](LogLevel level, std::string_view text) {
        if (level < least) return;
        const char* erase = isatty(2) != 0 ? "\r\033[K" : "";  // a bar of progress may be there
        std::fprintf(stderr, "%srivulet: %s\n", erase, messageLine(text).c_str());
    }};
}

void assertFailed(const char* condition, const char* remedy, const char* file, int line) {
    std::fprintf(stderr, "%s:%d: assertion '%s' failed: %s\n", file, line, condition, remedy);
    std::abort();
}

}  // namespace rivulet
