// A recording drawn in pieces, by --frames A:B and --images, and joined again.
#include <gtest/gtest.h>

#include "tests/unit/program_runner.h"

namespace rivulet::testing::program_pieces_test {
namespace {

// Foam, solids that move: nothing is kept from one frame to the next that a piece would lack. The pieces are tasks of a sweep.
TEST(ProgramPieces, JoinToTheVideoOfASingleRunBitForBit) {
    struct Case {
        const char *scene, *renderer, *more;
    };
    for (const Case& c : {Case{"dam_break", "screen_space", "fluid.foam.most=2000"}, Case{"dam_break", "reference", "fluid.foam.most=0"},
                          Case{"paddle_wheel", "screen_space", "look.quality=fine"}}) {
        const Scratch scratch;
        const std::string scene = std::string(RIVULET_SOURCE_DIR "/assets/scenes/") + c.scene + ".json";
        const std::vector<std::string> set = {"--set", "fluid.spacing=0.05", "--set", c.more};
        const auto run = [&](std::vector<std::string> words) {
            words.insert(words.begin(), {"run", scene});
            words.insert(words.end(), set.begin(), set.end());
            return runProgram(words, in(scratch));
        };
        ASSERT_EQ(run({"--no-render", "--backend", "cpu", "--frames", "9", "--record", "r.rrec", "--stats", "s.json"}).code, 0);
        const Outcome whole = run(
            {"--headless", "--replay", "r.rrec", "--renderer", c.renderer, "--size", "97x64", "--video", "whole.mp4", "--out", "whole"});
        ASSERT_EQ(whole.code, 0) << whole.err;
        scratch.file("pieces.json", std::string(R"({"command": "run )") + scene +
                                        " --replay r.rrec --frames {frames} --images --size 97x64 --out {task} --renderer " + c.renderer +
                                        " --set fluid.spacing=0.05 --set " + c.more +
                                        R"(", "parameters": {"frames": {"from": 0, "to": 9, "pieces": 4}}})");
        const Outcome swept = runProgram({"sweep", "pieces.json"}, in(scratch));
        ASSERT_EQ(swept.code, 0) << swept.err;
        const Outcome joined = runProgram({"join", "pieces", "--video", "joined.mp4"}, in(scratch));
        ASSERT_EQ(joined.code, 0) << joined.err;
        EXPECT_EQ(joined.out, "joined.mp4, frames 0 to 8\n");
        EXPECT_GT(scratch.text("whole.mp4").size(), 1000U);
        EXPECT_TRUE(scratch.text("joined.mp4") == scratch.text("whole.mp4")) << c.scene << ", " << c.renderer;
        // The last piece is missing: a shorter video is not made.
        std::filesystem::rename(scratch.path() / "pieces/tasks/3", scratch.path() / "pieces/tasks/3.part");
        expectRefusal(runProgram({"join", "pieces", "--video", "short.mp4"}, in(scratch)), 2, "task 3 of 4 in pieces has not ended");
        EXPECT_FALSE(std::filesystem::exists(scratch.path() / "short.mp4"));
    }
}

TEST(ProgramPieces, ErrorsNameTheirCause) {
    const Scratch scratch;
    scratch.file("s.json", smallScene());
    ASSERT_EQ(runProgram({"run", "s.json", "--no-render", "--frames", "6", "--record", "s.rrec"}, in(scratch)).code, 0);
    const std::vector<std::string> replay = {"run", "s.json", "--replay", "s.rrec"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), replay.begin(), replay.end());
        return runProgram(more, in(scratch));
    };
    expectRefusal(with({"--frames", "4:9"}), 2, "s.rrec has 6 frames; end at 6 or before");
    expectRefusal(with({"--frames", "4:4"}), 2, "--frames must be a number of frames, or the first frame of a piece");
    expectRefusal(with({"--frames", "2:4", "--still", "0"}), 2, "--still cannot be used with a piece");
    expectRefusal(with({"--images", "--video", "v.mp4"}), 2, "--video cannot be used with --images");
    expectRefusal(with({"--renderer", "referense"}), 2, "did you mean 'reference'?");
    expectRefusal(runProgram({"run", "s.json", "--frames", "2:4"}, in(scratch)), 2, "add --replay FILE.rrec");
    expectRefusal(runProgram({"run", "s.json", "--no-render", "--images"}, in(scratch)), 2, "--images cannot be used with --no-render");

    ASSERT_EQ(with({"--images", "--frames", "0:2", "--out", "a", "--size", "32x32"}).code, 0);
    ASSERT_EQ(with({"--images", "--frames", "3:5", "--out", "b", "--size", "32x32"}).code, 0);
    ASSERT_EQ(with({"--images", "--frames", "2:3", "--out", "c", "--size", "16x16"}).code, 0);
    EXPECT_EQ(scratch.contents(),
              (std::vector<std::string>{"a", "a/small_0000.png", "a/small_0001.png", "b", "b/small_0003.png", "b/small_0004.png", "c",
                                        "c/small_0002.png", "out", "out/stats.json", "s.json", "s.rrec"}));
    expectRefusal(runProgram({"join", "a", "b"}, in(scratch)), 2, "the image of frame 2 is missing");
    expectRefusal(runProgram({"join", "a", "b", "c"}, in(scratch)), 2, "has 16x16 pixels, but the images before it 32x32");
    expectRefusal(runProgram({"join", "a", "a"}, in(scratch)), 2, "are both frame");
    std::filesystem::create_directory(scratch.path() / "d");
    std::filesystem::copy_file(scratch.path() / "c/small_0002.png", scratch.path() / "d/other_0002.png");
    expectRefusal(runProgram({"join", "a", "d", "b"}, in(scratch)), 2, "are images of different scenes");
    expectRefusal(runProgram({"join", "out"}, in(scratch)), 2, "no image of a frame");
    expectRefusal(runProgram({"join", "nowhere"}, in(scratch)), 2, "nowhere is no folder");
    expectRefusal(runProgram({"join"}, in(scratch)), 2, "name a folder of images");
    EXPECT_FALSE(std::filesystem::exists(scratch.path() / "out.mp4"));
}

}  // namespace
}  // namespace rivulet::testing::program_pieces_test
