#include "engine/core/json_parse.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "engine/core/exception_error.h"
#include "engine/core/param_value.h"

namespace rivulet {

namespace {

constexpr size_t kDeepest = 64;
constexpr size_t kMostValues = size_t{1} << 18U;  // JsonCpp needs about 150 bytes per value

bool isDigit(char c) { return c >= '0' && c <= '9'; }
bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

// Checks the tokens before JsonCpp parses them. JsonCpp's strict mode accepts comments inside objects, line breaks inside strings, numbers
// such as 01, 1. and -, and anything after a zero byte; it bounds neither memory nor time; and it reads numbers by the C++ locale. All of
// this is refused here. Every digit is replaced by 0: numbers are parsed later, from the text.
class TokenCheck {
  public:
    explicit TokenCheck(std::string_view text) : text_(text), masked_(text) {}

    // False: complaint() and offset() hold the error.
    bool pass() {
        while (at_ < text_.size())
            if (!token()) return false;
        return true;
    }
    const std::string& masked() const { return masked_; }
    const std::string& complaint() const { return complaint_; }
    size_t offset() const { return at_; }

  private:
    char peek(size_t i) const { return i < text_.size() ? text_[i] : '\0'; }

    bool refuse(std::string complaint) {
        complaint_ = std::move(complaint);
        return false;
    }

    bool token() {
        const char c = text_[at_];
        if (c == '"') return string();
        if (c == '-' || isDigit(c)) return number();
        if (isLetter(c)) return word();
        if ((c == '[' || c == '{') && ++depth_ > kDeepest) return refuse(fmt::format("nesting is deeper than {} levels", kDeepest));
        if ((c == ']' || c == '}') && depth_ > 0) --depth_;
        if (c == ',' && ++values_ > kMostValues) return refuse(fmt::format("there are more than {} values", kMostValues));
        if (c == '/' || c == '#') return refuse("comments are not allowed in JSON");
        if (std::string_view("[]{},: \t\r\n").find(c) == std::string_view::npos) {
            const auto byte = static_cast<unsigned char>(c);
            return refuse(byte > 0x20 && byte < 0x7f ? fmt::format("unexpected '{}'", c) : fmt::format("unexpected byte 0x{:02x}", byte));
        }
        ++at_;
        return true;
    }

    bool string() {
        size_t end = at_ + 1;
        while (peek(end) != '"') {
            if (static_cast<unsigned char>(peek(end)) < 0x20) return refuse("the string that starts here has no closing quote on its line");
            end += peek(end) == '\\' ? 2 : 1;
        }
        at_ = end + 1;
        return true;
    }

    // -? (0 | [1-9][0-9]*) (. [0-9]+)? ([eE] [+-]? [0-9]+)?, then the end of the value
    bool number() {
        size_t end = at_ + (text_[at_] == '-' ? 1 : 0);
        const bool leadingZero = peek(end) == '0' && isDigit(peek(end + 1));
        bool valid = digits(end) && !leadingZero;
        if (peek(end) == '.') valid = digits(++end) && valid;
        if (peek(end) == 'e' || peek(end) == 'E') {
            ++end;
            if (peek(end) == '+' || peek(end) == '-') ++end;
            valid = digits(end) && valid;
        }
        const size_t rest = std::min(text_.find_first_of(",:]} \t\r\n", end), text_.size());
        if (!valid || rest != end) return refuse(fmt::format("{} is not a number in JSON", excerpt(text_.substr(at_, rest - at_))));
        std::fill(masked_.begin() + static_cast<ptrdiff_t>(at_), masked_.begin() + static_cast<ptrdiff_t>(end), '0');
        at_ = end;
        return true;
    }

    bool digits(size_t& end) const {
        const size_t start = end;
        while (isDigit(peek(end))) ++end;
        return end > start;
    }

    bool word() {
        size_t end = at_;
        while (isLetter(peek(end))) ++end;
        const std::string_view found = text_.substr(at_, end - at_);
        if (found != "true" && found != "false" && found != "null")
            return refuse(fmt::format("{} is not a value in JSON; strings and keys must be in double quotes", excerpt(found)));
        at_ = end;
        return true;
    }

    std::string_view text_;
    std::string masked_;
    std::string complaint_;
    size_t at_ = 0, depth_ = 0, values_ = 0;
};

// JsonCpp reports "* Line 3, Column 5\n  Duplicate key: 'spacing'\n", and further errors below; the first one is used.
Error jsonCppError(const std::string& report, std::string_view file) {
    int line = 1, column = 1;
    std::sscanf(report.c_str(), "* Line %d, Column %d", &line, &column);
    const size_t start = std::min(report.find("\n  "), report.size());
    std::string reason = report.substr(start, report.find('\n', start + 1) - start);
    reason.erase(0, reason.find_first_not_of(" \n"));
    if (!reason.empty() && reason.back() == '.') reason.pop_back();
    return badInput(fmt::format("{}:{}:{}: this is not JSON: {}", file, line, column, excerpt(reason)));
}

}  // namespace

std::string placeOf(std::string_view text, size_t offset) {
    const std::string_view before = text.substr(0, offset);
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const size_t lineStart = before.rfind('\n') + 1;  // npos + 1 is 0
    return fmt::format(":{}:{}", line, before.size() - lineStart + 1);
}

Result<Json::Value> parseJson(std::string_view text, std::string_view file) {
    if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
        return badInput(fmt::format("{}:1:1: the file is empty; it must contain at least {{}}", file));
    TokenCheck tokens(text);
    if (!tokens.pass())
        return badInput(fmt::format("{}{}: this is not JSON: {}", file, placeOf(text, tokens.offset()), tokens.complaint()));

    Json::CharReaderBuilder builder;
    Json::CharReaderBuilder::strictMode(&builder.settings_);
    builder["strictRoot"] = false;  // JsonReader reports a root that is not an object, with its text
    builder["stackLimit"] = static_cast<int>(2 * kDeepest);
    const std::unique_ptr<Json::CharReader> reader(builder.newCharReader());
    const std::string& masked = tokens.masked();
    Json::Value root;
    std::string report;
    try {
        if (!reader->parse(masked.data(), masked.data() + masked.size(), &root, &report)) return jsonCppError(report, file);
    } catch (const std::exception& e) {
        if (isNoMemory(e)) throw;
        return badInput(fmt::format("{}: this JSON cannot be read: {}", file, e.what()));
    }
    return root;
}

}  // namespace rivulet
