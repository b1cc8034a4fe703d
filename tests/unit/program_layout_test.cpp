// The window's layout: its panels leave the picture free, nothing moves by itself, slow changes are asked for, a run is recorded and
// looked through.
#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <filesystem>
#include <set>

#include "engine/core/param_list.h"
#include "engine/ui/param_panel.h"
#include "fluid/viewer/viewer.h"
#include "tests/unit/program_runner.h"
#include "tests/unit/viewer_fixture.h"

namespace rivulet::program_layout_test {
namespace {

class Layout : public testing::ViewerFixture {
  protected:
    static SceneFile small() {
        SceneFile scene;
        scene.name = "small";
        scene.fluid.spacing = 0.05F;
        scene.look.renderer = "points";
        scene.fluid.blocks = {{.min = vec3(0.2F), .max = vec3(0.4F)}};
        return scene;
    }
    void SetUp() override {
        input_.mouse = vec2(700, 400);
        begin(small(), {1280, 720}, {64, 36});
        for (int k = 0; k < 3; ++k) frame();
    }
    static const ImGuiWindow* windowWith(std::string_view part) {
        for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows)
            if (window->WasActive && std::string_view(window->Name).find(part) != std::string_view::npos) return window;
        return nullptr;
    }
    // Share of the window that lies under panels.
    static float covered() {
        const ImVec2 display = ImGui::GetIO().DisplaySize;
        float sum = 0;
        for (const ImGuiWindow* window : ImGui::GetCurrentContext()->Windows)
            if (window->WasActive && window->ParentWindow == nullptr && !window->Hidden && !(window->Flags & ImGuiWindowFlags_Tooltip) &&
                std::string_view(window->Name) != "Debug##Default")
                sum += window->Size.x * window->Size.y;
        return sum / (display.x * display.y);
    }
    // Where the objects and the parameters begin, px from the top.
    static vec2 places() { return {windowWith("/tree_")->Pos.y, windowWith("/parameters_")->Pos.y}; }
    void drop(const std::string& path) {
        input_.dropped = {path};
        frame();
        input_.dropped.clear();
        for (int k = 0; k < 3; ++k) frame();
    }
};

TEST_F(Layout, PanelsCoverLessThanAThird) {
    EXPECT_LT(covered(), 1.0F / 3);
    EXPECT_GT(covered(), 0.1F);
    EXPECT_EQ(viewer_->watch().shown(), Inspector::Tab::none) << "measurements are closed at first";
    key('M');
    frame();
    EXPECT_NE(viewer_->watch().shown(), Inspector::Tab::none);
    key('M');
    frame();
    EXPECT_EQ(viewer_->watch().shown(), Inspector::Tab::none);
}

// Messages, figures, what is searched for and what is changed have room of their own.
TEST_F(Layout, NothingMovesWhenMessagesAndFiguresChange) {
    const vec2 before = places();
    ASSERT_GT(before.y, before.x);
    drop("a_file_that_is_not_there_and_has_a_long_name_so_that_the_sentence_takes_several_lines.json");
    EXPECT_FALSE(viewer_->message().empty());
    EXPECT_EQ(places(), before) << "a message came";
    for (int k = 0; k < 5; ++k) frame(1.0 / 60);
    EXPECT_EQ(places(), before) << "figures came";
    withControl('F');
    type("no such parameter");
    frame();
    EXPECT_EQ(places(), before) << "nothing was found";
    for (int k = 0; k < 20; ++k) hit(key::kBackspace);
    type("gravity");
    ASSERT_TRUE(hover("parameters", {"fluid", "gravity", "##v", "#1", ""}));
    press(true);
    moveTo(input_.mouse + vec2(30, 0));
    press(false);
    frame();
    EXPECT_NE(viewer_->scene().fluid.gravity, small().fluid.gravity);
    EXPECT_EQ(places(), before) << "a value changed";
    SceneFile other = small();
    other.fluid.method = "wcsph";
    viewer_->open(other);
    settle();
    for (int k = 0; k < 3; ++k) frame(1.0 / 60);
    EXPECT_EQ(places(), before) << "another scene, with another method's figures";
}

// Water is 1e-6 m^2/s: the first pixels of a drag lead to liquids a little thicker, not to a hundred times that.
TEST_F(Layout, ASliderOfDecadesBeginsWhereItsValueIs) {
    withControl('F');
    type("fluid.viscosity");
    ASSERT_TRUE(hover("parameters", {"fluid", "viscosity", "##v", "#0", ""}));
    const float was = viewer_->scene().fluid.viscosity;
    const ImGuiWindow* panel = windowWith("/parameters_");
    const float left = panel->Pos.x + 0.42F * panel->Size.x;
    std::set<int> decades;
    moveTo({left + 4, input_.mouse.y});
    press(true);
    for (float x = left; x < left + 60; x += 2) {
        moveTo({x, input_.mouse.y});
        const float now = viewer_->scene().fluid.viscosity;
        if (now > 0) decades.insert(static_cast<int>(std::floor(std::log10(now))));
    }
    press(false);
    EXPECT_NE(viewer_->scene().fluid.viscosity, was);
    EXPECT_TRUE(decades.contains(-6) && decades.contains(-5)) << "between water and ten times that";
}

TEST(ParamPanelSliders, WideRangesAreLogarithmic) {
    EXPECT_TRUE(slidesByDecades({"tolerance", "", "", 1e-6, 0.1}));
    EXPECT_TRUE(slidesByDecades({"viscosity", "m^2/s", "", 0, 10, kLog}));
    EXPECT_FALSE(slidesByDecades({"angle", "deg", "", 1, 175}));
    EXPECT_FALSE(slidesByDecades({"speed", "m/s", "", 0, 100})) << "it may be 0";
    EXPECT_FALSE(slidesByDecades({"scale", "", "", 1e-6, 1e6})) << "twelve decades are too coarse for a slider";
    EXPECT_FALSE(slidesByDecades({"open", "", "", -1e30, 1e30}));
}

// Parameters with a fixed set of names are lists, not text fields.
TEST(ParamChoices, ALiquidIsOneOfAList) {
    SceneFile scene;
    const std::vector<ParamEntry> entries = listParams([&scene](ParamVisitor& v) { scene.visit(v); });
    int liquids = 0;
    for (const ParamEntry& entry : entries)
        if (entry.path.ends_with(".liquid") && entry.kind == ParamEntry::Kind::value) {
            ++liquids;
            EXPECT_NE(entry.range.find("honey"), std::string::npos) << entry.path;
            EXPECT_NE(entry.range.find("or empty"), std::string::npos) << entry.path;
        }
    EXPECT_EQ(liquids, 4);
    EXPECT_FALSE(setParam("fluid.liquid=treacle", [&scene](ParamVisitor& v) { scene.visit(v); }));
    EXPECT_TRUE(setParam("fluid.liquid=honey", [&scene](ParamVisitor& v) { scene.visit(v); }));
    EXPECT_TRUE(setParam("fluid.liquid=", [&scene](ParamVisitor& v) { scene.visit(v); }));
}

class SlowChange : public Layout {
  protected:
    void SetUp() override {
        input_.mouse = vec2(700, 400);
        begin(small(), {1280, 720}, {64, 36}, {.backend = "cpu", .askStep = 1.0e-5});
        for (int k = 0; k < 5; ++k) frame(1.0 / 60);
        withControl('F');
        type("fluid.spacing");
        ASSERT_TRUE(hover("parameters", {"fluid", "spacing", "##v", "#0", ""}));
        input_.keysDown = {key::kLeftControl};  // typed
        click();
        input_.keysDown.clear();
        type("0.03");
        hit(key::kEnter);
        settle();
        frame();
        ASSERT_TRUE(shows("cost"));
        ASSERT_EQ(viewer_->session().world().params().spacing, 0.05F) << "not before the answer";
        const uint64_t steps = viewer_->steps();
        frame(1.0 / 60);
        frame(1.0 / 60);
        EXPECT_GT(viewer_->steps(), steps) << "the window goes on meanwhile";
    }
};

TEST_F(SlowChange, IsMadeIfAPersonSaysSo) {
    ASSERT_TRUE(hover("cost", {"change anyway"}));
    click();
    frame();
    EXPECT_FALSE(shows("cost"));
    EXPECT_EQ(viewer_->session().world().params().spacing, 0.03F);
}

TEST_F(SlowChange, IsNotMadeOtherwise) {
    ASSERT_TRUE(hover("cost", {"keep the present value"}));
    click();
    frame();
    EXPECT_FALSE(shows("cost"));
    EXPECT_EQ(viewer_->session().world().params().spacing, 0.05F);
    key('.');
    EXPECT_EQ(viewer_->session().world().params().spacing, 0.05F);
}

// A run is recorded, looked through, and goes on where it was.
TEST_F(Layout, ARecordedRunIsLookedThrough) {
    namespace fs = std::filesystem;
    const testing::Scratch scratch;
    const fs::path before = fs::current_path();
    fs::current_path(scratch.path());
    EXPECT_FALSE(shows("timeline"));
    input_.keysPressed = {key::kF1 + 7};
    frame(0);
    for (int k = 0; k < 8; ++k) frame(1.0 / 60);
    EXPECT_TRUE(shows("timeline"));
    input_.keysPressed = {key::kF1 + 7};
    frame(0);
    key(' ');
    const double end = viewer_->session().world().time();
    EXPECT_TRUE(fs::exists("small_0001.rrec"));
    ASSERT_TRUE(hover("timeline", {"##frame"}));
    const ImGuiWindow* timeline = windowWith("timeline");
    moveTo({timeline->Pos.x + 0.5F * timeline->Size.x, input_.mouse.y});
    press(true);
    frame();
    press(false);
    frame();
    ASSERT_NE(viewer_->session().replaying(), nullptr) << viewer_->message();
    EXPECT_GT(viewer_->session().replaying()->at(), 0U);
    EXPECT_LT(viewer_->session().time(), end) << "an earlier frame is shown";
    EXPECT_TRUE(viewer_->paused());
    ASSERT_TRUE(hover("timeline", {"simulate"}));
    click();
    frame();
    EXPECT_EQ(viewer_->session().replaying(), nullptr);
    EXPECT_EQ(viewer_->session().time(), end);
    key('.');
    EXPECT_GT(viewer_->session().time(), end) << "and the water moves on";
    fs::current_path(before);
}

}  // namespace
}  // namespace rivulet::program_layout_test
