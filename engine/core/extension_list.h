// Lists of words with blanks between them, as drivers name what they can do.
#pragma once

#include <cstddef>
#include <string_view>

namespace rivulet {

// Whether `word` is one of them, from blank to blank: "cl_khr_gl_sharing" is not in "cl_khr_gl_sharing_more".
inline bool hasExtension(std::string_view words, std::string_view word) {
    for (size_t at = words.find(word); at != std::string_view::npos; at = words.find(word, at + 1)) {
        const size_t end = at + word.size();
        if ((at == 0 || words[at - 1] == ' ') && (end == words.size() || words[end] == ' ')) return true;
    }
    return false;
}

}  // namespace rivulet
