// Functions of OpenGL that a test replaces by its own, where a program finds them by eglGetProcAddress().
#pragma once

#include <EGL/egl.h>

#include <cstring>
#include <span>

namespace rivulet::testing {

using GlFunction = __eglMustCastToProperFunctionPointerType;

struct ReplacedGl {
    const char* name;
    GlFunction by;
    void (*keep)(GlFunction own);  // receives the driver's
};
// A row: `by` replaces `name`; the driver's is kept in `own`.
template <auto& own, class F>
ReplacedGl replacedGl(const char* name, F* by) {
    return {name, reinterpret_cast<GlFunction>(by), [](GlFunction driver) { own = reinterpret_cast<F*>(driver); }};
}
#define REPLACED_GL(by, name) rivulet::testing::replacedGl<own_##name>(#name, by##_##name)

// What a program gets that asks for `name`: `own` is the driver's.
inline GlFunction replaced(std::span<const ReplacedGl> all, const char* name, GlFunction own) {
    if (own == nullptr) return own;
    for (const ReplacedGl& one : all)
        if (std::strcmp(one.name, name) == 0) {
            one.keep(own);
            return one.by;
        }
    return own;
}

}  // namespace rivulet::testing
