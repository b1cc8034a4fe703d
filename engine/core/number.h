// Numbers from text.
#pragma once

#include <charconv>
#include <string_view>
#include <system_error>

#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 200000
#include <locale>
#include <sstream>
#include <string>
#include <type_traits>
#endif

namespace rivulet {

// Reads a number that is the whole text: no blanks, no `+`, no locale, the nearest representable number. False: another text, and `v` may
// have changed. LLVM's library has from_chars for floats from version 20 on.
template <class T>
bool parseNumber(std::string_view text, T& v) {
#if defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 200000
    if constexpr (std::is_floating_point_v<T>) {
        if (text.find_first_of("+xX \t") == 0 || text.find_first_of("xX") != std::string_view::npos) return false;
        std::istringstream stream{std::string(text)};
        stream.imbue(std::locale::classic());
        return stream >> v && stream.peek() == std::istringstream::traits_type::eof();
    } else
#endif
    {
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), v);
        return error == std::errc{} && end == text.data() + text.size();
    }
}

}  // namespace rivulet
