// Messages to the user. A function that may report something receives a Log; there is no global log.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/abi.h"

namespace rivulet {

enum class LogLevel { info, notice, warning, error };

// Passes messages to `sink`; an empty sink drops them. It is called on the thread that calls the library.
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

// Writes messages of level `least` and above to stderr as "rivulet: MESSAGE".
Log stderrLog(LogLevel least = LogLevel::notice);

}  // namespace rivulet
