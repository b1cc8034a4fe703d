// `rivulet run --explain`: unused features are neither compiled nor run, and the others are listed with their cost.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/program_runner.h"

namespace rivulet::testing::program_explain_test {
namespace {

// The lines under a heading that begins so, without the blanks before them.
std::vector<std::string> under(const std::string& text, const std::string& heading) {
    std::vector<std::string> lines;
    bool inside = false;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find('\n', at), text.size());
        const std::string line = text.substr(at, end - at);
        at = end + 1;
        if (!line.starts_with(' ')) {
            inside = line.starts_with(heading);
            continue;
        }
        if (inside) lines.push_back(line.substr(line.find_first_not_of(' ')));
    }
    return lines;
}

bool anyBegins(const std::vector<std::string>& lines, const std::string& with) {
    return std::any_of(lines.begin(), lines.end(), [&](const std::string& l) { return l.starts_with(with); });
}

std::string explained(const std::string& scene, const std::string& method, const std::string& backend) {
    Scratch scratch;
    RunOptions in;
    in.folder = scratch.path();
    scratch.file("s.json", scene);
    const Outcome outcome = runProgram({"run", "s.json", "--no-render", "--backend", backend, "--frames", "2", "--explain", "--stats",
                                        "o.json", "--set", "fluid.method=" + method},
                                       in);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return outcome.out;
}

const char* const kOpen = R"({"name": "open", "fluid": {"spacing": 0.05, "gravity": [0, 0, 0],
    "box": {"min": [0, 0, 0], "max": [0.5, 0.5, 0.5], "periodicX": true, "periodicY": true, "periodicZ": true},
    "blocks": [{"min": [0.1, 0.1, 0.1], "max": [0.3, 0.3, 0.3]}]}})";

TEST(ProgramExplain, AWorldWithoutWallsBodiesOrTensionCompilesNoneOfTheirCode) {
    for (const char* backend : {"cpu", "gl", "cl"})
        for (const char* method : {"dfsph", "pbf", "wcsph"}) {
            SCOPED_TRACE(fmt::format("{} {}", backend, method));
            const std::string out = explained(kOpen, method, backend);
            const std::vector<std::string> left = under(out, "left out"), made = under(out, "compiled");
            for (const char* part : {"walls", "floating bodies", "surface tension"}) EXPECT_TRUE(anyBegins(left, part)) << part << out;
            ASSERT_GT(made.size(), 5U);
            for (const std::string& kernel : made) {
                for (const char* path : {"fluid/solids/near_walls", "fluid/wall", "fluid/solids/collide", "fluid/solids/place_samples",
                                         "fluid/solids/push_samples", "fluid/forces/cohesion", "fluid/sources/emit"})
                    EXPECT_FALSE(kernel.starts_with(path)) << kernel;
                EXPECT_EQ(kernel.find("MATTER"), std::string::npos) << kernel;
            }
            // Kernels that would read walls are compiled without them.
            for (const char* path : {"fluid/methods/dfsph_density", "fluid/methods/dfsph_rate", "fluid/methods/dfsph_push", "fluid/pbf_",
                                     "fluid/wcsph_", "fluid/methods/integrate"})
                for (const std::string& kernel : made)
                    if (kernel.starts_with(path)) EXPECT_NE(kernel.find("OPEN"), std::string::npos) << kernel;
        }
}

TEST(ProgramExplain, PartsThatASceneNeedsAreListedWithTheirCost) {
    const std::string out = explained(R"({"name": "all", "fluid": {"spacing": 0.05, "forces": {"tension": 0.07},
        "box": {"min": [0, 0, 0], "max": [1, 1, 1]}, "blocks": [{"min": [0, 0, 0], "max": [0.3, 0.3, 0.3]}]},
        "bodies": [{"shape": "box", "size": [0.2, 0.2, 0.2], "position": [0.7, 0.5, 0.7]}]})",
                                      "dfsph", "cpu");
    const std::vector<std::string> left = under(out, "left out"), made = under(out, "compiled"), costs = under(out, "costs");
    for (const char* part : {"walls", "floating bodies", "surface tension"}) EXPECT_FALSE(anyBegins(left, part)) << part << out;
    for (const char* kernel :
         {"fluid/solids/near_walls", "fluid/solids/place_samples", "fluid/forces/cohesion", "fluid/methods/dfsph_push MATTER"})
        EXPECT_TRUE(anyBegins(made, kernel)) << kernel << out;
    EXPECT_TRUE(anyBegins(left, "emitters"));
    ASSERT_GT(costs.size(), 5U);
    EXPECT_NE(costs.back().find("simulation, in all"), std::string::npos);
    for (const std::string& line : costs) EXPECT_GE(std::stod(line), 0) << line;
}

}  // namespace
}  // namespace rivulet::testing::program_explain_test
