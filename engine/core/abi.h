// Included by every C++ header that a host includes: a host that is compiled in a way in which the library cannot work does not build, and
// is told why. The layout of vectors is checked in math.h.
#pragma once

#if (defined(_MSVC_LANG) ? _MSVC_LANG : __cplusplus) < 202002L
#error "Rivulet needs C++20: compile with -std=c++20 (CMake: target_compile_features(TARGET PRIVATE cxx_std_20)), or use its C interface"
#include <rivulet_needs_cxx_20>  // does not exist: nothing else is reported
#endif

#include <version>

// The classes of the standard library have another layout with each of these settings, and what a host passes would be misread. Each object
// file therefore refers to a name that the library defines only where it was built alike: the linker reports the name otherwise.
#if defined(_GLIBCXX_DEBUG)
#define RIVULET_BUILT is_built_with_GLIBCXX_DEBUG
#elif defined(_GLIBCXX_USE_CXX11_ABI) && !_GLIBCXX_USE_CXX11_ABI
#define RIVULET_BUILT is_built_with_GLIBCXX_USE_CXX11_ABI_0
#elif defined(_LIBCPP_VERSION)
#define RIVULET_BUILT is_built_with_libcxx
#else
#define RIVULET_BUILT is_built_with_the_defaults_of_the_standard_library
#endif
#if defined(__ELF__) && __has_cpp_attribute(gnu::retain)
#define RIVULET_KEPT [[gnu::used, gnu::retain]]  // also by -Wl,--gc-sections
#elif __has_cpp_attribute(gnu::used)
#define RIVULET_KEPT [[gnu::used]]
#else
#define RIVULET_KEPT [[maybe_unused]]
#endif

namespace rivulet::library {
extern const char RIVULET_BUILT;
RIVULET_KEPT static const char* const kBuilt = &RIVULET_BUILT;
}  // namespace rivulet::library

#if !defined(RIVULET_DEFINES_ABI)
#undef RIVULET_BUILT
#endif
#undef RIVULET_KEPT
