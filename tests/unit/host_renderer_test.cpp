// A host's renderer given in C that throws an exception: the draw fails, and the next one does not.
#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <EGL/egl.h>

#include <stdexcept>
#include <string>

#include "fluid/capi/rivulet.h"
#include "tests/unit/c_host.h"
#include "tests/unit/gl_snapshot.h"
#include "tests/unit/host_fixture.h"

namespace rivulet::host_renderer_test {
namespace {

using testing::HostScene;

void fail(void*, const rivulet_drawing*) {
    glEnable(GL_BLEND);
    throw std::runtime_error("no ink");
}
void failOddly(void*, const rivulet_drawing*) { throw 7; }

class HostRenderer : public testing::CHost {};
TEST_F(HostRenderer, ThatThrowsFailsTheDraw) {
    rivulet_context* context = nullptr;
    rivulet_world* world = nullptr;
    makeContext(eglGetProcAddress, context);
    ASSERT_FALSE(HasFatalFailure());
    makeWorld(context, world);
    ASSERT_FALSE(HasFatalFailure());
    const HostScene plain(80, 60), host(80, 60);
    ASSERT_EQ(draw(world, plain), RIVULET_OK) << why_.message;
    rivulet_renderer renderer{};
    renderer.size = sizeof renderer;
    const testing::GlSnapshot before = testing::glSnapshot();
    for (const int32_t stage : {RIVULET_AFTER, RIVULET_INSTEAD}) {
        renderer.stage = stage;
        renderer.draw = fail;
        EXPECT_EQ(draw(world, host, 0, &renderer), RIVULET_FAILED);
        EXPECT_NE(std::string(why_.message).find("renderer.draw threw an exception: no ink"), std::string::npos) << why_.message;
        renderer.draw = failOddly;
        EXPECT_EQ(draw(world, host, 0, &renderer), RIVULET_FAILED);
        EXPECT_EQ(testing::difference(before, testing::glSnapshot()), "");
    }
    const HostScene again(80, 60);
    EXPECT_EQ(draw(world, again), RIVULET_OK) << why_.message;
    EXPECT_EQ(again.pixels(), plain.pixels());
    rivulet_world_destroy(world);
    rivulet_context_destroy(context);
}

}  // namespace
}  // namespace rivulet::host_renderer_test
