#include "engine/core/message_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>

namespace rivulet {

namespace {

struct Character {
    char32_t code = 0;
    size_t bytes = 0;  // 0: no UTF-8
};

// The first character of `text`, which is not empty. Strict: no overlong forms, no surrogates.
Character firstOf(std::string_view text) {
    const auto byte = [&](size_t k) { return static_cast<unsigned char>(text[k]); };
    const unsigned lead = byte(0);
    if (lead < 0x80) return {lead, 1};
    const size_t bytes = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
    if (lead < 0xC2 || lead > 0xF4 || text.size() < bytes) return {};
    char32_t code = lead & (0xFFU >> (bytes + 1));
    for (size_t k = 1; k < bytes; ++k) {
        if ((byte(k) & 0xC0U) != 0x80) return {};
        code = code << 6U | (byte(k) & 0x3FU);
    }
    constexpr std::array<char32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
    if (code < kLeast[bytes] || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) return {};
    return {code, bytes};
}

bool isPlain(char32_t c) {
    const bool control = c < 0x20 || (c >= 0x7F && c < 0xA0) || c == 0x2028 || c == 0x2029;
    const bool direction = c == 0x061C || c == 0x200E || c == 0x200F || (c >= 0x202A && c <= 0x202E) || (c >= 0x2066 && c <= 0x2069);
    return !control && !direction;
}

std::string escapeOf(char32_t c) {
    if (c == '\n') return "\\n";
    if (c == '\t') return "\\t";
    if (c == '\r') return "\\r";
    return c < 0x80 ? fmt::format("\\x{:02x}", static_cast<uint32_t>(c)) : fmt::format("\\u{:04x}", static_cast<uint32_t>(c));
}

size_t charactersIn(std::string_view text) {
    return static_cast<size_t>(
        std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80; }));
}

// `at`, or the begin of the character that it is in.
size_t characterAt(std::string_view text, size_t at) {
    while (at > 0 && at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80) --at;
    return at;
}

// The byte at which the character of that number begins.
size_t byteOf(std::string_view text, size_t character) {
    size_t at = 0;
    for (; at < text.size() && character > 0; --character) do
            ++at;
        while (at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80);
    return at;
}

constexpr std::string_view kGap = "...";

// The word's folders are left out, but for their beginning: "/home/ada/project/.../ball.obj".
std::string withoutFolders(std::string_view word) {
    constexpr size_t kBegin = 20, kLong = 60;  // bytes
    const size_t slash = word.find_last_of('/');
    if (slash == std::string_view::npos || slash < kLong) return std::string(word);
    return std::string(word.substr(0, characterAt(word, kBegin))) + std::string(kGap) + std::string(word.substr(slash));
}

}  // namespace

std::string printable(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        const Character c = firstOf(text);
        if (c.bytes == 0)
            out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[0]));
        else if (isPlain(c.code))
            out += text.substr(0, c.bytes);
        else
            out += escapeOf(c.code);
        text.remove_prefix(std::max(c.bytes, size_t{1}));
    }
    return out;
}

std::string messageLine(std::string_view text, size_t most) {
    std::string line = printable(text);
    if (charactersIn(line) <= most) return line;
    std::string shorter;
    for (size_t at = 0; at < line.size();) {
        const size_t space = std::min(line.find(' ', at), line.size()), next = std::min(space + 1, line.size());
        shorter += withoutFolders(std::string_view(line).substr(at, space - at)) + line.substr(space, next - space);
        at = next;
    }
    const size_t length = charactersIn(shorter);
    if (length <= most) return shorter;
    const size_t kept = most - kGap.size(), begin = kept * 3 / 5;
    return shorter.substr(0, byteOf(shorter, begin)) + std::string(kGap) + shorter.substr(byteOf(shorter, length - (kept - begin)));
}

}  // namespace rivulet
