// Notices: plain sentences for the person at the program. A Log is handed to whoever may speak; there is no global one.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace rivulet {

enum class LogLevel { info, notice, warning, error };

// A sink; empty = silent. Called on the thread that calls the library.
struct Log {
    std::function<void(LogLevel, std::string_view)> sink;
    void info(std::string_view text) const {
        if (sink) sink(LogLevel::info, text);
    }
    void notice(std::string_view text) const {
        if (sink) sink(LogLevel::notice, text);
    }
    void warning(std::string_view text) const {
        if (sink) sink(LogLevel::warning, text);
    }
    void error(std::string_view text) const {
        if (sink) sink(LogLevel::error, text);
    }
};

// A sink that writes to stderr, "rivulet: sentence".
Log stderrLog(LogLevel least = LogLevel::notice);

}  // namespace rivulet
