#include "tests/races/orders.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <regex>
#include <string_view>
#include <utility>

#include "engine/core/assert.h"
#include "engine/core/file.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "tests/races/small_worlds.h"

namespace rivulet::races {
namespace {

// Of lang.h: the numbers of GLSL, then of OpenCL C, whose group is `group` of `groups`.
struct Numbers {
    std::string_view thread, local, group;
};
constexpr Numbers kGlsl = {"#define THREAD_ID (gl_GlobalInvocationID.x + groupBase_ * LOCAL_SIZE)",
                           "#define LOCAL_ID gl_LocalInvocationID.x\n", "#define GROUP_ID (gl_WorkGroupID.x + groupBase_)"};
constexpr Numbers kOpencl = {"#define THREAD_ID ((uint)get_global_id(0))", "#define LOCAL_ID ((uint)get_local_id(0))",
                             "#define GROUP_ID ((uint)get_group_id(0))"};

constexpr std::string_view kAfterLanguages = "#if !defined(__cplusplus)  // on a GPU";
constexpr const char* kSeedVariable = "RIVULET_ORDER_SEED";

Status replace(std::string& text, std::string_view from, const std::string& to) {
    const size_t at = text.find(from);
    if (at == std::string::npos) return failed("shaders/common/lang.h has no line " + std::string(from) + "; adapt tests/races/orders.cpp");
    text.replace(at, from.size(), to);
    return ok();
}

// Each is a permutation: of any number of groups, and of a work group's power of two.
std::string groupIn(const Order& order, const std::string& group, const std::string& groups) {
    if (order.kind == Order::Kind::backwards) return fmt::format("({1} - 1u - {0})", group, groups);
    if (order.kind == Order::Kind::shuffled) return fmt::format("shuffled({}, {}, {}u)", group, groups, order.seed);
    return fmt::format("({0} < ({1} + 1u) / 2u ? 2u * {0} : 2u * ({0} - ({1} + 1u) / 2u) + 1u)", group, groups);  // the even ones first
}
std::string localIn(const Order& order, const std::string& local, const std::string& group) {
    if (order.kind == Order::Kind::backwards) return "(LOCAL_SIZE - 1u - " + local + ")";
    if (order.kind == Order::Kind::shuffled) return fmt::format("shuffled({}, LOCAL_SIZE, {}u + {})", local, order.seed, group);
    return "((" + local + " * 29u + 11u) % LOCAL_SIZE)";
}

using uint = uint32_t;
#define FN inline
#include "tests/races/shuffled.inc"
#undef FN

// A CpuKernelRow is a function without state: so each row has a function of its own, which runs its kernel, and the order is kept beside
// them.
constexpr size_t kMostRows = 1024;
std::array<CpuKernelFn, kMostRows> ownRows;
Order ownOrder;
template <size_t row>
void runInOrder(uint32_t begin, uint32_t end, const void* params, void* const* buffers) {
    for (uint32_t k = 0; k < end - begin; ++k) {
        const uint32_t item = begin + ownOrder.item(k, end - begin);
        ownRows[row](item, item + 1, params, buffers);
    }
}
template <size_t... rows>
constexpr std::array<CpuKernelFn, sizeof...(rows)> functionsOf(std::index_sequence<rows...>) {
    return {runInOrder<rows>...};
}
constexpr auto kInOrder = functionsOf(std::make_index_sequence<kMostRows>());

}  // namespace

std::string Order::name() const {
    if (kind == Kind::shuffled) return fmt::format("shuffled by {}={}", kSeedVariable, seed);
    return kind == Kind::backwards ? "backwards" : "interleaved";
}

uint32_t Order::item(uint32_t k, uint32_t count) const {
    if (kind == Kind::backwards) return count - 1 - k;
    if (kind == Kind::shuffled) return shuffled(k, count, seed);
    const uint32_t half = (count + 1) / 2;
    return k < half ? 2 * k : 2 * (k - half) + 1;
}

Result<uint32_t> orderSeed() {
    static const uint32_t other = full() ? std::random_device()() : 1;
    const char* text = std::getenv(kSeedVariable);
    if (text == nullptr) return other;
    uint32_t seed = 0;
    const std::string_view digits = text;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), seed);
    if (error != std::errc() || end != digits.data() + digits.size())
        return failed(fmt::format("{}={} is no whole number from 0 to {}", kSeedVariable, text, UINT32_MAX));
    return seed;
}

Result<ShaderFiles> shadersIn(const Order& order) {
    ShaderFiles files = ShaderFiles::developer();
    Result<std::string> lang = files.load("shaders/common/lang.h"),
                        formula = readFile(std::string(RIVULET_SOURCE_DIR) + "/tests/races/shuffled.inc");
    if (!lang) return lang.error();
    if (!formula) return formula.error();
    std::string text = *lang;
    const std::string thread = "#define THREAD_ID (GROUP_ID * LOCAL_SIZE + LOCAL_ID)";
    struct Built {  // the numbers that the languages have built in
        const char *group, *groups, *local;
    };
    const Built glsl = {"gl_WorkGroupID.x", "gl_NumWorkGroups.x", "gl_LocalInvocationID.x"},
                opencl = {"(uint)get_group_id(0)", "(uint)get_num_groups(0)", "(uint)get_local_id(0)"};
    for (const Status& done :
         {replace(text, kGlsl.thread, thread),
          replace(text, kGlsl.local, "#define LOCAL_ID " + localIn(order, glsl.local, glsl.group) + "\n"),
          replace(text, kGlsl.group, "#define GROUP_ID (" + groupIn(order, glsl.group, glsl.groups) + " + groupBase_)"),
          replace(text, kOpencl.thread, thread),
          replace(text, kOpencl.local, "#define LOCAL_ID " + localIn(order, opencl.local, opencl.group)),
          replace(text, kOpencl.group, "#define GROUP_ID " + groupIn(order, opencl.group, opencl.groups)),
          replace(text, kAfterLanguages, "#include \"shaders/test/shuffled.h\"\n" + std::string(kAfterLanguages))})
        if (!done) return done.error();
    files.add("shaders/test/shuffled.h", std::move(*formula));
    files.add("shaders/common/lang.h", std::move(text));
    return files;
}

namespace {

// Definitions of min, max and clamp for both languages, of the types that kernels use.
std::string otherMinAndMax(NanHabit habit) {
    std::string text =
        "\n#if defined(__OPENCL_C_VERSION__)\n#define FREE static inline __attribute__((overloadable))\n#elif !defined(__cplusplus)\n"
        "#define FREE\n#endif\n#if !defined(__cplusplus)\n";
    for (const auto& [name, less] : {std::pair("Min", "<"), std::pair("Max", ">")}) {
        const std::string nan = habit == NanHabit::spreads ? "(FLOAT_BITS(a) & 0x7FFFFFFFu) > 0x7F800000u ? a : " : "";
        text += fmt::format("FREE float free{0}(float a, float b) {{ return {2}a {1} b ? a : b; }}\n", name, less, nan);
        for (const char* type : {"int", "uint"})
            text += fmt::format("FREE {2} free{0}({2} a, {2} b) {{ return a {1} b ? a : b; }}\n", name, less, type);
        text += fmt::format(
            "FREE vec2 free{0}(vec2 a, vec2 b) {{ return vec2(free{0}(a.x, b.x), free{0}(a.y, b.y)); }}\n"
            "FREE vec3 free{0}(vec3 a, vec3 b) {{ return vec3(free{0}(a.x, b.x), free{0}(a.y, b.y), free{0}(a.z, b.z)); }}\n"
            "FREE vec4 free{0}(vec4 a, vec4 b) {{ return vec4(free{0}(a.xyz, b.xyz), free{0}(a.w, b.w)); }}\n",
            name);
    }
    for (const char* type : {"float", "int", "uint"})
        text += fmt::format("FREE {0} freeClamp({0} a, {0} low, {0} high) {{ return freeMin(freeMax(a, low), high); }}\n", type);
    return text + "#undef min\n#undef max\n#undef clamp\n#define min freeMin\n#define max freeMax\n#define clamp freeClamp\n#endif\n";
}

}  // namespace

Result<ShaderFiles> shadersWith(NanHabit habit) {
    ShaderFiles files = ShaderFiles::developer();
    if (habit != NanHabit::inverts) {
        const Result<std::string> lang = files.load("shaders/common/lang.h");
        if (!lang) return lang.error();
        files.add("shaders/common/lang.h", *lang + otherMinAndMax(habit));
        return files;
    }
    // One comparison of operands that may hold calls, but no other logic.
    const std::string operand = "((?:[^()&|<>=!?;]|\\((?:[^()]|\\([^()]*\\))*\\))+)";
    const std::regex negated("!\\(" + operand + " (<|>|<=|>=) " + operand + "\\)");
    size_t inverted = 0;
    const std::filesystem::path root = RIVULET_SOURCE_DIR;
    for (const auto& file : std::filesystem::recursive_directory_iterator(root / "shaders")) {
        const std::string path = std::filesystem::relative(file.path(), root).string();
        if (!file.is_regular_file() || path.starts_with("shaders/common")) continue;
        const Result<std::string> text = files.load(path);
        if (!text) return text.error();
        std::string made;
        auto rest = text->cbegin();
        for (std::smatch m; std::regex_search(rest, text->cend(), m, negated); rest = m[0].second, ++inverted) {
            made.append(rest, m[0].first);
            made += fmt::format("({} {} {})", m[1].str(), m[2] == "<" ? ">=" : m[2] == ">" ? "<=" : m[2] == "<=" ? ">" : "<", m[3].str());
        }
        made.append(rest, text->cend());
        if (made != *text) files.add(path, std::move(made));
    }
    if (inverted < 20) return failed("few shaders have comparisons of the form !(a < b); adapt tests/races/orders.cpp");
    return files;
}

std::unique_ptr<CpuDevice> cpuIn(const Order& order) {
    std::vector<CpuKernelRow> rows;
    for (const CpuKernelRow& row : cpuKernels())
        if (row.isa == Isa::generic) rows.push_back(row);  // results are the same with each
    ASSERT(rows.size() <= kMostRows, "raise kMostRows");
    ownOrder = order;
    for (size_t k = 0; k < rows.size(); ++k) {
        ownRows[k] = rows[k].run;
        rows[k].run = kInOrder[k];
        rows[k].grain = UINT32_MAX;  // all work items in one call
    }
    return makeCpuDevice(rows, {.threads = 1, .isa = Isa::generic});
}

}  // namespace rivulet::races
