// Water in a host's picture: pixels without water do not change, objects in front hide it, and the host's formats have no effect.
#include "fluid/render/water_renderer.h"

#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <functional>

#include "engine/app/capture.h"
#include "engine/compute/device_cpu.h"
#include "fluid/render/fluid_snapshot.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/render/renderers.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "tests/unit/host_fixture.h"
#include "tests/unit/host_water.h"

namespace rivulet::water_renderer_test {
namespace {

using testing::HostScene;
constexpr int kWidth = 160, kHeight = 120;

class WaterInAHostsPicture : public testing::HostWater {
  protected:
    WaterInAHostsPicture() : HostWater(4) {}
    Status draw(const HostScene& host, const RendererRow* row = nullptr) {
        return renderer_->draw(host.view(), testing::viewOf(*world_), {}, host.target(), row);
    }
    static double meanDifference(const std::vector<vec4>& a, const std::vector<vec4>& b) {
        double sum = 0;
        for (size_t k = 0; k < a.size(); ++k) sum += glm::dot(glm::abs(vec3(a[k]) - vec3(b[k])), vec3(1.0F / 3));
        return sum / static_cast<double>(a.size());
    }
};

// The box that the water is in, as the picture has it: all that may change.
bool mayBeWater(const FrameView& v, int x, int y) {
    vec2 low(1e9F), high(-1e9F);
    for (int k = 0; k < 8; ++k) {
        const vec4 c = v.projection * v.view * vec4(k & 1, (k & 2) / 2 * 0.6F, (k & 4) / 4, 1.0F);
        const vec2 at = (vec2(c) / c.w * 0.5F + 0.5F) * vec2(v.width, v.height);
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    return static_cast<float>(x) > low.x - 2 && static_cast<float>(x) < high.x + 2 && static_cast<float>(y) > low.y - 2 &&
           static_cast<float>(y) < high.y + 2;
}

// A view of what has not changed copies nothing, and says so.
TEST_F(WaterInAHostsPicture, AViewOfTheSameStateCopiesNothing) {
    const auto device = makeCpuDevice(cpuKernels());
    const auto world = FluidWorld::create(*device, world_->params(), {}, {});
    ASSERT_TRUE(world) << world.error().message;
    FluidUpload upload;
    const auto first = upload.view(**world, {});
    ASSERT_TRUE(first) << first.error().message;
    ASSERT_GT(first->count, 0U);
    const size_t all = first->count * (2 * sizeof(vec4) + sizeof(uint32_t));  // positions, velocities, ids
    EXPECT_EQ(upload.facts().bytes, all);
    const auto again = upload.view(**world, {});
    ASSERT_TRUE(again);
    EXPECT_EQ(again->position, first->position);
    EXPECT_EQ(upload.facts().bytes, 0U);
    FluidSnapshot snapshot;
    ASSERT_TRUE(snapshot.take(**world));
    ASSERT_TRUE(upload.view(snapshot, {}));
    EXPECT_EQ(upload.facts().bytes, all);
    ASSERT_TRUE(upload.view(snapshot, {}));
    EXPECT_EQ(upload.facts().bytes, 0U);
}

// What drips beside the world is in its snapshot as it was, and gone after the next.
TEST_F(WaterInAHostsPicture, ASnapshotHasTheDropsOfSkins) {
    const std::vector<vec4> drops = {vec4(0.5F, 0.7F, 0.5F, 0.02F), vec4(0, -1, 0, 0)}, pendants(5, vec4(0.25F));
    FluidSnapshot snapshot;
    FluidUpload upload;
    ASSERT_TRUE(snapshot.take(*world_, drops, pendants));
    const Result<FluidView> view = upload.view(snapshot, {});
    ASSERT_TRUE(view) << view.error().message;
    EXPECT_EQ(view->dropCount, 1U);
    EXPECT_EQ(view->pendantCount, 1U);
    std::vector<vec4> there(2), hanging(5);
    glGetNamedBufferSubData(view->drops, 0, sizeof(vec4) * 2, there.data());
    glGetNamedBufferSubData(view->pendants, 0, sizeof(vec4) * 5, hanging.data());
    EXPECT_EQ(there, drops);
    EXPECT_EQ(hanging, pendants);
    ASSERT_TRUE(snapshot.take(*world_));
    const Result<FluidView> after = upload.view(snapshot, {});
    ASSERT_TRUE(after);
    EXPECT_EQ(after->dropCount + after->pendantCount, 0U);
}

TEST_F(WaterInAHostsPicture, ChangesOnlyWhereThereIsWater) {
    const HostScene host(kWidth, kHeight, {.left = 7, .bottom = 5});
    const std::vector<vec4> before = host.pixels();
    const std::vector<float> depthBefore = host.depths();
    ASSERT_TRUE(draw(host));
    const std::vector<vec4> after = host.pixels();
    const std::vector<float> depthAfter = host.depths();
    size_t changed = 0, nearer = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const auto k = static_cast<size_t>(y * kWidth + x);
            const bool same = before[k] == after[k] && depthBefore[k] == depthAfter[k];
            changed += same ? 0 : 1;
            if (!mayBeWater(host.view(), x, y)) EXPECT_TRUE(same) << x << " " << y;
            EXPECT_EQ(after[k].w, before[k].w) << "alpha is the host's";
            EXPECT_LE(depthAfter[k], depthBefore[k] * 1.0001F) << "water lies before what it covers";
            nearer += depthAfter[k] < depthBefore[k] ? 1 : 0;
            // The red post stands before the water.
            if (before[k].x > 0.7F && before[k].z < 0.4F) EXPECT_TRUE(same) << "at the post: " << x << " " << y;
        }
    EXPECT_GT(changed, before.size() / 8);
    EXPECT_GT(nearer, changed / 2);
    // Its depth is where the block of water is: the front face is near z = 0.8, 1.3 m and more from the camera.
    for (size_t k = 0; k < before.size(); ++k)
        if (depthAfter[k] < depthBefore[k]) EXPECT_GT(depthAfter[k], 0.9F);
}

TEST_F(WaterInAHostsPicture, FormatsAndConventionsMakeNoDifference) {
    const HostScene plain(kWidth, kHeight);
    ASSERT_TRUE(draw(plain));
    const std::vector<vec4> reference = plain.pixels();
    const std::vector<float> depth = plain.depths();
    const struct {
        const char* name;
        HostScene::Options options;
        double tolerance;  // of the picture's mean, of 1
    } rows[] = {
        {"linear floats", {.colour = GL_RGBA16F}, 0.002},
        {"sRGB format", {.colour = GL_SRGB8_ALPHA8}, 0.002},
        {"10 bits", {.colour = GL_RGB10_A2}, 0.003},
        {"depth of 24 bits alone", {.depth = GL_DEPTH_COMPONENT24}, 1.0e-5},
        {"depth of 16 bits", {.depth = GL_DEPTH_COMPONENT16}, 0.004},
        {"depth of floats", {.depth = GL_DEPTH_COMPONENT32F}, 0.001},
        {"floats and stencil", {.depth = GL_DEPTH32F_STENCIL8}, 0.001},
        {"zero to one", {.depth = GL_DEPTH_COMPONENT32F, .zeroToOne = true}, 0.001},
        {"reversed", {.depth = GL_DEPTH_COMPONENT32F, .zeroToOne = true, .reversed = true}, 0.001},
        {"renderbuffers", {.textures = false}, 1.0e-5},
        {"four samples", {.samples = 4}, 0.004},
        {"four samples of renderbuffers", {.samples = 4, .textures = false}, 0.004},
    };
    for (const auto& row : rows) {
        SCOPED_TRACE(row.name);
        glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
        const HostScene host(kWidth, kHeight, row.options);
        const Status drawn = draw(host);
        ASSERT_TRUE(drawn) << drawn.error().message;
        EXPECT_LT(meanDifference(host.pixels(), reference), row.tolerance);
        const std::vector<float> depths = host.depths();
        size_t off = 0;
        for (size_t k = 0; k < depth.size(); ++k) off += depth[k] < 5 && std::abs(depths[k] - depth[k]) > 0.01F ? 1 : 0;
        EXPECT_LT(off, depth.size() / 200);
        glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    }
}

TEST_F(WaterInAHostsPicture, IsAnsweredInASentenceWhereItCannotBe) {
    const HostScene host(kWidth, kHeight);
    const FluidView fluid = testing::viewOf(*world_);
    const auto said = [&](const FrameView& view, const HostTarget& target) {
        const Status drawn = renderer_->draw(view, fluid, {}, target);
        return drawn ? std::string() : drawn.error().message;
    };
    HostTarget closed = host.target();
    closed.height = 0;
    EXPECT_NE(said(host.view(), closed).find("160 x 0"), std::string::npos);
    EXPECT_EQ(said(host.view(), host.target()), "");

    // Values that are not finite; views and projections are in any_view_test.cpp.
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto refusedFor = [&](const char* word, const std::function<void(FrameView&)>& spoil) {
        FrameView view = host.view();
        spoil(view);
        EXPECT_NE(said(view, host.target()).find(word), std::string::npos) << said(view, host.target());
    };
    refusedFor("light's colour", [&](FrameView& v) { v.lightColour.y = nan; });
    refusedFor("direction is 0", [&](FrameView& v) { v.lightDirWorld = vec3(0.0F); });
    refusedFor("colour is negative", [&](FrameView& v) { v.lightColour.y = -1; });

    // Targets that cannot receive water.
    const auto refusedInto = [&](const char* word, const std::function<void(HostTarget&)>& spoil) {
        HostTarget target = host.target();
        spoil(target);
        EXPECT_NE(said(host.view(), target).find(word), std::string::npos) << said(host.view(), target);
        EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR}) << word;
    };
    refusedInto("not a framebuffer", [](HostTarget& t) { t.framebuffer = 999; });
    refusedInto("no window", [](HostTarget& t) { t.framebuffer = 0; });
    refusedInto("outside any framebuffer", [](HostTarget& t) { t.x = std::numeric_limits<int>::max(); });
    const auto whole = gpu::Texture::create({.width = kWidth, .height = kHeight, .format = gpu::Format::r32ui});
    ASSERT_TRUE(whole);
    const gpu::Framebuffer counts(*whole, nullptr);
    refusedInto("integer format", [&](HostTarget& t) { t.framebuffer = counts.name(); });
    GLuint empty = 0;
    glCreateFramebuffers(1, &empty);
    refusedInto("not complete", [&](HostTarget& t) { t.framebuffer = empty; });
    glNamedFramebufferParameteri(empty, GL_FRAMEBUFFER_DEFAULT_WIDTH, kWidth);
    glNamedFramebufferParameteri(empty, GL_FRAMEBUFFER_DEFAULT_HEIGHT, kHeight);
    refusedInto("no colour", [&](HostTarget& t) { t.framebuffer = empty; });
    glDeleteFramebuffers(1, &empty);

    // Queries of the host that would count Rivulet's drawing.
    GLuint query = 0;
    glCreateQueries(GL_SAMPLES_PASSED, 1, &query);
    glBeginQuery(GL_SAMPLES_PASSED, query);
    EXPECT_NE(said(host.view(), host.target()).find("a query counts"), std::string::npos);
    glEndQuery(GL_SAMPLES_PASSED);
    GLuint passed = 1;
    glGetQueryObjectuiv(query, GL_QUERY_RESULT, &passed);
    EXPECT_EQ(passed, 0U);
    glDeleteQueries(1, &query);
    EXPECT_EQ(said(host.view(), host.target()), "");

    const auto none = WaterRenderer::create({.memoryLimit = 1 << 16});
    ASSERT_FALSE(none);
    EXPECT_NE(none.error().message.find("surroundings"), std::string::npos) << none.error().message;
    auto free = WaterRenderer::create({});
    ASSERT_TRUE(free);
    auto small = WaterRenderer::create({.memoryLimit = (*free)->bytes() + (1 << 14)});
    ASSERT_TRUE(small);
    const Status refused = (*small)->draw(host.view(), fluid, {}, host.target());
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("allowed"), std::string::npos) << refused.error().message;
}

// A host may have opened the largest number of debug groups, and may wait for results in its own buffer.
TEST_F(WaterInAHostsPicture, LeavesAHostsDebugGroupsAndQueryBufferAlone) {
    const HostScene host(kWidth, kHeight);
    GLint most = 0, depth = 0, there = 0;
    glGetIntegerv(GL_MAX_DEBUG_GROUP_STACK_DEPTH, &most);
    for (glGetIntegerv(GL_DEBUG_GROUP_STACK_DEPTH, &depth); depth < most; ++depth)
        glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 1, 4, "host");
    GLuint buffer = 0;
    glCreateBuffers(1, &buffer);
    glNamedBufferStorage(buffer, 64, nullptr, 0);
    glBindBuffer(GL_QUERY_BUFFER, buffer);
    for (int k = 0; k < 4; ++k) ASSERT_TRUE(draw(host));
    glFinish();
    EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    glGetIntegerv(GL_DEBUG_GROUP_STACK_DEPTH, &depth);
    EXPECT_EQ(depth, most);
    glGetIntegerv(GL_QUERY_BUFFER_BINDING, &there);
    EXPECT_EQ(static_cast<GLuint>(there), buffer);
    EXPECT_FALSE(renderer_->times().empty()) << "the passes' times have arrived";
    glBindBuffer(GL_QUERY_BUFFER, 0);
    glDeleteBuffers(1, &buffer);
    for (; depth > 1; --depth) glPopDebugGroup();
}

// A renderer that Rivulet does not know: it dyes what it is given.
TEST_F(WaterInAHostsPicture, MayBeDrawnByAHostsOwnRow) {
    const HostScene host(kWidth, kHeight), with(kWidth, kHeight);
    const RendererRow row{"a host's", "dyes", true, [](gpu::FrameGraph& graph, FluidPrograms&, const FluidDraw& d) -> FluidLayers {
                              graph.pass("dye", {}, {d.colour}, [colour = d.colour](gpu::PassContext& c) {
                                  c.drawTo({colour}).clearColour(vec4(0.0F, 1.0F, 0.0F, 1.0F));
                              });
                              return {d.colour, {}};
                          }};
    ASSERT_TRUE(draw(with, &row));
    for (const vec4& p : with.pixels()) ASSERT_EQ(vec3(p), vec3(0, 1, 0));
    ASSERT_TRUE(draw(host, renderers().find("points")));
}

}  // namespace
}  // namespace rivulet::water_renderer_test
