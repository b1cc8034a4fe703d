// What water costs a host in calls of OpenGL: the figures are the same on every machine.
#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <cstdlib>
#include <utility>
#include <vector>

#include "engine/app/gl_count.h"
#include "fluid/capi/rivulet.h"
#include "tests/unit/c_host.h"
#include "tests/unit/host_fixture.h"

namespace rivulet::host_calls_test {
namespace {

using testing::HostScene;

class CallsOfAHost : public testing::CHost {
  protected:
    void SetUp() override {
        CHost::SetUp();
        if (!context_) return;
        makeContext(countingFind, rivulet_);
        for (rivulet_world*& world : worlds_) {
            makeWorld(rivulet_, world);
            step(world);
        }
    }
    void TearDown() override {
        for (rivulet_world* world : worlds_) rivulet_world_destroy(world);
        rivulet_context_destroy(rivulet_);
        CHost::TearDown();
    }
    void step(rivulet_world* world) { EXPECT_EQ(rivulet_world_step(world, nullptr, 1.0 / 60, &why_), RIVULET_OK) << why_.message; }
    template <class Drawn>
    void draw(Drawn* drawn, const HostScene& host, float aside = 0) {
        EXPECT_EQ(CHost::draw(drawn, host, aside), RIVULET_OK) << why_.message;
    }

    rivulet_context* rivulet_ = nullptr;
    rivulet_world* worlds_[2] = {};
};

size_t made(const GlCalls& calls) { return calls.of("glCreate") + calls.of("glGen"); }
size_t deleted(const GlCalls& calls) { return calls.of("glDelete") - calls.of("glDeleteSync"); }

TEST_F(CallsOfAHost, AFrameIsFewCalls) {
    const HostScene host(160, 120);
    for (int k = 0; k < 6; ++k) {
        step(worlds_[0]);
        draw(worlds_[0], host);
    }
    step(worlds_[0]);
    glFinish();  // so that the times of the passes have arrived
    const GlCalls calls = glCallsOf([&] { draw(worlds_[0], host); });
    EXPECT_LT(calls.all(), 600U) << calls.text();
    EXPECT_LT(calls.questions(), 200U) << calls.text();
    RecordProperty("calls", static_cast<int>(calls.all()));
    if (std::getenv("RIVULET_SHOW_CALLS") != nullptr) GTEST_LOG_(INFO) << calls.text();
    EXPECT_EQ(made(calls) + deleted(calls), 0U) << calls.text();
}

// A window and a render texture of another size, each with a depth format of its own.
TEST_F(CallsOfAHost, TwoTargetsInTurnMakeNothing) {
    const HostScene window(160, 120), texture(96, 64, {.depth = GL_DEPTH_COMPONENT32F});
    const auto frame = [&] {
        step(worlds_[0]);
        draw(worlds_[0], window);
        draw(worlds_[0], texture);
    };
    for (int k = 0; k < 12; ++k) frame();
    const GlCalls calls = glCallsOf([&] {
        for (int k = 0; k < 12; ++k) frame();
    });
    EXPECT_EQ(made(calls) + deleted(calls), 0U) << calls.text();
}

// The same frame seen by another eye: the particles are there already.
TEST_F(CallsOfAHost, ASecondEyeBringsNothingOver) {
    const HostScene left(160, 120), right(160, 120);
    for (int k = 0; k < 6; ++k) {
        step(worlds_[0]);
        draw(worlds_[0], left);
        draw(worlds_[0], right, 0.03F);
    }
    step(worlds_[0]);
    const auto copies = [](const GlCalls& calls) { return calls.of("glCopyNamedBufferSubData") + calls.of("glFenceSync"); };
    EXPECT_GT(copies(glCallsOf([&] { draw(worlds_[0], left); })), 0U);
    const GlCalls second = glCallsOf([&] { draw(worlds_[0], right, 0.03F); });
    EXPECT_EQ(copies(second), 0U) << second.text();
    EXPECT_LT(second.all(), 600U) << second.text();
    // It sees what it would see alone: another look, here that of the buffers, brings all of them over again.
    const HostScene eye(160, 120), alone(160, 120);
    EXPECT_EQ(copies(glCallsOf([&] { draw(worlds_[0], eye, 0.03F); })), 0U);
    rivulet_buffers buffers{};
    buffers.size = sizeof buffers;
    ASSERT_EQ(rivulet_world_buffers(worlds_[0], &buffers, &why_), RIVULET_OK) << why_.message;
    EXPECT_GT(copies(glCallsOf([&] { draw(worlds_[0], alone, 0.03F); })), 0U);
    EXPECT_EQ(eye.pixels(), alone.pixels());
    // Another world, and this one after a step, are brought over.
    EXPECT_GT(copies(glCallsOf([&] { draw(worlds_[1], right); })), 0U);
    step(worlds_[0]);
    EXPECT_GT(copies(glCallsOf([&] { draw(worlds_[0], right); })), 0U);
}

TEST_F(CallsOfAHost, ASecondEyeOfASnapshotBringsNothingOver) {
    const HostScene left(160, 120), right(160, 120), eye(160, 120), plain(160, 120);
    rivulet_snapshot* snapshot = nullptr;
    ASSERT_EQ(rivulet_snapshot_create(rivulet_, &snapshot, &why_), RIVULET_OK) << why_.message;
    const auto copies = [](const GlCalls& calls) { return calls.of("glCopyNamedBufferSubData") + calls.of("glFenceSync"); };
    for (int frame = 0; frame < 3; ++frame) {
        step(worlds_[0]);
        ASSERT_EQ(rivulet_world_snapshot(worlds_[0], snapshot, &why_), RIVULET_OK) << why_.message;
        EXPECT_GT(copies(glCallsOf([&] { draw(snapshot, left); })), 0U);
        EXPECT_EQ(copies(glCallsOf([&] { draw(snapshot, right, 0.03F); })), 0U);
    }
    draw(snapshot, eye, 0.03F);
    draw(worlds_[0], plain, 0.03F);
    EXPECT_TRUE(eye.pixels() == plain.pixels());
    rivulet_snapshot_destroy(snapshot);
}

// A host that knows its state is asked for nothing but the depth convention and what the target is, and finds defaults.
TEST_F(CallsOfAHost, AHostThatKnowsItsStateIsNotAsked) {
    const HostScene host(160, 120);
    draw(worlds_[0], host);
    const std::vector<vec4> picture = host.pixels();
    rivulet_context* context = nullptr;
    rivulet_world* world = nullptr;
    makeContext(countingFind, context, true);
    makeWorld(context, world);
    ASSERT_FALSE(HasFatalFailure());
    step(world);
    const HostScene other(160, 120);
    for (int k = 0; k < 4; ++k) draw(world, other);
    const HostScene again(160, 120);
    // What a host has left is made plain.
    glEnable(GL_CULL_FACE);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ZERO, GL_ZERO);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glDepthFunc(GL_NEVER);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 7);
    const GlCalls calls = glCallsOf([&] { draw(world, again); });
    EXPECT_LT(calls.questions(), 50U) << calls.text();
    EXPECT_EQ(again.pixels(), picture);
    EXPECT_FALSE(glIsEnabled(GL_CULL_FACE));
    EXPECT_FALSE(glIsEnabled(GL_BLEND));
    for (const auto& [what, value] :
         {std::pair(GL_DEPTH_FUNC, GL_LESS), std::pair(GL_CURRENT_PROGRAM, 0), std::pair(GL_VERTEX_ARRAY_BINDING, 0),
          std::pair(GL_TEXTURE_BINDING_2D, 0), std::pair(GL_UNPACK_ROW_LENGTH, 0), std::pair(GL_BLEND_SRC_RGB, GL_ONE)}) {
        GLint is = -1;
        glGetIntegerv(static_cast<GLenum>(what), &is);
        EXPECT_EQ(is, value) << what;
    }
    rivulet_world_destroy(world);
    rivulet_context_destroy(context);
}

}  // namespace
}  // namespace rivulet::host_calls_test
