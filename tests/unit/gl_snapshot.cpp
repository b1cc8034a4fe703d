#include "tests/unit/gl_snapshot.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <array>
#include <cmath>
#include <set>

namespace rivulet::testing {
namespace {

constexpr GLenum kFirst = 0x0B00, kLast = 0x9400;  // where OpenGL 4.5 has the numbers of pieces of state
constexpr double kUntouched = -12345.678;

// Values that change by themselves: clocks, the free memory of a driver, and what a driver notes about its own doings (where a buffer
// lies).
const std::set<GLenum> kMoving = {GL_TIMESTAMP,
                                  0x87FB,
                                  0x87FC,
                                  0x87FD,
                                  0x9047,
                                  0x9048,
                                  0x9049,
                                  0x904A,
                                  0x904B,
                                  GL_DEBUG_LOGGED_MESSAGES,
                                  GL_DEBUG_NEXT_LOGGED_MESSAGE_LENGTH};

std::vector<double> trimmed(const std::array<double, 1024>& values) {
    size_t n = 0;
    for (size_t k = 0; k < values.size(); ++k)
        if (values[k] != kUntouched) n = k + 1;
    return {values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n)};
}

bool asked() { return glGetError() == GL_NO_ERROR; }

}  // namespace

GlSnapshot glSnapshot() {
    GlSnapshot all;
    while (glGetError() != GL_NO_ERROR) {
    }
    GLint units = 0, active = 0;
    glGetIntegerv(GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS, &units);
    glGetIntegerv(GL_ACTIVE_TEXTURE, &active);
    std::vector<GLenum> known;
    for (GLenum what = kFirst; what < kLast; ++what) {
        if (kMoving.contains(what)) continue;
        std::array<double, 1024> values;
        values.fill(kUntouched);
        glGetDoublev(what, values.data());
        if (asked()) {
            all[fmt::format("{:#06x}", what)] = trimmed(values);
            known.push_back(what);
        }
        const GLboolean on = glIsEnabled(what);
        if (asked()) all[fmt::format("{:#06x} enabled", what)] = {double(on)};
        for (GLuint index = 0; index < 96; ++index) {
            values.fill(kUntouched);
            glGetDoublei_v(what, index, values.data());
            bool there = asked();
            if (there) all[fmt::format("{:#06x}[{}]", what, index)] = trimmed(values);
            GLint64 wide = 0;
            glGetInteger64i_v(what, index, &wide);
            if (asked()) {
                there = true;
                all[fmt::format("{:#06x}[{}] wide", what, index)] = {double(wide)};
            }
            const GLboolean ith = glIsEnabledi(what, index);
            if (asked()) {
                there = true;
                all[fmt::format("{:#06x}[{}] enabled", what, index)] = {double(ith)};
            }
            if (!there) break;
        }
    }
    for (GLint unit = 0; unit < units; ++unit) {
        glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
        for (const GLenum what : known) {
            if (what == GL_ACTIVE_TEXTURE) continue;
            std::array<double, 1024> values;
            values.fill(kUntouched);
            glGetDoublev(what, values.data());
            if (asked() && trimmed(values) != all[fmt::format("{:#06x}", what)])
                all[fmt::format("{:#06x} of unit {}", what, unit)] = trimmed(values);
        }
    }
    glActiveTexture(static_cast<GLenum>(active));
    return all;
}

std::string difference(const GlSnapshot& before, const GlSnapshot& after) {
    std::string text;
    const auto told = [](const GlSnapshot& of, const std::string& name) {
        const auto found = of.find(name);
        std::string list = found == of.end() ? "nothing" : "";
        if (found != of.end())
            for (const double v : found->second) list += fmt::format("{} ", v);
        return list;
    };
    std::set<std::string> names;
    for (const GlSnapshot* s : {&before, &after})
        for (const auto& [name, values] : *s) names.insert(name);
    for (const std::string& name : names)
        if (told(before, name) != told(after, name)) text += fmt::format("{}: {} -> {}\n", name, told(before, name), told(after, name));
    return text;
}

}  // namespace rivulet::testing
