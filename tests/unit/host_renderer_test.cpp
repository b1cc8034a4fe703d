// A host's renderer given in C that throws an exception: the draw fails, and the next one does not.
#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <EGL/egl.h>

#include <glm/gtc/type_ptr.hpp>
#include <stdexcept>
#include <string>

#include "engine/app/context_egl.h"
#include "fluid/capi/rivulet.h"
#include "tests/unit/gl_snapshot.h"
#include "tests/unit/host_fixture.h"
#include "tests/unit/host_water.h"

namespace rivulet::host_renderer_test {
namespace {

using testing::HostScene;

void fail(void*, const rivulet_drawing*) {
    glEnable(GL_BLEND);
    throw std::runtime_error("no ink");
}
void failOddly(void*, const rivulet_drawing*) { throw 7; }

TEST(HostRenderer, ThatThrowsFailsTheDraw) {
    Result<ContextEgl> gl = ContextEgl::create();
    if (!gl) {
        ASSERT_TRUE(testing::mayLackOpenGl()) << gl.error().message;
        GTEST_SKIP() << gl.error().message;
    }
    rivulet_error why{};
    rivulet_context* context = nullptr;
    rivulet_context_options options{};
    options.size = sizeof options;
    options.find = eglGetProcAddress;
    options.backend = "cpu";
    ASSERT_EQ(rivulet_context_create(&options, &context, &why), RIVULET_OK) << why.message;
    rivulet_world* world = nullptr;
    rivulet_world_options scene{};
    scene.size = sizeof scene;
    scene.json = R"({"fluid": {"spacing": 0.04, "blocks": [{"min": [0.1, 0, 0.2], "max": [0.9, 0.4, 0.8]}]}})";
    ASSERT_EQ(rivulet_world_create(context, &scene, &world, &why), RIVULET_OK) << why.message;
    const HostScene plain(80, 60), host(80, 60);
    const FrameView v = plain.view();
    rivulet_view view{};
    view.size = sizeof view;
    view.view = glm::value_ptr(v.view);
    view.projection = glm::value_ptr(v.projection);
    view.near_plane = v.nearPlane;
    view.far_plane = v.farPlane;
    rivulet_target target{};
    target.size = sizeof target;
    target.framebuffer = plain.target().framebuffer;
    target.width = 80;
    target.height = 60;
    ASSERT_EQ(rivulet_world_draw(world, &view, &target, &why), RIVULET_OK) << why.message;
    target.framebuffer = host.target().framebuffer;
    rivulet_renderer renderer{};
    renderer.size = sizeof renderer;
    view.renderer = &renderer;
    const testing::GlSnapshot before = testing::glSnapshot();
    for (const int32_t stage : {RIVULET_AFTER, RIVULET_INSTEAD}) {
        renderer.stage = stage;
        renderer.draw = fail;
        EXPECT_EQ(rivulet_world_draw(world, &view, &target, &why), RIVULET_FAILED);
        EXPECT_NE(std::string(why.message).find("renderer.draw threw an exception: no ink"), std::string::npos) << why.message;
        renderer.draw = failOddly;
        EXPECT_EQ(rivulet_world_draw(world, &view, &target, &why), RIVULET_FAILED);
        EXPECT_EQ(testing::difference(before, testing::glSnapshot()), "");
    }
    view.renderer = nullptr;
    const HostScene again(80, 60);
    target.framebuffer = again.target().framebuffer;
    EXPECT_EQ(rivulet_world_draw(world, &view, &target, &why), RIVULET_OK) << why.message;
    EXPECT_EQ(again.pixels(), plain.pixels());
    rivulet_world_destroy(world);
    rivulet_context_destroy(context);
}

}  // namespace
}  // namespace rivulet::host_renderer_test
