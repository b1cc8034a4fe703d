#include "engine/app/gl_count.h"

#include <EGL/egl.h>
#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <iterator>
#include <string_view>
#include <vector>

namespace rivulet {
namespace {

constexpr size_t kMostFunctions = 2048;
std::array<std::atomic<size_t>, kMostFunctions> glCounts;

// A function that counts, of the same signature.
template <size_t Id, class Pointer>
struct Counting;
template <size_t Id, class R, class... A>
struct Counting<Id, R (*)(A...)> {
    static inline R (*real)(A...) = nullptr;
    static R call(A... a) {
        ++glCounts[Id];
        return real(a...);
    }
    static gpu::FunctionPointer wrap(gpu::FunctionPointer found) {
        real = reinterpret_cast<R (*)(A...)>(found);
        return found == nullptr ? nullptr : reinterpret_cast<gpu::FunctionPointer>(&call);
    }
};

struct CountedRow {
    const char* name;
    gpu::FunctionPointer (*wrap)(gpu::FunctionPointer);
};
constexpr size_t kFirstCounter = __COUNTER__ + 1;
const CountedRow kCounted[] = {
#define COUNTED(name) {#name, Counting<__COUNTER__ - kFirstCounter, decltype(::name)>::wrap},
#include <gl_functions.inc>  // made by CMakeLists.txt
#undef COUNTED
};
static_assert(std::size(kCounted) < kMostFunctions);

}  // namespace

gpu::FunctionPointer countingFind(const char* name) {
    const gpu::FunctionPointer found = eglGetProcAddress(name);
    const auto row =
        std::find_if(std::begin(kCounted), std::end(kCounted), [&](const CountedRow& r) { return std::string_view(r.name) == name; });
    return row == std::end(kCounted) ? found : row->wrap(found);
}

void startGlCount() {
    for (std::atomic<size_t>& count : glCounts) count = 0;
}

GlCalls glCount() {
    GlCalls calls;
    for (size_t k = 0; k < std::size(kCounted); ++k)
        if (glCounts[k] > 0) calls.byName[kCounted[k].name] = glCounts[k];
    return calls;
}

size_t GlCalls::all() const { return of("gl"); }

size_t GlCalls::of(const std::string& beginning) const {
    size_t sum = 0;
    for (const auto& [name, count] : byName)
        if (name.starts_with(beginning)) sum += count;
    return sum;
}

size_t GlCalls::questions() const { return of("glGet") + of("glIs") - of("glGetQueryObject") - of("glGetError"); }

std::string GlCalls::text() const {
    std::vector<std::pair<size_t, std::string>> rows;
    for (const auto& [name, count] : byName) rows.emplace_back(count, name);
    std::sort(rows.rbegin(), rows.rend());
    std::string out = fmt::format("{} calls, {} of them questions\n", all(), questions());
    for (const auto& [count, name] : rows) out += fmt::format("{:6} {}\n", count, name);
    return out;
}

}  // namespace rivulet
