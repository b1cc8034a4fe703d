// Scenes and meshes that make no sense: exit 2, one plain sentence that names file and place, in bounded time and memory, nothing written.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/unit/program_runner.h"

namespace rivulet::testing::program_bad_scene_test {
namespace {

constexpr const char* kTriangle = "v 0 0 0\nv 0.2 0 0\nv 0 0.2 0\nf 1 2 3\n";

// Runs the scene headless; expects exit 2, one sentence that holds all of `mentions`, and no file beside those that were there.
void expectBad(const Scratch& scratch, const std::string& scene, const std::vector<std::string>& mentions) {
    std::vector<std::string> before = scratch.contents();
    Outcome outcome = runProgram({"run", scene, "--headless", "--no-render", "--backend", "cpu", "--frames", "1"}, in(scratch));
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_EQ(linesIn(outcome.err), 1U) << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("rivulet: ")) << outcome.err;
    EXPECT_LT(outcome.err.size(), 1000U);
    for (const std::string& text : mentions)
        EXPECT_NE(outcome.err.find(text), std::string::npos) << "'" << text << "' is not in: " << outcome.err;
    EXPECT_EQ(scratch.contents(), before);
    EXPECT_LT(outcome.seconds, 20);
    EXPECT_LT(outcome.peakKiB, 700 * 1024);
}

TEST(ProgramBadScene, TheFileItself) {
    Scratch scratch;
    expectBad(scratch, "nowhere.json", {"nowhere.json"});
    expectBad(scratch, scratch.path().string(), {scratch.path().string()});
    std::ofstream(scratch.path() / "empty.json");
    expectBad(scratch, scratch.file("empty.json"), {"empty.json"});
    expectBad(scratch, scratch.file("zeros.json", std::string(1000, '\0')), {"zeros.json"});
    expectBad(scratch, scratch.file("half.json", R"({"name": "half", "fluid": {"spacing")"), {"half.json"});
    expectBad(scratch, scratch.file("list.json", "[1, 2]"), {"list.json"});
    expectBad(scratch, scratch.file("twice.json", smallScene() + smallScene()), {"twice.json"});
}

TEST(ProgramBadScene, KeysTypesAndRanges) {
    Scratch scratch;
    expectBad(scratch, scratch.file("key.json", "{\n  \"fluid\": {\"spacin\": 0.1}\n}"),
              {"key.json", "2", "fluid", "spacin", "did you mean fluid.spacing"});
    expectBad(scratch, scratch.file("type.json", "{\n \"fluid\": {\"spacing\": \"wide\"}\n}"), {"type.json", "2", "spacing"});
    expectBad(scratch, scratch.file("range.json", "{\"fluid\": {\"spacing\": -1}}"), {"range.json", "spacing"});
    expectBad(scratch, scratch.file("big.json", "{\"fluid\": {\"spacing\": 1e400}}"), {"big.json"});
    expectBad(scratch, scratch.file("method.json", "{\"fluid\": {\"method\": \"wcsp\"}}"), {"method.json", "did you mean wcsph?"});
    expectBad(scratch, scratch.file("vector.json", "{\"camera\": {\"position\": [1, 2]}}"), {"vector.json", "position"});
}

// 100 MB of brackets: refused, not parsed to the end of the stack.
TEST(ProgramBadScene, AHundredMegabytesOfBrackets) {
    Scratch scratch;
    std::string path = scratch.file("brackets.json");
    {
        std::ofstream stream(path, std::ios::binary);
        std::string block(1 << 20, '[');
        for (int i = 0; i < 100; ++i) stream << block;
    }
    expectBad(scratch, path, {"brackets.json"});
    expectBad(scratch, scratch.file("deep.json", std::string(100000, '[')), {"deep.json"});
    expectBad(scratch,
              scratch.file("objects.json",
                           [] {
                               std::string text;
                               for (int i = 0; i < 50000; ++i) text += "{\"fluid\":";
                               return text;
                           }()),
              {"objects.json"});
}

TEST(ProgramBadScene, CollidersThatCannotMoveSo) {
    Scratch scratch;
    scratch.file("good.obj", kTriangle);
    const auto sceneOf = [&](const std::string& rest) {
        return scratch.file("scene.json", smallScene(R"("colliders": [{"mesh": "good.obj", )" + rest + "}]"));
    };
    expectBad(scratch, sceneOf(R"("shape": "plane", "motion": {"spin": 10})"), {"scene.json", "colliders[0]", "plane"});
    expectBad(scratch, sceneOf(R"("motion": {"spin": 10}, "wave": {"amplitude": 0.1})"), {"colliders[0]", "motion", "wave"});
    expectBad(scratch, sceneOf(R"("motion": {"keys": [{"time": 2}, {"time": 1}]})"), {"colliders[0].motion.keys[1].time", "later"});
    expectBad(scratch, sceneOf(R"("motion": {"spin": 10, "axis": [0, 0, 0]})"), {"colliders[0].motion.axis"});
    expectBad(scratch, sceneOf(R"("wave": {"amplitude": 0.1, "along": [0, 0, 0]})"), {"colliders[0].wave.along"});
    expectBad(scratch, sceneOf(R"("friction": -2)"), {"friction"});
    expectBad(scratch, sceneOf(R"("restitution": -0.5)"), {"colliders[0].restitution", "-0.5"});
    expectBad(scratch, sceneOf(R"("motion": {"spinn": 10})"), {"did you mean", "spin"});
    std::string many = R"("colliders": [)";
    for (int k = 0; k < 20; ++k) many += fmt::format(R"({}{{"shape": "plane", "friction": {}}})", k == 0 ? "" : ", ", 0.1 * k);
    expectBad(scratch, scratch.file("scene.json", smallScene(many + "]")), {"20 different pairs", "16"});
}

TEST(ProgramBadScene, Meshes) {
    Scratch scratch;
    auto sceneOf = [&](const std::string& mesh) {
        return scratch.file("scene.json", smallScene(R"("colliders": [{"mesh": ")" + mesh + R"(", "resolution": 16}])"));
    };
    expectBad(scratch, sceneOf("missing.obj"), {"missing.obj"});
    std::ofstream(scratch.path() / "nothing.obj");
    expectBad(scratch, sceneOf("nothing.obj"), {"nothing.obj"});
    scratch.file("noise.obj", std::string("\x01\x02garbage\xff\n", 12));
    expectBad(scratch, sceneOf("noise.obj"), {"noise.obj"});
    scratch.file("points.obj", "v 0 0 0\nv 1 0 0\n");
    expectBad(scratch, sceneOf("points.obj"), {"points.obj"});
    scratch.file("nan.obj", "v 0 0 0\nv nan 0 0\nv 0 inf 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 4 5\n");
    expectBad(scratch, sceneOf("nan.obj"), {"nan.obj", "2"});
    scratch.file("good.obj", kTriangle);
    Outcome good = runProgram({"run", sceneOf("good.obj"), "--headless", "--no-render", "--backend", "cpu", "--frames", "1"}, in(scratch));
    EXPECT_EQ(good.code, 0) << good.err;
}

}  // namespace
}  // namespace rivulet::testing::program_bad_scene_test
