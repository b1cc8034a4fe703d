// Lists of extensions separated by spaces, as OpenGL, EGL and OpenCL drivers return them.
#pragma once

#include <cstddef>
#include <string_view>

namespace rivulet {

// Whether `list` has the whole word `extension`: "cl_khr_gl_sharing" is not in "cl_khr_gl_sharing_more".
inline bool hasExtension(std::string_view list, std::string_view extension) {
    for (size_t at = list.find(extension); at != std::string_view::npos; at = list.find(extension, at + 1)) {
        const size_t end = at + extension.size();
        if ((at == 0 || list[at - 1] == ' ') && (end == list.size() || list[end] == ' ')) return true;
    }
    return false;
}

}  // namespace rivulet
