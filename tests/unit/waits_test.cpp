// What waits for the GPU in a frame on backend gl: docs/how_it_works.md lists it, and nothing else does.
#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/app/gl_count.h"
#include "engine/gpu/device_gl.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/session/session.h"
#include "tests/unit/opengl_test.h"

namespace rivulet::waits_test {
namespace {

size_t waited = 0;  // calls of glClientWaitSync that may wait
PFNGLCLIENTWAITSYNCPROC counted = nullptr;

GLenum GLAD_API_PTR waitSync(GLsync sync, GLbitfield flags, GLuint64 nanoseconds) {
    if (nanoseconds > 0) ++waited;
    return counted(sync, flags, nanoseconds);
}

gpu::FunctionPointer find(const char* name) {
    const gpu::FunctionPointer found = countingFind(name);
    if (std::string_view(name) != "glClientWaitSync") return found;
    counted = reinterpret_cast<PFNGLCLIENTWAITSYNCPROC>(found);
    return reinterpret_cast<gpu::FunctionPointer>(waitSync);
}

// Calls that return after the GPU has finished what they ask for.
std::map<std::string, size_t> waiting(const GlCalls& calls) {
    std::map<std::string, size_t> some;
    for (const char* name :
         {"glFinish", "glGetNamedBufferSubData", "glGetBufferSubData", "glReadPixels", "glReadnPixels", "glGetTexImage",
          "glGetTextureImage", "glGetTextureSubImage", "glGetnTexImage", "glMapBuffer", "glMapBufferRange", "glMapNamedBuffer"})
        if (const auto found = calls.byName.find(name); found != calls.byName.end()) some.insert(*found);
    if (waited > 0) some["glClientWaitSync"] = waited;
    return some;
}

// A ball that bobs in the middle of a pool.
std::string ballInPool() {
    const std::string path = ::testing::TempDir() + "waits_ball_in_pool.json";
    std::ofstream(path) << R"({"name": "ball_in_pool", "doc": "", "fluid": {"method": "pbf", "spacing": 0.08,
        "box": {"max": [1.6, 1.2, 1.6]}, "blocks": [{"max": [1.6, 0.64, 1.6]}]},
        "bodies": [{"shape": "sphere", "radius": 0.12, "density": 400, "position": [0.8, 0.72, 0.8]}]})";
    return path;
}

// A GPU waits for no frame of these: particles of all methods with foam, moving and deforming solids, drops and wetness on skins, a ball in
// a pool. Ducks that are near others or a wall are moved by the host: their loads are read in each substep of such a frame.
TEST(Waits, FramesWaitForWhatTheTableNamesAlone) {
    Result<ContextEgl> context = ContextEgl::create({});
    if (!context && testing::mayLackOpenGl()) GTEST_SKIP() << context.error().message;
    ASSERT_TRUE(context) << context.error().message;
    ASSERT_TRUE(gpu::load(find));
    const ShaderFiles files = ShaderFiles::developer();
    struct Case {
        const char* scene;
        std::vector<std::string> set;
        bool bodies = false;  // that may touch something
    };
    for (const Case& c :
         {Case{"dam_break", {"fluid.spacing=0.08", "fluid.method=pbf", "fluid.foam.most=500"}},
          Case{"paddle_wheel", {"fluid.spacing=0.08", "fluid.method=dfsph"}}, Case{"waving_sheet", {"fluid.spacing=0.08"}},
          Case{"cold_bottle", {}}, Case{"", {}}, Case{"rubber_ducks", {"fluid.spacing=0.08", "fluid.fixedStep=0.0041666"}, true}}) {
        SCOPED_TRACE(c.scene);
        const std::unique_ptr<Device> device = makeGlDevice(files, {});
        const Result<SceneFile> scene =
            loadScene(*c.scene == 0 ? ballInPool() : RIVULET_SOURCE_DIR "/assets/scenes/" + std::string(c.scene) + ".json", c.set);
        ASSERT_TRUE(scene) << scene.error().message;
        auto session = Session::create(*scene, *device, {});
        ASSERT_TRUE(session) << session.error().message;
        const auto renderer = SceneRenderer::create(files);
        ASSERT_TRUE(renderer) << renderer.error().message;
        FluidUpload upload;
        const FrameView view = frameViewOf(cameraOf(scene->camera, (*session)->bounds()), scene->light, 64, 48, 0);
        uint64_t bodyWaits = 0;
        for (int frame = 0; frame < 6; ++frame) {
            if (frame == 3) {  // memory has grown to what it needs
                device->finish();
                device->poll();
                bodyWaits = (*session)->world().stats().bodyWaits;
                device->takeTimes();
                startGlCount();
                waited = 0;
            }
            (*session)->step(1.0 / 60, false);
            const auto fluid = upload.view((*session)->world(), (*session)->scene().look);
            ASSERT_TRUE(fluid) << fluid.error().message;
            ASSERT_TRUE((*session)->flows().draw());
            ASSERT_TRUE((*renderer)->draw(view, *fluid, (*session)->solids(), (*session)->scene()));
        }
        std::map<std::string, size_t> waits = waiting(glCount());
        device->finish();
        device->poll();
        bodyWaits = (*session)->world().stats().bodyWaits - bodyWaits;
        if (c.bodies) {
            EXPECT_EQ(waits["glGetNamedBufferSubData"], bodyWaits);
            EXPECT_GE(bodyWaits, 3U) << "they begin near each other";
            waits.erase("glGetNamedBufferSubData");
        } else {
            EXPECT_EQ(bodyWaits, 0U);
        }
        for (const auto& [call, count] : waits) ADD_FAILURE() << count << " calls of " << call << " wait in 3 frames";
    }
}

}  // namespace
}  // namespace rivulet::waits_test
