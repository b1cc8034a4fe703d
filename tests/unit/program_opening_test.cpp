// Scenes opened while another is shown: the window stays responsive, and a failed or cancelled opening changes nothing.
#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "engine/core/file.h"
#include "engine/core/json.h"
#include "engine/scene/load_image.h"
#include "fluid/viewer/viewer.h"
#include "tests/unit/program_runner.h"
#include "tests/unit/viewer_fixture.h"

namespace rivulet::program_opening_test {
namespace {

class Opening : public testing::ViewerFixture, public ::testing::WithParamInterface<const char*> {
  protected:
    void SetUp() override {
        input_.mouse = vec2(700, 100);
        usual_ = 1.0 / 60;
        begin(small(), {900, 700}, {90, 70}, {.backend = GetParam(), .share = [this] { return context_->shared(); }});
        ASSERT_TRUE(viewer_);
        ASSERT_STREQ(backendName(viewer_->session().world().device().backend()), GetParam());
    }
    static SceneFile small() {
        SceneFile scene;
        scene.name = "small";
        scene.fluid.spacing = 0.05F;
        scene.fluid.blocks = {{.min = vec3(0.2F), .max = vec3(0.5F)}};
        return scene;
    }
    // Seconds of work for one thread: a fine mesh.
    static SceneFile large() {
        SceneFile scene = small();
        scene.name = "large";
        scene.colliders.resize(2);
        for (ColliderParams& collider : scene.colliders) {
            collider.mesh = "meshes/spot.obj";
            collider.fitSize = 0.6F;
            collider.position = vec3(0.5F);
            collider.resolution = 190;
        }
        scene.colliders[1].motion.spin = 20;
        return scene;
    }
    // Whether anything but one colour is to be seen.
    bool seesSomething() {
        std::vector<uint8_t> pixels(4 * 90 * 70);
        glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.name());
        glReadPixels(0, 0, 90, 70, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
        glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
        return std::any_of(pixels.begin(), pixels.end(), [&](uint8_t v) { return v != pixels[0] && v != 255; });
    }
};

// The first scene, too, is opened behind a picture; a window that is closed meanwhile, or "cancel", ends it.
TEST_P(Opening, TheFirstIsOpenedBehindAPicture) {
    int shown = 0;
    const auto open = [&](const SceneFile& scene, int most) {
        shown = 0;
        return Viewer::create(scene,
                              {.backend = GetParam(),
                               .share = [this] { return context_->shared(); },
                               .showing =
                                   [&, most](const ViewerOptions::Draw& draw) {
                                       draw(input_, target_.name());
                                       EXPECT_TRUE(seesSomething()) << "what is done, and how far it is";
                                       return ++shown < most;
                                   }},
                              {});
    };
    SceneFile scene = large();
    scene.colliders[0].resolution = 191;  // in no cache yet
    auto closed = open(scene, 1);
    ASSERT_FALSE(closed);
    EXPECT_NE(closed.error().message.find("cancelled"), std::string::npos) << closed.error().message;
    auto opened = open(scene, 100000);
    ASSERT_TRUE(opened) << opened.error().message;
    EXPECT_GT(shown, 0);
    viewer_ = std::move(*opened);
    for (int k = 0; k < 3; ++k) frame();
    EXPECT_EQ(viewer_->scene().name, "large");
    EXPECT_TRUE(seesSomething());
    viewer_->open(small());  // by the same second context
    settle();
    EXPECT_EQ(viewer_->scene().name, "small");
    scene.colliders[1].mesh = "nowhere.obj";
    const auto wrong = open(scene, 100000);
    ASSERT_FALSE(wrong);
    EXPECT_NE(wrong.error().message.find("nowhere.obj"), std::string::npos);
}

TEST_P(Opening, ThePreviousSceneRunsUntilTheNextIsReady) {
    frame();
    const double then = viewer_->session().time();
    viewer_->open(large());
    ASSERT_NE(viewer_->opening(), nullptr) << "it takes longer than a glance";
    EXPECT_EQ(viewer_->scene().name, "small");
    EXPECT_GT(settle(), 3);
    EXPECT_EQ(viewer_->scene().name, "large");
    EXPECT_STREQ(backendName(viewer_->session().world().device().backend()), GetParam());
    EXPECT_EQ(viewer_->message(), "");
    EXPECT_GT(then, 0);
    const double begins = viewer_->session().time();
    EXPECT_LT(begins, 0.2) << "it begins at its own start";
    for (int k = 0; k < 10; ++k) frame();
    EXPECT_GT(viewer_->session().time(), begins);
    EXPECT_EQ(viewer_->session().world().stats().nan, 0U);
    EXPECT_TRUE(seesSomething());
}

TEST_P(Opening, AMistakeIsASentenceAndAllStays) {
    SceneFile wrong = large();
    wrong.colliders[1].mesh = "meshes/spt.obj";
    viewer_->open(wrong);
    settle();
    EXPECT_EQ(viewer_->scene().name, "small");
    EXPECT_NE(viewer_->message().find("spt.obj"), std::string::npos) << viewer_->message();
    frame();
    viewer_->open(small());
    settle();
    EXPECT_EQ(viewer_->message(), "");
}

TEST_P(Opening, OfSeveralOpenedScenesTheLastIsShown) {
    viewer_->open(large());
    frame();
    SceneFile last = small();
    last.name = "last";
    viewer_->open(last);
    settle();
    EXPECT_EQ(viewer_->scene().name, "last");
    for (int k = 0; k < 5; ++k) frame();
    EXPECT_EQ(viewer_->scene().name, "last") << "what was given up does not come back";
    viewer_->open(large());
    frame();  // and is left while it is being opened
}

// The sky is made when a scene is opened: another one is seen then.
TEST_P(Opening, AnotherSkyIsSeen) {
    const auto brightness = [this] {
        std::vector<uint8_t> pixels(4 * 90 * 70);
        glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.name());
        glReadPixels(0, 0, 90, 70, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
        glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
        size_t sum = 0;
        for (size_t k = 0; k < 4U * 90 * 20; ++k) sum += pixels[pixels.size() - 1 - k];
        return sum;
    };
    frame();
    const size_t studio = brightness();
    SceneFile outdoors = small();
    outdoors.background.sky = "clouds";
    outdoors.background.zenith = vec3(0, 0, 5);
    viewer_->open(outdoors);
    settle();
    frame();
    EXPECT_NE(brightness(), studio);
}

// What is dropped onto the window.
TEST_P(Opening, ADroppedMeshBecomesAColliderAndADroppedSceneIsOpened) {
    const std::string assets = std::string(RIVULET_SOURCE_DIR) + "/assets/";
    const auto drop = [&](const std::string& path) {
        input_.dropped = {path};
        frame();
        input_.dropped.clear();
        settle();
    };
    drop(assets + "meshes/spot.obj");
    ASSERT_EQ(viewer_->scene().colliders.size(), 1U) << viewer_->message();
    EXPECT_FALSE(viewer_->session().field().empty());
    const Bounds stands = viewer_->session().solids().bounds();
    const BoxParams& box = viewer_->scene().fluid.box;
    EXPECT_TRUE(glm::all(glm::greaterThanEqual(stands.min, box.min - 1e-4F)) && glm::all(glm::lessThanEqual(stands.max, box.max + 1e-4F)));
    drop(assets + "SOURCES.md");
    EXPECT_EQ(viewer_->scene().colliders.size(), 1U);
    EXPECT_NE(viewer_->message().find("SOURCES.md"), std::string::npos) << viewer_->message();
    drop(assets + "scenes/falling_cube.json");
    EXPECT_EQ(viewer_->scene().name, "falling_cube") << viewer_->message();
    drop(assets + "scenes/no_such_scene.json");
    EXPECT_EQ(viewer_->scene().name, "falling_cube");
    EXPECT_NE(viewer_->message().find("no_such_scene"), std::string::npos) << viewer_->message();
}

// A scene comes alone, and the one before, if it was edited, comes back by control Z.
TEST_P(Opening, NothingThatWasMadeIsLost) {
    const std::string assets = std::string(RIVULET_SOURCE_DIR) + "/assets/";
    const auto drop = [&](const std::vector<std::string>& paths) {
        input_.dropped = paths;
        frame();
        input_.dropped.clear();
        settle();
    };
    drop({assets + "meshes/sphere.obj", assets + "scenes/falling_cube.json"});
    EXPECT_EQ(viewer_->scene().name, "small");
    EXPECT_NE(viewer_->message().find("falling_cube.json"), std::string::npos) << viewer_->message();
    drop({assets + "meshes/sphere.obj"});
    EXPECT_EQ(viewer_->scene().colliders.size(), 1U) << "what was refused left nothing behind";
    int recorded = 0;
    viewer_->onStepped([&](const Session&) {
        ++recorded;
        return ok();
    });
    frame();
    EXPECT_EQ(recorded, 1);
    drop({assets + "scenes/falling_cube.json"});
    ASSERT_EQ(viewer_->scene().name, "falling_cube") << viewer_->message();
    const int then = recorded;
    frame();
    EXPECT_EQ(recorded, then) << "a recording is of one scene";
    withControl('Z');
    settle();
    EXPECT_EQ(viewer_->scene().name, "small");
    EXPECT_EQ(viewer_->scene().colliders.size(), 1U);
}

TEST_P(Opening, APresetThatNeedsNewWaterGetsIt) {
    SceneFile scene = small();
    scene.presets = {{.name = "coarse", .doc = "fewer", .set = "fluid.spacing=0.1; fluid.viscosity=0.25"}};
    viewer_->open(scene);
    settle();
    frame();
    frame();
    const uint32_t before = viewer_->session().world().stats().particles;
    ASSERT_GT(before, 100U);
    ASSERT_TRUE(hover("###scene", {"###preset0"}));
    click();
    settle();
    EXPECT_EQ(viewer_->scene().fluid.spacing, 0.1F);
    EXPECT_EQ(viewer_->scene().fluid.viscosity, 0.25F);
    for (int k = 0; k < 6; ++k) frame();
    EXPECT_LT(viewer_->session().world().stats().particles, before / 4);
}

// An edit that would make the window stand still is refused.
TEST_P(Opening, AnEditThatWouldTakeForEverIsRefused) {
    begin(small(), {900, 700}, {90, 70}, {.backend = GetParam(), .longestStep = 1.0e-4, .share = [this] { return context_->shared(); }});
    for (int k = 0; k < 5; ++k) frame();
    withControl('F');
    type("fluid.spacing");
    frame();
    ASSERT_TRUE(hover("parameters", {"fluid", "spacing", "##v", "#0", ""}));
    input_.keysDown = {key::kLeftControl};  // typed rather than dragged
    click();
    input_.keysDown.clear();
    type("0.02");
    hit(key::kEnter);
    for (int k = 0; k < 3; ++k) {
        settle();
        frame();
    }
    EXPECT_EQ(viewer_->scene().fluid.spacing, 0.05F);
    EXPECT_NE(viewer_->message().find("would freeze the window"), std::string::npos) << viewer_->message();
}

TEST_P(Opening, ASceneIsChosenAmongTheirPictures) {
    key('O');
    frame();
    type("falling_cube");
    frame();
    clickAt(vec2(180, 160));  // the first card
    settle();
    EXPECT_EQ(viewer_->scene().name, "falling_cube") << viewer_->message();
}

// A wrong path is said in the browser, which stays.
TEST_P(Opening, AWrongPathLeavesTheBrowser) {
    key('O');
    frame();
    const ImRect inside = ImGui::FindWindowByName("scenes")->InnerRect;
    clickAt(vec2(inside.Min.x + 40, inside.Max.y - 18));
    type("nowhere.json");
    hit(key::kEnter);
    EXPECT_TRUE(shows("scenes"));
    EXPECT_EQ(viewer_->scene().name, "small");
    for (int k = 0; k < 3; ++k) frame();
    for (int k = 0; k < 20; ++k) hit(key::kBackspace);
    type("falling_cube");
    hit(key::kEnter);
    settle();
    frame();
    EXPECT_EQ(viewer_->scene().name, "falling_cube") << viewer_->message();
    EXPECT_FALSE(shows("scenes"));
}

TEST_P(Opening, AVideoHasAPictureAStep) {
    namespace fs = std::filesystem;
    const fs::path before = fs::current_path(), folder = fs::temp_directory_path() / ("rivulet_video_" + std::string(GetParam()));
    fs::remove_all(folder);
    fs::create_directories(folder);
    fs::current_path(folder);
    const auto film = [this] {
        input_.keysPressed = {key::kF1 + 8};
        frame(0);
    };
    frame();
    film();
    const uint64_t from = viewer_->steps();
    for (int k = 0; k < 12; ++k) frame(1.0 / 60);
    for (int k = 0; k < 3; ++k) frame(0);  // pictures of no step are not in it
    const uint64_t steps = viewer_->steps() - from;
    film();
    film();
    for (int k = 0; k < 6; ++k) frame(1.0 / 60);
    const uint64_t more = viewer_->steps() - from - steps;
    viewer_.reset();  // the window is closed while it films
    fs::current_path(before);
    const auto count = [&](const char* file) {
        const auto counted = testing::runCommand({"ffprobe", "-v", "error", "-count_frames", "-select_streams", "v", "-show_entries",
                                                  "stream=nb_read_frames", "-of", "csv=p=0", (folder / file).string()});
        return std::atoi(counted.out.c_str());
    };
    EXPECT_GE(steps, 10U);
    EXPECT_EQ(count("small_0001.mp4"), static_cast<int>(steps));
    EXPECT_GE(more, 5U);
    EXPECT_EQ(count("small_0002.mp4"), static_cast<int>(more));
    fs::remove_all(folder);
}

// What is saved is the scene that is shown; a mesh that lay beside the old file is still found, and no file is written over unasked.
TEST_P(Opening, TheSceneIsSavedAndReadsBackTheSame) {
    namespace fs = std::filesystem;
    const fs::path folder = fs::temp_directory_path() / ("rivulet_saved_" + std::string(GetParam()));
    fs::remove_all(folder);
    fs::create_directories(folder / "old");
    fs::create_directories(folder / "new");
    fs::copy_file(std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/spot.obj", folder / "old/beside.obj");
    std::ofstream(folder / "old/scene.json")
        << R"({"name": "kept", "fluid": {"spacing": 0.05}, "colliders": [{"mesh": "beside.obj", "fitSize": 0.3}]})";
    Result<SceneFile> loaded = loadScene((folder / "old/scene.json").string(), {});
    ASSERT_TRUE(loaded) << loaded.error().message;
    viewer_->open(*loaded);
    settle();
    ASSERT_EQ(viewer_->scene().name, "kept") << viewer_->message();
    const auto save = [&](const std::string& path) {
        withControl('S');
        frame();
        for (int k = 0; k < 40; ++k) hit(key::kBackspace);
        type(path);
        hit(key::kEnter);
    };
    const auto textOf = [](SceneFile scene) { return writeJson([&scene](ParamVisitor& v) { scene.visit(v); }); };
    const std::string path = (folder / "new/saved.json").string();
    save(path);
    ASSERT_TRUE(fs::exists(path)) << viewer_->message();
    const Result<SceneFile> back = loadScene(path, {});
    ASSERT_TRUE(back) << back.error().message;
    SceneFile shown = viewer_->scene();
    EXPECT_EQ(back->colliders.at(0).mesh, (folder / "old/beside.obj").string());
    shown.colliders.at(0).mesh = back->colliders.at(0).mesh;
    EXPECT_EQ(textOf(*back), textOf(shown));
    viewer_->open(*back);
    settle();
    EXPECT_EQ(textOf(viewer_->scene()), textOf(*back));

    const std::string taken = (folder / "new/taken.json").string();
    std::ofstream(taken) << "somebody's";
    save(taken);
    EXPECT_EQ(*readFile(taken), "somebody's") << "Enter alone writes over nothing";
    // What is refused is said where it was typed, which is typed on.
    key(key::kEscape);
    frame();
    save((folder / "nowhere/x.json").string());
    EXPECT_FALSE(fs::exists(folder / "nowhere"));
    for (int k = 0; k < 3; ++k) frame();
    EXPECT_TRUE(ImGui::GetIO().WantTextInput);
    const char* const home = std::getenv("HOME");
    const std::string own = home != nullptr ? home : "";
    setenv("HOME", (folder / "new").c_str(), 1);
    save("~/plain");
    setenv("HOME", own.c_str(), 1);
    EXPECT_TRUE(fs::exists(folder / "new/plain.json")) << "in the person's folder, with the ending by which a scene is known";
    fs::remove_all(folder);
}

TEST_P(Opening, APictureShowsTheCurrentScene) {
    namespace fs = std::filesystem;
    const fs::path before = fs::current_path(), folder = fs::temp_directory_path() / ("rivulet_picture_" + std::string(GetParam()));
    fs::remove_all(folder);
    fs::create_directories(folder);
    fs::current_path(folder);
    for (int k = 0; k < 2; ++k) {
        frame();
        key(key::kF1 + 11);
    }
    viewer_.reset();
    fs::current_path(before);
    for (const char* name : {"small_0001.png", "small_0002.png"}) {
        const Result<Image> picture = loadImage((folder / name).string());
        ASSERT_TRUE(picture) << picture.error().message;
        EXPECT_EQ(picture->width, 90);
        EXPECT_EQ(picture->height, 70);
    }
    fs::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(Devices, Opening, ::testing::Values("cpu", "gl", "cl"), [](const auto& each) { return std::string(each.param); });

}  // namespace
}  // namespace rivulet::program_opening_test
