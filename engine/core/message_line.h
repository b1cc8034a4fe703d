// Text that may contain the names of files, made fit for a terminal: no control character reaches it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace rivulet {

// Control characters, marks that reverse the direction of text, line ends and bytes that are no UTF-8 become escapes: \n, \x1b, \u202e.
std::string printable(std::string_view text);

// As printable, at most `most` characters: the folders of long paths are left out first, then the middle.
constexpr size_t kLongestMessage = 490;  // with "rivulet: " less than 500
std::string messageLine(std::string_view text, size_t most = kLongestMessage);

}  // namespace rivulet
