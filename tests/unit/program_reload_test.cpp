// Shaders, kernels and scenes are reloaded when saved; an error is shown on the screen and changes nothing until it is corrected.
#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <rivulet_glad/gl.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include "engine/compute/device_cl.h"
#include "engine/core/file.h"
#include "engine/core/file_watch.h"
#include "engine/gpu/device_gl.h"
#include "fluid/viewer/viewer.h"
#include "tests/unit/program_runner.h"
#include "tests/unit/viewer_fixture.h"

namespace rivulet::program_reload_test {
namespace {

namespace fs = std::filesystem;

std::string readFile(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}
void writeFile(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }
std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

TEST(FileWatch, ReportsAWrittenFileOnce) {
    const testing::Scratch scratch;
    const fs::path folder = scratch.path() / "shaders";
    fs::create_directories(folder / "deep");
    writeFile(folder / "a", "1");
    writeFile(folder / "deep/b", "1");
    FileWatch watch;
    watch.watch(folder.string());
    EXPECT_TRUE(watch.changed().empty());

    writeFile(folder / "deep/b", "half");
    EXPECT_TRUE(watch.changed().empty()) << "it may be half written";
    writeFile(folder / "deep/b", "half, and whole");
    EXPECT_TRUE(watch.changed().empty());
    EXPECT_EQ(watch.changed(), std::vector<std::string>{(folder / "deep/b").string()});
    EXPECT_TRUE(watch.changed().empty()) << "it was told";

    // As an editor that writes another file and gives it the name.
    fs::remove(folder / "a");
    EXPECT_TRUE(watch.changed().empty());
    EXPECT_TRUE(watch.changed().empty());
    writeFile(scratch.path() / "new", "another");
    fs::rename(scratch.path() / "new", folder / "a");
    EXPECT_TRUE(watch.changed().empty());
    EXPECT_EQ(watch.changed(), std::vector<std::string>{(folder / "a").string()});
    writeFile(folder / "c", "added");
    EXPECT_TRUE(watch.changed().empty());
    EXPECT_EQ(watch.changed().size(), 1U);
    watch.forget(folder.string());
    writeFile(folder / "c", "and forgotten");
    EXPECT_TRUE(watch.changed().empty());
    EXPECT_TRUE(watch.changed().empty());
}

// A window whose shaders are a copy that can be spoiled.
class Reload : public testing::ViewerFixture {
  protected:
    void SetUp() override {
        fs::copy(fs::path(RIVULET_SOURCE_DIR) / "shaders", scratch_.path() / "shaders", fs::copy_options::recursive);
        setenv("RIVULET_SHADERS", scratch_.path().c_str(), 1);
        open({900, 700}, {90, 70});
        input_.mouse = vec2(700, 100);
        usual_ = 1.0 / 60;
        scene_ =
            scratch_.file("small.json",
                          R"({"name": "small", "fluid": {"spacing": 0.05, "blocks": [{"min": [0.2, 0.2, 0.2], "max": [0.5, 0.5, 0.5]}]},
 "look": {"renderer": "points"}, "camera": {"position": [2, 1, 2]}})");
        start({});
    }
    void TearDown() override {
        ViewerFixture::TearDown();
        unsetenv("RIVULET_SHADERS");
    }
    void start(const std::vector<std::string>& assignments, const char* backend = "cpu") {
        const Result<SceneFile> scene = loadScene(scene_, assignments);
        ASSERT_TRUE(scene) << scene.error().message;
        begin(*scene, input_.size, input_.framebuffer, {.backend = backend, .share = [this] { return context_->shared(); }});
        frame();
    }
    // Until what was written has been seen, twice, and is there.
    void wait() {
        for (int k = 0; k < 3; ++k) frame(0.21);
        settle();
        frame();
    }
    std::array<uint8_t, 4> pixel() {
        std::array<uint8_t, 4> texel{};
        glBindFramebuffer(GL_READ_FRAMEBUFFER, target_.name());
        glReadPixels(80, 60, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, texel.data());
        glBindFramebuffer(GL_READ_FRAMEBUFFER, 0);
        return texel;
    }
    static bool onScreen() {
        const ImGuiWindow* window = ImGui::FindWindowByName("written");
        return window != nullptr && window->WasActive;
    }
    const std::string& trouble() {
        trouble_ = viewer_->reload().message();
        return trouble_;
    }
    fs::path shader(const char* path) const { return scratch_.path() / "shaders" / path; }

    testing::Scratch scratch_;
    std::string scene_, trouble_;
};

TEST_F(Reload, AShaderIsTakenAsItIsSavedAndABrokenOneIsNot) {
    input_.keysPressed = {key::kTab};
    frame();
    const fs::path file = shader("render/tonemap.frag");
    const std::string good = readFile(file), red = replaced(good, "    colour = vec4(c,", "    c = vec3(1.0, 0.0, 0.0); colour = vec4(c,");
    const auto before = pixel();
    writeFile(file, red);
    wait();
    EXPECT_EQ(trouble(), "");
    EXPECT_EQ(pixel(), (std::array<uint8_t, 4>{255, 0, 0, 255}));

    writeFile(file, replaced(good, "vec3 c = toSrgb", "vec3 c = toSRGB"));
    wait();
    EXPECT_NE(trouble().find("shaders/render/tonemap.frag:"), std::string::npos) << trouble();
    EXPECT_NE(trouble().find("toSRGB"), std::string::npos) << trouble();
    EXPECT_TRUE(onScreen()) << "though the panels may be hidden";
    EXPECT_EQ(pixel(), (std::array<uint8_t, 4>{255, 0, 0, 255})) << "the last good one draws";
    // Another file that is right does not hide what is wrong.
    const fs::path other = shader("render/antialias.frag");
    writeFile(other, readFile(other) + "\n// a word more\n");
    wait();
    EXPECT_NE(trouble().find("toSRGB"), std::string::npos) << trouble();

    // As an editor that saves by renaming.
    writeFile(scratch_.path() / "new", good);
    fs::rename(scratch_.path() / "new", file);
    wait();
    EXPECT_EQ(trouble(), "");
    EXPECT_EQ(pixel(), before);
    for (int k = 0; k < 3; ++k) frame(1);
    EXPECT_FALSE(onScreen());
}

TEST_F(Reload, AnIncludedFileReloadsItsIncluders) {
    const fs::path file = shader("render/frame.glsl");
    const std::string good = readFile(file);
    const GLuint64 steps = viewer_->steps();
    writeFile(file, good + "\nfloat wrong() { return 1 +; }\n");
    wait();
    EXPECT_NE(trouble().find("shaders/render/frame.glsl:"), std::string::npos) << trouble();
    EXPECT_GT(viewer_->steps(), steps) << "the water goes on";
    writeFile(file, good + "\nfloat right() { return 1.0; }\n");
    wait();
    EXPECT_EQ(trouble(), "");
}

// A live value changes the running scene, a fixed value restarts it; the user's camera stays in both cases.
TEST_F(Reload, ASceneIsTakenAsItIsSaved) {
    input_.keysPressed = {key::kTab};  // the wheel is the camera's
    for (int k = 0; k < 10; ++k) frame();
    input_.wheel.y = 3;
    frame();
    const vec3 eye = viewer_->scene().camera.position;
    EXPECT_NE(eye, vec3(2, 1, 2));
    const std::string text = readFile(scene_);
    const double then = viewer_->session().time();

    writeFile(scene_, replaced(text, R"("fluid": {)", R"("fluid": {"viscosity": 0.5, )"));
    wait();
    EXPECT_EQ(trouble(), "");
    EXPECT_EQ(viewer_->scene().fluid.viscosity, 0.5F);
    EXPECT_GT(viewer_->session().time(), then) << "the water goes on";
    EXPECT_EQ(viewer_->scene().camera.position, eye);

    writeFile(scene_, replaced(text, R"("spacing": 0.05)", R"("spacng": 0.04)"));
    wait();
    EXPECT_NE(trouble().find("small.json:1"), std::string::npos) << trouble();
    EXPECT_NE(trouble().find("spacng"), std::string::npos) << trouble();
    EXPECT_TRUE(onScreen());
    EXPECT_EQ(viewer_->scene().fluid.viscosity, 0.5F) << "the last good one is shown";
    EXPECT_GT(viewer_->session().time(), then);

    writeFile(scene_, replaced(text, R"("spacing": 0.05)", R"("spacing": 0.04)"));
    wait();
    EXPECT_EQ(trouble(), "");
    EXPECT_EQ(viewer_->scene().fluid.spacing, 0.04F);
    EXPECT_LT(viewer_->session().time(), then) << "another spacing is another water";
    EXPECT_EQ(viewer_->scene().camera.position, eye);

    writeFile(scene_, replaced(text, R"("position": [2, 1, 2])", R"("position": [3, 1, 2])"));
    wait();
    EXPECT_EQ(viewer_->scene().camera.position, vec3(3, 1, 2)) << "unless it is the camera that was written";
}

TEST_F(Reload, AnErrorIsReportedUntilItIsCorrected) {
    const std::string text = readFile(scene_);
    writeFile(scene_, replaced(text, R"("camera")", R"("colliders": [{"mesh": "meshes/spt.obj"}], "camera")"));
    wait();
    EXPECT_NE(trouble().find("spt.obj"), std::string::npos) << trouble();
    EXPECT_TRUE(viewer_->scene().colliders.empty());
    writeFile(scene_, replaced(text, R"("camera")", R"("colliders": [{"mesh": "meshes/spot.obj", "fitSize": 0.3}], "camera")"));
    wait();
    EXPECT_EQ(trouble(), "");
    EXPECT_EQ(viewer_->scene().colliders.size(), 1U);
}

TEST_F(Reload, ValuesOfTheCommandLineStaySet) {
    start({"fluid.viscosity=0.25"});
    writeFile(scene_, replaced(readFile(scene_), R"("name": "small")", R"("name": "other", "timeScale": 0.5)"));
    wait();
    EXPECT_EQ(viewer_->scene().name, "other");
    EXPECT_EQ(viewer_->scene().timeScale, 0.5F);
    EXPECT_EQ(viewer_->scene().fluid.viscosity, 0.25F);
}

TEST_F(Reload, KernelsOfAGpuAreReloadedDuringARun) {
    start({}, "gl");
    const fs::path file = shader("fluid/methods/pbf_predict.kernel");
    const std::string good = readFile(file);
    writeFile(file, good + "\nwrong\n");
    wait();
    EXPECT_NE(trouble().find("shaders/fluid/methods/pbf_predict.kernel:"), std::string::npos) << trouble();
    const double then = viewer_->session().time();
    frame();
    EXPECT_GT(viewer_->session().time(), then);
    writeFile(file, good + "\n// a word more\n");
    wait();
    EXPECT_EQ(trouble(), "");
    EXPECT_EQ(viewer_->session().world().stats().nan, 0U);
}

TEST_F(Reload, TheSceneThatIsOpenedNextIsWatchedInstead) {
    const std::string text = readFile(scene_), next = scratch_.file("next.json", replaced(text, "small", "next"));
    const Result<SceneFile> scene = loadScene(next, {});
    ASSERT_TRUE(scene);
    viewer_->open(*scene);
    wait();
    writeFile(scene_, replaced(text, "small", "nobody looks"));
    wait();
    EXPECT_EQ(viewer_->scene().name, "next");
    writeFile(next, replaced(text, "small", "written"));
    wait();
    EXPECT_EQ(viewer_->scene().name, "written");
}

// Values set in the window stay set unless the file changes them; a dropped mesh stays, too.
TEST_F(Reload, ValuesSetInTheWindowStaySet) {
    const std::string text = readFile(scene_);
    input_.dropped = {std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/sphere.obj"};
    frame();
    input_.dropped.clear();
    settle();
    ASSERT_EQ(viewer_->scene().colliders.size(), 1U);
    withControl('F');
    type("timeScale");
    ASSERT_TRUE(hover("parameters", {"timeScale", "##v", "#0", ""}));
    click();
    const float slow = viewer_->scene().timeScale;
    ASSERT_NE(slow, 1.0F);

    writeFile(scene_, replaced(text, R"("fluid": {)", R"("fluid": {"viscosity": 0.5, )"));
    wait();
    EXPECT_EQ(trouble(), "");
    EXPECT_EQ(viewer_->scene().fluid.viscosity, 0.5F);
    EXPECT_EQ(viewer_->scene().timeScale, slow);
    ASSERT_EQ(viewer_->scene().colliders.size(), 1U);
    EXPECT_NE(viewer_->scene().colliders[0].mesh.find("sphere.obj"), std::string::npos);
    ASSERT_TRUE(hover("###scene", {"reset all"})) << "what the file says is what a reset goes back to";

    writeFile(scene_, replaced(text, R"("name": "small",)", R"("name": "small", "timeScale": 0.25,)"));
    wait();
    EXPECT_EQ(viewer_->scene().timeScale, 0.25F) << "the last who said so";
    EXPECT_NE(viewer_->scene().fluid.viscosity, 0.5F) << "the file no longer says it";
}

// After saving over its own file, the scene follows the file and no longer the command line.
TEST_F(Reload, ASceneThatIsSavedOverItsFileIsTheFiles) {
    const fs::path before = fs::current_path();
    fs::current_path(scratch_.path());
    start({"fluid.viscosity=0.25"});
    input_.keysDown = {key::kLeftControl};
    input_.keysPressed = {'S'};
    frame();
    input_.keysDown.clear();
    for (int k = 0; k < 3; ++k) frame();
    const ImGuiWindow* dialog = ImGui::FindWindowByName("save the scene");
    ASSERT_NE(dialog, nullptr);
    const ImGuiID button = ImHashStr("###write", 0, dialog->ID);
    const ImRect inside = dialog->Rect();
    bool found = false;
    for (float y = inside.Min.y; y < inside.Max.y && !found; y += 5) {
        input_.mouse = vec2(inside.Min.x + 30, y);
        for (int k = 0; k < 2; ++k) frame(0);
        found = ImGui::GetCurrentContext()->HoveredIdPreviousFrame == button;
    }
    ASSERT_TRUE(found);
    input_.buttonPressed[0] = input_.buttonDown[0] = true;
    frame();
    input_.buttonReleased[0] = true;
    input_.buttonDown[0] = false;
    frame();
    fs::current_path(before);
    const std::string saved = readFile(scene_);
    EXPECT_NE(saved.find("0.25"), std::string::npos) << saved;
    const double then = viewer_->session().time();
    wait();
    EXPECT_GT(viewer_->session().time(), then) << "what was saved is what is shown";
    writeFile(scene_, replaced(saved, "0.25", "0.5"));
    wait();
    EXPECT_EQ(trouble(), "");
    EXPECT_EQ(viewer_->scene().fluid.viscosity, 0.5F);
}

constexpr const char* kScale = R"(#include "shaders/common/lang.h"
STRUCT(ScaleParams) { uint count; float factor; float padA; float padB; };
#define ARGS(RO, RW) \
    RW(1, Out, float, out_)
BUFFERS(ScaleParams)
KERNEL(scale, ScaleParams) {
    uint i = THREAD_ID;
    if (i < PARAMS.count) out_[i] = PARAMS.factor;
}
)";
struct alignas(16) ScaleParams {
    uint32_t count;
    float factor;
    float padding[2] = {};
};

class ReloadKernels : public testing::FramebufferFixture, public ::testing::WithParamInterface<Backend> {};

TEST_P(ReloadKernels, AreTakenAndBrokenOnesAreNot) {
    open({9, 9}, {9, 9});
    ASSERT_TRUE(context_);
    const testing::Scratch scratch;
    fs::create_directories(scratch.path() / "shaders/test");
    const fs::path file = scratch.path() / "shaders/test/scale.kernel";
    writeFile(file, kScale);
    const ShaderFiles files(scratch.path().string());
    std::unique_ptr<Device> device;
    if (GetParam() == Backend::gl) {
        device = makeGlDevice(files);
    } else {
        Result<std::unique_ptr<Device>> made = makeClDevice(files, {}, {.cache = ""});
        if (!made) GTEST_SKIP() << made.error().message;
        device = std::move(*made);
    }
    const Result<Kernel> kernel = device->kernel("test/scale");
    ASSERT_TRUE(kernel) << kernel.error().message;
    Result<Buffer> out = device->allocate(sizeof(float));
    ASSERT_TRUE(out);
    const auto run = [&] {
        device->run(*kernel, ScaleParams{1, 3}, {&*out}, 1);
        return device->readAll<float>(*out, 1)[0];
    };
    EXPECT_EQ(run(), 3);
    Result<size_t> taken = device->reload();
    ASSERT_TRUE(taken) << taken.error().message;
    EXPECT_EQ(*taken, 0U) << "nothing was written";

    writeFile(file, replaced(kScale, "PARAMS.factor;", "2.0f * PARAMS.factor;"));
    taken = device->reload();
    ASSERT_TRUE(taken) << taken.error().message;
    EXPECT_EQ(*taken, 1U);
    EXPECT_EQ(run(), 6);

    writeFile(file, replaced(kScale, "PARAMS.factor;", "PARAMS.fctor;"));
    taken = device->reload();
    ASSERT_FALSE(taken);
    EXPECT_NE(taken.error().message.find("shaders/test/scale.kernel:8"), std::string::npos) << taken.error().message;
    EXPECT_EQ(run(), 6);

    std::string more = replaced(kScale, "RW(1, Out, float, out_)", "RW(1, Out, float, out_) RO(2, In, float, in_)");
    writeFile(file, replaced(more, "PARAMS.factor;", "PARAMS.factor + in_[i];"));
    taken = device->reload();
    ASSERT_FALSE(taken) << "nobody hands it another buffer";
    EXPECT_EQ(run(), 6);

    writeFile(file, kScale);
    taken = device->reload();
    ASSERT_TRUE(taken) << taken.error().message;
    EXPECT_EQ(run(), 3);
}

INSTANTIATE_TEST_SUITE_P(Devices, ReloadKernels, ::testing::Values(Backend::gl, Backend::cl),
                         [](const auto& each) { return std::string(backendName(each.param)); });

}  // namespace
}  // namespace rivulet::program_reload_test
