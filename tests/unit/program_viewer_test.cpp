// The window's inside, driven by InputEvents as a person would, drawn into a framebuffer: keys, camera, sliders.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_internal.h>

#include "engine/core/json.h"
#include "engine/ui/param_panel.h"
#include "fluid/viewer/viewer.h"
#include "tests/unit/program_runner.h"
#include "tests/unit/viewer_fixture.h"

namespace rivulet::program_viewer_test {
namespace {

// A person at a window of 900 x 1600: the panels lie in its left part, the scene is to be seen at its right. The picture has few pixels,
// for the sake of machines without a GPU.
class Person : public testing::ViewerFixture {
  protected:
    void SetUp() override {
        input_.mouse = vec2(700, 1200);
        SceneFile scene;
        scene.name = "small";
        scene.fluid.spacing = 0.05F;
        scene.look.renderer = "points";
        scene.fluid.blocks = {{.min = vec3(0.2F), .max = vec3(0.4F)}};
        begin(scene, kWindow, kPixels);
    }

    void drag(MouseButton button, vec2 from, vec2 to) {
        moveTo(from);
        frame();
        press(true, button);
        moveTo(to);
        press(false, button);
        frame();
    }
    // Unfolds a group of the parameters' panel, which knows it by the names on the way.
    static void unfold(std::initializer_list<const char*> path) {
        for (ImGuiWindow* window : ImGui::GetCurrentContext()->Windows) {
            if (std::string_view(window->Name).find("parameters") == std::string_view::npos) continue;
            ImGuiID id = window->ID;
            for (const char* name : path) id = ImHashStr(name, 0, id);
            window->StateStorage.SetInt(ImHashStr(std::data(path)[path.size() - 1], 0, id), 1);
        }
    }
    static void foldAllButColliders() {
        for (ImGuiWindow* window : ImGui::GetCurrentContext()->Windows) {
            if (std::string_view(window->Name).find("parameters") == std::string_view::npos) continue;
            const auto set = [window](const char* group, const char* header, int open) {
                window->StateStorage.SetInt(ImHashStr(header, 0, ImHashStr(group, 0, window->ID)), open);
            };
            for (const char* group : {"fluid", "look", "camera", "light", "background"}) set(group, group, 0);
            set("colliders", "###list", 1);
        }
    }
    static void unfoldAll() {
        for (const char* group : {"fluid", "look", "camera", "light", "background"}) unfold({group});
        unfold({"fluid", "box"});
        unfold({"fluid", "collision"});
    }
    const CameraParams& camera() const { return viewer_->scene().camera; }
    float distance() const { return glm::length(camera().position - camera().target); }

    static constexpr ivec2 kWindow{900, 1600}, kPixels{90, 160};
};

// With fixed steps the world receives every frame and keeps the remainder.
TEST_F(Person, FixedStepsTakeFramesAsTheyCome) {
    SceneFile scene = viewer_->scene();
    scene.fluid.fixedStep = 0.01F;
    viewer_->session().apply(scene);
    FluidWorld& world = viewer_->session().world();
    double asked = 0;
    for (const double seconds : {0.004, 0.0071, 0.0235, 0.003}) {
        frame(seconds);
        asked += seconds;
        EXPECT_NEAR(world.time() + world.pending(), asked, 1e-9);
    }
    EXPECT_NEAR(world.time(), 0.03, 1e-6);
    EXPECT_NE(world.particles().drawn, world.particles().position);
    // A frame after a breakpoint is no more than the longest there may be.
    frame(10);
    EXPECT_NEAR(world.time() + world.pending(), asked + 0.1, 1e-6);
    key(GLFW_KEY_SPACE);
    const double paused = world.time();
    frame(0.05);
    EXPECT_EQ(world.time(), paused);
}

TEST_F(Person, KeysPauseStepAndReset) {
    for (int i = 0; i < 3; ++i) frame(1.0 / 60);
    EXPECT_EQ(viewer_->steps(), 3U);
    key(GLFW_KEY_SPACE);
    EXPECT_TRUE(viewer_->paused());
    for (int i = 0; i < 3; ++i) frame(1.0 / 60);
    EXPECT_EQ(viewer_->steps(), 3U);
    key(GLFW_KEY_PERIOD);
    EXPECT_EQ(viewer_->steps(), 4U);
    EXPECT_NEAR(viewer_->session().world().time(), 4.0 / 60, 1e-9);
    key(GLFW_KEY_R);
    EXPECT_EQ(viewer_->session().world().time(), 0);
    key(GLFW_KEY_SPACE);
    EXPECT_FALSE(viewer_->paused());
    // A frame of a second makes one step, not sixty; one of a hundredth of a sixtieth makes none.
    frame(1);
    EXPECT_EQ(viewer_->steps(), 5U);
    frame(0);
    uint64_t steps = viewer_->steps();
    frame(1e-4);
    EXPECT_EQ(viewer_->steps(), steps);
}

TEST_F(Person, TheMouseMovesTheCamera) {
    key(GLFW_KEY_SPACE);
    CameraParams before = camera();
    float away = distance();
    drag(MouseButton::left, {600, 1200}, {700, 1150});
    EXPECT_NEAR(distance(), away, 1e-3F) << "turning keeps the distance";
    EXPECT_LT(glm::length(camera().target - before.target), 1e-4F);
    EXPECT_GT(glm::length(camera().position - before.position), 0.1F * away);

    before = camera();
    drag(MouseButton::right, {600, 1200}, {650, 1200});
    vec3 moved = camera().target - before.target;
    EXPECT_GT(glm::length(moved), 0.01F * away);
    EXPECT_LT(glm::length((camera().position - before.position) - moved), 1e-3F) << "moving keeps the direction";
    vec3 right = glm::cross(before.target - before.position, vec3(0, 1, 0));
    EXPECT_LT(glm::dot(moved, right), 0) << "the scene follows the mouse";

    input_.wheel.y = 1;
    frame();
    EXPECT_LT(distance(), away);
    input_.wheel.y = -1000;
    frame();
    EXPECT_TRUE(isFinite(camera().position));

    before = camera();
    drag(MouseButton::left, {100, 1500}, {200, 1400});
    EXPECT_EQ(camera().position, before.position) << "a drag over the panel is no camera movement";

    input_.mouseDelta = vec2(650, 1100) - input_.mouse;  // there and pressed within one frame
    input_.mouse = vec2(650, 1100);
    press(true);
    EXPECT_EQ(camera().position, before.position) << "what came before the press is no drag";
    press(false);
}

// A draft that is not yet valid leaves the water unchanged, but not the view.
TEST_F(Person, TheViewTurnsAlsoWhileAnEditIsRefused) {
    key(GLFW_KEY_SPACE);
    withControl('F');
    type("refractiveIndex");
    ASSERT_TRUE(hover("parameters", {"look", "refractiveIndex", "##v", "#0", ""}));
    press(true);
    for (int k = 0; k < 60 && viewer_->message().empty(); ++k) moveTo(input_.mouse + vec2(k % 2 == 0 ? k : -k, 0));
    press(false);
    ASSERT_NE(viewer_->message(), "") << "less than 1, more than 0";
    const CameraParams before = camera();
    drag(MouseButton::left, {600, 1200}, {700, 1150});
    EXPECT_GT(glm::length(camera().position - before.position), 0.1F * distance());
}

TEST_F(Person, SavesAlsoWhileAFieldIsTypedInto) {
    frame();
    withControl('F');
    type("gravity");
    frame();
    ASSERT_TRUE(ImGui::GetIO().WantTextInput);
    withControl('S');
    frame();
    EXPECT_TRUE(shows("save the scene"));
}

TEST(FileName, IsValidForAnySceneName) {
    EXPECT_EQ(fileName("a scene"), "a scene");
    EXPECT_EQ(fileName("a/b"), "a_b");
    EXPECT_EQ(fileName(""), "scene");
    EXPECT_EQ(fileName(".hidden"), "scene.hidden");
}

TEST_F(Person, EscapeClosesTheTopmostWindow) {
    key(GLFW_KEY_H);
    key(GLFW_KEY_O);
    frame();
    EXPECT_TRUE(shows("keys") && shows("scenes"));
    key(key::kEscape);
    frame();
    EXPECT_TRUE(shows("keys") && !shows("scenes"));
    key(key::kEscape);
    frame();
    EXPECT_FALSE(shows("keys"));
    withControl('S');
    EXPECT_TRUE(shows("save the scene"));
    key(key::kEscape);
    frame();
    EXPECT_FALSE(shows("save the scene"));
}

TEST_F(Person, AWindowOfNoSizeIsNoError) {
    input_.size = input_.framebuffer = ivec2(0);
    for (int i = 0; i < 3; ++i) frame(1.0 / 60);
    EXPECT_EQ(viewer_->steps(), 3U);
    input_.size = input_.framebuffer = ivec2(1, 1);
    frame();
    input_.size = kWindow;
    input_.framebuffer = kPixels;
    frame();
}

// On a display of two pixels a window coordinate the picture has every pixel of its own, and the same things in it.
TEST_F(Person, ADisplayOfTwiceThePixelsShowsTheSameInAllOfThem) {
    viewer_.reset();
    SceneFile scene;
    scene.fluid.spacing = 0.05F;
    scene.fluid.blocks = {{.min = vec3(0.2F), .max = vec3(0.6F)}};
    scene.look.quality = "fine";
    auto viewer = Viewer::create(scene, {.backend = "cpu"}, {});
    ASSERT_TRUE(viewer) << viewer.error().message;
    viewer_ = std::move(*viewer);
    key(GLFW_KEY_SPACE);
    key(GLFW_KEY_TAB);
    auto shot = [this] {
        for (int k = 0; k < 3; ++k) frame();
        std::vector<uint8_t> texels(picture_.hostBytes());
        picture_.read(std::as_writable_bytes(std::span(texels)));
        return texels;
    };
    input_.size = input_.framebuffer = kPixels;
    const std::vector<uint8_t> plain = shot();
    input_.size = kPixels / 2;
    EXPECT_EQ(shot(), plain);
    input_.framebuffer = kPixels / 2;  // the window goes to a display of one pixel a coordinate, and back
    EXPECT_NE(shot(), plain);
    input_.framebuffer = kPixels;
    EXPECT_EQ(shot(), plain);
}

// Every row of the panel is pressed and dragged: no crash, what changed is a scene that could be read from a file, and where a value is
// one that needs a new world there is one.
// On a screen of twice as many dots an inch, or where the person wants them larger, panels are twice as large, and so is what is clicked.
TEST_F(Person, PanelsGrowWithTheScreenAndAsWanted) {
    frame();
    frame();
    const auto panel = [] {
        for (ImGuiWindow* each : ImGui::GetCurrentContext()->Windows)
            if (std::string_view(each->Name).find("###scene") != std::string_view::npos && each->ParentWindow == nullptr)
                return each->Rect();
        return ImRect();
    };
    const ImRect before = panel();
    ASSERT_TRUE(hover("###scene", {"step"}));
    const vec2 button = input_.mouse;
    const uint64_t steps = viewer_->steps();
    input_.size = 2 * kWindow;
    input_.scale = 2;
    frame();
    frame();
    EXPECT_EQ(panel().Min.x, before.Min.x);
    EXPECT_EQ(panel().Max.y, before.Max.y);
    moveTo(2.0F * button);
    frame();
    click();
    EXPECT_EQ(viewer_->steps(), steps + 1);
    input_.size = kWindow;
    input_.scale = 1;
    input_.keysDown = {key::kLeftControl};
    for (int k = 0; k < 3; ++k) key('=');  // 1.25 each
    input_.keysDown.clear();
    frame();
    frame();
    const float smaller = static_cast<float>(kWindow.x) / std::pow(1.25F, 3.0F);
    EXPECT_NEAR(ImGui::GetIO().DisplaySize.x, smaller, 1.0F);
    EXPECT_LE(panel().Max.x, 0.5F * smaller) << "the picture is still to be seen";
    EXPECT_LE(panel().Max.y, ImGui::GetIO().DisplaySize.y) << "the panel follows the window";
    ASSERT_TRUE(hover("###scene", {"step"}));
    click();
    EXPECT_EQ(viewer_->steps(), steps + 2);
}

TEST_F(Person, EverySliderMayBeDragged) {
    key(GLFW_KEY_SPACE);
    input_.framebuffer = ivec2(0);  // the panel alone
    frame();
    auto textOf = [this] {
        SceneFile scene = viewer_->scene();
        return writeJson([&scene](ParamVisitor& v) { scene.visit(v); });
    };
    uint32_t particles = viewer_->session().world().particles().count;
    bool recreated = false;
    size_t edits = 0;
    float top = 0;  // of the parameters: a click in the tree above them would leave only those of one thing
    for (ImGuiWindow* each : ImGui::GetCurrentContext()->Windows)
        if (std::string_view(each->Name).find("parameters") != std::string_view::npos) top = each->InnerRect.Min.y;
    ASSERT_GT(top, 100);
    for (int k = 0; top + 12.0F * static_cast<float>(k / 3) < 1580; ++k) {
        // A slider is a third, a half and two thirds along: the finest spacings need an answer first, as they cost much.
        const float y = top + 12.0F * static_cast<float>(k / 3), x = 170.0F + 20.0F * static_cast<float>(k % 3);
        unfoldAll();  // a press on a header has folded it
        frame();
        std::string before = textOf();
        drag(MouseButton::left, {x + 10, y}, {x, y + 2});
        key(GLFW_KEY_ESCAPE);
        recreated = recreated || viewer_->session().world().particles().count != particles;
        edits += textOf() == before ? 0 : 1;
        SceneFile again;
        Status read = readJson(textOf(), "edited", [&again](ParamVisitor& v) { again.visit(v); });
        ASSERT_TRUE(read) << read.error().message;
        Status sense = checkScene(viewer_->scene());
        ASSERT_TRUE(sense) << sense.error().message;
    }
    EXPECT_GT(edits, 25U);
    EXPECT_TRUE(recreated) << "the spacing's slider makes a new world when it is let go of";
    key(GLFW_KEY_PERIOD);
    EXPECT_TRUE(std::isfinite(viewer_->session().world().stats().kinetic));
}

TEST_F(Person, ParametersAreFoundByWordsAndReset) {
    key(GLFW_KEY_SPACE);
    input_.framebuffer = ivec2(0);  // the panel alone
    frame();
    frame();
    const float was = viewer_->scene().fluid.viscosity;
    static constexpr std::initializer_list<const char*> kSlider = {"fluid", "viscosity", "##v", "#0", ""};
    EXPECT_FALSE(hover("parameters", kSlider)) << "it is folded away";
    withControl('F');
    type("Kinematic VISC");
    ASSERT_TRUE(hover("parameters", kSlider)) << "found by two words of its doc";
    EXPECT_FALSE(hover("parameters", {"fluid", "spacing", "##v", "#0", ""})) << "it has nothing to do with that";
    const auto slide = [&] {
        ASSERT_TRUE(hover("parameters", kSlider));
        press(true);
        moveTo(input_.mouse + vec2(40, 0));
        press(false);
        EXPECT_NE(viewer_->scene().fluid.viscosity, was);
    };
    slide();
    ASSERT_TRUE(hover("###scene", {"reset all"}));
    click();
    EXPECT_EQ(viewer_->scene().fluid.viscosity, was);
    EXPECT_FALSE(hover("###scene", {"reset all"})) << "nothing is changed any more";
    slide();
    ASSERT_TRUE(hover("parameters", kSlider));
    moveTo({40, input_.mouse.y});  // over its name
    click(MouseButton::right);
    ASSERT_TRUE(hover("##Popup", {"as opened"}));
    click();
    EXPECT_EQ(viewer_->scene().fluid.viscosity, was);
    ASSERT_TRUE(hover("###scene", {"clear"}));
    click();
    EXPECT_TRUE(hover("parameters", {"fluid", "fluid"})) << "all groups are there again";
}

// Changes are listed by path, for any content of a text.
TEST(ParamMemory, ListsChangedValues) {
    SceneFile scene;
    scene.name = "small";
    const auto visit = [&scene](ParamVisitor& v) { scene.visit(v); };
    SceneFile none;
    ParamMemory memory;
    memory.open(visit, [&none](ParamVisitor& v) { none.visit(v); });
    memory.compare(visit);
    EXPECT_TRUE(memory.changed().empty());
    scene.fluid.viscosity *= 3;
    scene.name = "a \"quoted\" name\nof two lines";
    memory.compare(visit);
    ASSERT_EQ(memory.changed().size(), 2U);
    EXPECT_EQ(memory.changed().at("name"), "\"small\"");
    ASSERT_NE(memory.byDefault("colliders[3].motion.keys[12].time"), nullptr);
    EXPECT_EQ(*memory.byDefault("colliders[3].motion.keys[12].time"), "0");
    EXPECT_EQ(memory.byDefault("colliders[3].motion.keys[12].tim"), nullptr);
}

// An edit that asks for more memory than voxels may take is refused, and all stays as it was: the session, its water, the values.
TEST_F(Person, ASceneTooLargeForMemoryLeavesTheOldSession) {
    const testing::Scratch scratch;
    scratch.file("box.obj",
                 "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\n"
                 "f 3 4 8 7\nf 2 3 7 6\nf 4 1 5 8\n");
    SceneFile scene = viewer_->scene();
    scene.folder = scratch.path().string();
    scene.colliders.resize(1);
    scene.colliders[0].shape = "mesh";
    scene.colliders[0].mesh = "box.obj";
    scene.colliders[0].position = vec3(0.7F, 0.1F, 0.7F);
    scene.colliders[0].fitSize = 0.2F;
    scene.colliders[0].resolution = 16;
    viewer_.reset();
    auto viewer = Viewer::create(scene, {.backend = "cpu"}, {});
    ASSERT_TRUE(viewer) << viewer.error().message;
    viewer_ = std::move(*viewer);
    for (int i = 0; i < 5; ++i) frame(1.0 / 60);
    key(GLFW_KEY_SPACE);
    input_.framebuffer = ivec2(0);  // the panels alone
    frame();
    const auto textOf = [this] {
        SceneFile now = viewer_->scene();
        return writeJson([&now](ParamVisitor& v) { now.visit(v); });
    };
    // The row of the resolution is dragged far to the right, and let go of; which row that is, the refusal tells.
    bool refused = false;
    for (float y = 200; y < 900 && !refused; y += 10) {
        foldAllButColliders();
        frame();
        const Session* const session = &viewer_->session();
        const double time = viewer_->session().world().time(), kinetic = viewer_->session().world().stats().kinetic;
        const std::vector<uint8_t> bits = session->field().surface.bits;
        const std::string text = textOf();
        drag(MouseButton::left, {210, y}, {880, y});
        key(GLFW_KEY_ESCAPE);
        const std::string& message = viewer_->message();
        if (message.find("GB") == std::string::npos) continue;
        refused = true;
        EXPECT_NE(message.find("resolution"), std::string::npos) << message;
        EXPECT_EQ(&viewer_->session(), session);
        EXPECT_GT(time, 0) << "the water has moved";
        EXPECT_EQ(viewer_->session().world().time(), time);
        EXPECT_EQ(viewer_->session().world().stats().kinetic, kinetic);
        EXPECT_FALSE(bits.empty());
        EXPECT_EQ(viewer_->session().field().surface.bits, bits);
        EXPECT_EQ(textOf(), text);
        key(GLFW_KEY_PERIOD);
        EXPECT_GT(viewer_->session().world().time(), time) << "and moves on";
    }
    EXPECT_TRUE(refused) << viewer_->message();
}

// A pixel of the panel's background is dark, whatever the scene behind: the panels are drawn, over the picture.
TEST_F(Person, ThePanelsLieOverThePicture) {
    key(GLFW_KEY_SPACE);
    auto brightness = [this](int x, int fromTop) {
        std::vector<uint8_t> texels(picture_.hostBytes());
        picture_.read(std::as_writable_bytes(std::span(texels)));
        size_t at =
            4 * (static_cast<size_t>(picture_.height() - 1 - fromTop) * static_cast<size_t>(picture_.width()) + static_cast<size_t>(x));
        return texels[at] + texels[at + 1] + texels[at + 2];
    };
    frame();
    EXPECT_LT(brightness(2, 157), 180);
    int bright = brightness(45, 3);
    key(GLFW_KEY_TAB);
    frame();
    EXPECT_GT(brightness(2, 157), 200) << "Tab hides them";
    EXPECT_NEAR(brightness(45, 3), bright, 12);
}

TEST(ParamPanelNames, AreReadable) {
    EXPECT_EQ(readableName("artificialViscosity"), "artificial viscosity");
    EXPECT_EQ(readableName("cfl"), "cfl");
}

// What auto tried is no part of the run; the last frames, whose times come late, are.
TEST_F(Person, ATraceIsOfTheRunFromItsFirstFrameToItsLast) {
    const SceneFile scene = viewer_->scene();
    viewer_.reset();
    auto viewer = Viewer::create(scene, {.backend = "cpu", .cooperate = "auto", .width = 64, .height = 64}, {});
    ASSERT_TRUE(viewer) << viewer.error().message;
    viewer_ = std::move(*viewer);
    const double begun = hostSeconds();
    constexpr size_t kFrames = 5;
    for (size_t k = 0; k < kFrames; ++k) frame(1.0 / 60);
    ASSERT_TRUE(viewer_->settle());
    size_t drawn = 0;
    for (const Timeline::Lane& lane : viewer_->wholeTimeline().lanes())
        for (const PassSpan& span : lane.spans) {
            constexpr double kClock = 0.002;  // s, of the GPU's clock
            EXPECT_GT(span.begin, begun - kClock) << lane.name << " " << span.name;
            drawn += lane.name == kDrawingLane && span.name == "tonemap" ? 1 : 0;
        }
    EXPECT_EQ(drawn, kFrames);
}

}  // namespace
}  // namespace rivulet::program_viewer_test
