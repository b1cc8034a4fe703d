// `rivulet run --record` and `--replay`: the same pictures, without simulating; and a Viewer that shows a recording.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <signal.h>

#include "engine/core/json.h"
#include "fluid/viewer/viewer.h"
#include "tests/unit/program_runner.h"
#include "tests/unit/viewer_fixture.h"

namespace rivulet::program_replay_test {
namespace {

using testing::expectRefusal;
using testing::in;
using testing::Outcome;
using testing::runProgram;
using testing::Scratch;

const std::string kScenes = RIVULET_SOURCE_DIR "/assets/scenes/";
const std::vector<std::string> kSmall = {"--headless", "--size", "160x120", "--still", "0.05", "--still", "0.1"};

std::vector<std::string> joined(std::vector<std::string> words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

struct Case {
    const char* scene;
    const char* shows;
    std::vector<std::string> more;
};

// Solids that move, bodies, what bends, colours, foam, another backend: each picture is the simulated one, byte for byte. That nothing is
// simulated shows in that gravity upward changes nothing.
TEST(ProgramReplay, ShowsTheSamePictures) {
    const std::vector<Case> cases = {
        {"dam_break", "ellipsoids and foam", {"--set", "fluid.spacing=0.04", "--set", "fluid.foam.most=2000", "--backend", "cpu"}},
        {"dam_break", "what OpenGL simulates", {"--set", "fluid.spacing=0.05", "--backend", "gl", "--set", "look.quality=fast"}},
        {"rubber_ducks", "bodies", {"--set", "fluid.spacing=0.04", "--backend", "cpu"}},
        {"paddle_wheel", "a solid that turns", {"--set", "fluid.spacing=0.04", "--backend", "cpu"}},
        {"waving_sheet", "a solid that bends", {"--set", "fluid.spacing=0.04", "--backend", "cpu"}},
        {"oil_on_water", "two liquids", {"--set", "fluid.spacing=0.04", "--backend", "cpu"}},
        {"dam_break", "normals", {"--set", "look.renderer=points", "--set", "look.colourBy=normal", "--set", "fluid.spacing=0.05"}},
    };
    for (const Case& c : cases) {
        const Scratch scratch;
        const std::string scene = fmt::format("{}{}.json", kScenes, c.scene);
        const Outcome recorded =
            runProgram(joined(joined({"run", scene, "--record", "run.rrec", "--out", "a"}, kSmall), c.more), in(scratch));
        ASSERT_EQ(recorded.code, 0) << c.shows << ": " << recorded.err;
        EXPECT_NE(recorded.out.find("run.rrec, 7 frames"), std::string::npos) << recorded.out;
        const Outcome replayed = runProgram(joined(joined({"run", scene, "--replay", "run.rrec", "--out", "b"}, kSmall),
                                                   joined(c.more, {"--set", "fluid.gravity=0,9.81,0"})),
                                            in(scratch));
        ASSERT_EQ(replayed.code, 0) << c.shows << ": " << replayed.err;
        for (const int f : {3, 6}) {
            const std::string name = fmt::format("{}_{:04}.png", c.scene, f);
            EXPECT_TRUE(scratch.text("a/" + name) == scratch.text("b/" + name)) << c.shows << ", frame " << f;
        }
        EXPECT_FALSE(scratch.text(fmt::format("a/{}_0003.png", c.scene)) == scratch.text(fmt::format("a/{}_0006.png", c.scene)))
            << "something moves";
    }
}

TEST(ProgramReplay, ErrorsNameTheirCause) {
    const Scratch scratch;
    scratch.file("s.json", testing::smallScene());
    std::string other = testing::smallScene();
    other.replace(other.find("small"), 5, "other");
    scratch.file("other.json", other);
    scratch.file("foreign.rrec", "a picture");
    ASSERT_EQ(runProgram({"run", "s.json", "--no-render", "--frames", "4", "--record", "s.rrec"}, in(scratch)).code, 0);
    const auto refused = [&](const std::vector<std::string>& more, int code, const std::string& mentions) {
        expectRefusal(runProgram(joined({"run", "s.json", "--headless"}, more), in(scratch)), code, mentions);
    };
    refused({"--replay", "none.rrec"}, 2, "none.rrec cannot be read");
    refused({"--replay", "foreign.rrec"}, 2, "foreign.rrec: this is not the beginning of a recording");
    refused({"--replay", "s.rrec", "--stats", "x.json"}, 2, "--stats cannot be used with --replay");
    refused({"--replay", "s.rrec", "--record", "t.rrec"}, 2, "--record cannot be used with --replay");
    refused({"--replay", "s.rrec", "--no-render"}, 2, "--no-render cannot be used with --replay");
    refused({"--replay", "s.rrec", "--still", "0.5"}, 2, "s.rrec ends with frame 3, at 0.0667 s");
    refused({"--record", "nowhere/s.rrec"}, 1, "nowhere/s.rrec cannot be written");
    expectRefusal(runProgram({"run", "other.json", "--headless", "--replay", "s.rrec"}, in(scratch)), 2,
                  "s.rrec: it was recorded with name = small, this scene has name = other");
    expectRefusal(runProgram({"run", kScenes + "crying.json", "--headless", "--record", "c.rrec"}, in(scratch)), 2,
                  "a recording cannot store flow on skins");
}

// A recording names the scene and the device that it was made with; one of an earlier version does not, and is shown all the same.
TEST(ProgramReplay, ARecordingHoldsItsSceneAndDevice) {
    const Scratch scratch;
    scratch.file("s.json", testing::smallScene());
    const Outcome made = runProgram({"run", "s.json", "--no-render", "--frames", "2", "--backend", "cpu", "--record", "s.rrec", "--set",
                                     "fluid.viscosity=0.003", "--set", "doc=\"a \\\"doc\\\"\nof two lines\""},
                                    in(scratch));
    ASSERT_EQ(made.code, 0) << made.err;
    const Result<RecordingReader> reader = RecordingReader::open((scratch.path() / "s.rrec").string());
    ASSERT_TRUE(reader);
    const RecordedRun run = recordedRun(reader->about());
    EXPECT_EQ(run.version, RIVULET_VERSION);
    EXPECT_EQ(run.device.substr(0, 5), "cpu: ");
    SceneFile scene;
    ASSERT_TRUE(readJson(run.scene, "s.rrec", [&scene](ParamVisitor& v) { scene.visit(v); })) << run.scene;
    EXPECT_EQ(scene.name, "small");
    EXPECT_EQ(scene.fluid.viscosity, 0.003F);
    EXPECT_EQ(recordedRun(aboutOf(scene)).scene, "") << "of an earlier version";
    EXPECT_TRUE(isRecording((scratch.path() / "s.rrec").string()));
    std::filesystem::rename(scratch.path() / "s.rrec", scratch.path() / "other");
    EXPECT_TRUE(isRecording((scratch.path() / "other").string())) << "by its content";
    EXPECT_FALSE(isRecording((scratch.path() / "s.json").string()));
}

// Ctrl-C leaves a complete file; a truncated file is shown as far as it goes, with a notice.
TEST(ProgramReplay, ARunThatWasCutIsShown) {
    const Scratch scratch;
    scratch.file("s.json", testing::smallScene());
    testing::RunOptions cut = in(scratch);
    cut.whileRunning = [&](pid_t) {
        std::error_code none;
        const auto bytes = std::filesystem::file_size(scratch.path() / "s.rrec", none);
        return !none && bytes > 60'000 ? SIGINT : 0;
    };
    const Outcome stopped =
        runProgram({"run", "s.json", "--no-render", "--frames", "1000000", "--backend", "cpu", "--record", "s.rrec"}, cut);
    EXPECT_EQ(stopped.code, 130) << stopped.err;
    const std::vector<std::string> show = {"run", "s.json", "--headless", "--size", "64x48", "--still", "0", "--replay", "s.rrec"};
    const Outcome whole = runProgram(show, in(scratch));
    EXPECT_EQ(whole.code, 0) << whole.err;
    EXPECT_EQ(whole.err, "");
    const std::string picture = scratch.text("out/small_0000.png");
    std::filesystem::resize_file(scratch.path() / "s.rrec", 50'000);
    const Outcome rest = runProgram(show, in(scratch));
    EXPECT_EQ(rest.code, 0) << rest.err;
    EXPECT_NE(rest.err.find("s.rrec has no end: it is cut off or damaged at byte"), std::string::npos) << rest.err;
    EXPECT_TRUE(scratch.text("out/small_0000.png") == picture);
}

// A user at a window that shows a recording: keys work, and fixed values stay.
class ReplayPerson : public testing::ViewerFixture {
  protected:
    void SetUp() override {
        SceneFile scene;
        scene.name = "small";
        scene.fluid.spacing = 0.05F;
        scene.look.renderer = "points";
        scene.fluid.blocks = {{.min = vec3(0.2F), .max = vec3(0.4F)}};
        path_ = scratch_.file("p.rrec");
        begin(scene, {900, 1600}, {90, 160});
        Result<RecordingWriter> file = RecordingWriter::open(path_, aboutOf(scene));
        ASSERT_TRUE(file);
        viewer_->onStepped([&](const Session& session) { return file->add(frameOf(session)); });
        for (int f = 0; f < kFrames; ++f) frame(1.0 / 60);
        ASSERT_EQ(file->frames(), size_t{kFrames});
        ASSERT_TRUE(file->close());
        begin(scene, {900, 1600}, {90, 160});
        Result<Replay> replay = Replay::open(path_, scene, {});
        ASSERT_TRUE(replay) << replay.error().message;
        ASSERT_TRUE(viewer_->session().replay(std::move(*replay)));
    }
    size_t at() { return viewer_->session().replaying()->at(); }

    static constexpr int kFrames = 6;
    Scratch scratch_;
    std::string path_;
};

TEST_F(ReplayPerson, KeysPauseStepAndReset) {
    for (size_t f = 0; f < 3; ++f) {
        frame(1.0 / 60);
        EXPECT_EQ(at(), f);
        EXPECT_NEAR(viewer_->session().time(), (static_cast<double>(f) + 1) / 60, 1e-9);
    }
    EXPECT_EQ(viewer_->session().world().time(), 0) << "nothing is simulated";
    key(GLFW_KEY_SPACE);
    for (int k = 0; k < 3; ++k) frame(1.0 / 60);
    EXPECT_EQ(at(), 2U);
    key(GLFW_KEY_PERIOD);
    EXPECT_EQ(at(), 3U);
    key(GLFW_KEY_R);
    EXPECT_EQ(at(), 0U);
    key(GLFW_KEY_PERIOD);
    EXPECT_EQ(at(), 1U);
    key(GLFW_KEY_SPACE);
    for (int k = 0; k < 9; ++k) frame(1.0 / 60);
    EXPECT_EQ(at(), size_t{kFrames - 1}) << "the last one stays";
    EXPECT_NE(viewer_->session().replaying()->sentence().find("frame 6 of 6"), std::string::npos);
}

// Every row of the panel is pressed and dragged. Changes of recorded settings are refused with a message.
TEST_F(ReplayPerson, FixedValuesAreRefused) {
    input_.framebuffer = ivec2(0);  // the panel alone
    frame(0);
    const float spacing = viewer_->scene().fluid.spacing;
    float top = 1580;
    for (ImGuiWindow* window : ImGui::GetCurrentContext()->Windows) {
        if (std::string_view(window->Name).find("parameters") == std::string_view::npos) continue;
        window->StateStorage.SetInt(ImHashStr("fluid", 0, ImHashStr("fluid", 0, window->ID)), 1);  // unfolded
        top = window->InnerRect.Min.y;
    }
    std::string said;
    for (float y = top + 4; y < 1580; y += 12) {
        for (const vec2 to : {vec2(210, y), vec2(200, y + 2)}) {
            input_.mouseDelta = to - input_.mouse;
            input_.mouse = to;
            frame(0);
            const bool down = to.x > 205;
            (down ? input_.buttonPressed : input_.buttonReleased)[0] = true;
            input_.buttonDown[0] = down;
            frame(0);
            frame(0);
            if (!viewer_->message().empty()) said = viewer_->message();
        }
        key(GLFW_KEY_ESCAPE);
        ASSERT_NE(viewer_->session().replaying(), nullptr) << y;
    }
    EXPECT_NE(said.find("a recording is shown, which fixes all values"), std::string::npos) << said;
    EXPECT_EQ(viewer_->scene().fluid.spacing, spacing);
}

}  // namespace
}  // namespace rivulet::program_replay_test
