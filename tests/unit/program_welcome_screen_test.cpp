// The screen that explains the window is shown once, and its last key or click does nothing else.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "fluid/viewer/viewer.h"
#include "tests/unit/program_runner.h"
#include "tests/unit/viewer_fixture.h"

namespace rivulet::program_welcome_screen_test {
namespace {

class WelcomeScreenTest : public testing::ViewerFixture {
  protected:
    void SetUp() override { usual_ = 1.0 / 60; }
    void start() {
        SceneFile scene;
        scene.fluid.spacing = 0.1F;
        scene.look.renderer = "points";
        begin(scene, {900, 700}, {90, 70}, {.backend = "cpu", .seen = seen_});
        frame();
    }
    testing::Scratch scratch_;
    std::string seen_ = (scratch_.path() / "config/rivulet/seen").string();
};

TEST_F(WelcomeScreenTest, AKeyEndsItForGood) {
    start();
    EXPECT_TRUE(viewer_->greets());
    for (int k = 0; k < 3; ++k) frame();
    EXPECT_TRUE(viewer_->greets()) << "nobody has pressed anything";
    EXPECT_EQ(viewer_->steps(), 0U) << "the first scene waits behind it";
    EXPECT_FALSE(std::filesystem::exists(seen_));
    input_.keysPressed = {' '};
    frame();
    EXPECT_FALSE(viewer_->greets());
    EXPECT_FALSE(viewer_->paused()) << "the space did nothing else";
    frame();
    EXPECT_GT(viewer_->steps(), 0U);
    EXPECT_TRUE(std::filesystem::exists(seen_));
    input_.keysPressed = {' '};
    frame();
    EXPECT_TRUE(viewer_->paused());
    start();
    EXPECT_FALSE(viewer_->greets());
}

TEST_F(WelcomeScreenTest, AClickEndsItAndMovesNothing) {
    start();
    const vec3 eye = viewer_->scene().camera.position;
    input_.mouse = vec2(450, 650);
    input_.buttonDown[0] = true;
    input_.buttonPressed[0] = true;
    input_.mouseDelta = vec2(40, 0);
    frame();
    EXPECT_FALSE(viewer_->greets());
    EXPECT_EQ(viewer_->scene().camera.position, eye);
}

TEST_F(WelcomeScreenTest, WhereNothingCanBeKeptItIsNoError) {
    seen_ = scratch_.file("a file", "x") + "/seen";
    start();
    EXPECT_TRUE(viewer_->greets());
    input_.keysPressed = {'A'};
    frame();
    EXPECT_FALSE(viewer_->greets());
    seen_ = "";
    start();
    EXPECT_FALSE(viewer_->greets());
}

TEST(SeenFile, IsInTheSettingsFolder) {
    const char* before = std::getenv("XDG_CONFIG_HOME");
    const std::string kept = before != nullptr ? before : "";
    setenv("XDG_CONFIG_HOME", "/somewhere", 1);
    EXPECT_EQ(seenFile(), "/somewhere/rivulet/seen");
    setenv("XDG_CONFIG_HOME", "not a whole path", 1);
    EXPECT_TRUE(seenFile().ends_with("/.config/rivulet/seen") || seenFile().empty()) << seenFile();
    if (before != nullptr)
        setenv("XDG_CONFIG_HOME", kept.c_str(), 1);
    else
        unsetenv("XDG_CONFIG_HOME");
}

}  // namespace
}  // namespace rivulet::program_welcome_screen_test
