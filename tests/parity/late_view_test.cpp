// What a window shows of a world on OpenCL that shares no memory with OpenGL: a state that was, whole, and not older than three frames.
#include "fluid/session/late_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <tuple>

#include "engine/gpu/buffer.h"
#include "fluid/session/session.h"
#include "tests/parity/devices.h"
#include "tests/unit/gpu_context.h"

namespace rivulet::late_view_test {
namespace {

using LateViewTest = GpuTest;

std::vector<std::tuple<float, float, float>> sorted(const std::vector<vec4>& all) {
    std::vector<std::tuple<float, float, float>> some;
    for (const vec4& x : all)
        if (!(x.w < 0)) some.emplace_back(x.x, x.y, x.z);
    std::sort(some.begin(), some.end());
    return some;
}

TEST_F(LateViewTest, ParticlesAndSolidsAreOfOneTime) {
    Result<TestGpu> cl = makeTestGpu("cl");
    if (!cl) GTEST_SKIP() << cl.error().message;
    Device& device = *cl->device;
    const Result<SceneFile> scene =
        loadScene("paddle_wheel", std::vector<std::string>{"fluid.spacing=0.08", "look.quality=fine", "fluid.foam.most=200"});
    ASSERT_TRUE(scene) << scene.error().message;
    const auto session = Session::create(*scene, device, {});
    ASSERT_TRUE(session) << session.error().message;
    struct Was {
        size_t frame = 0;
        std::vector<std::tuple<float, float, float>> particles;
        std::vector<mat4> places;
    };
    const auto placesOf = [](const Scene& solids) {
        std::vector<mat4> all;
        for (const Node& node : solids.nodes()) all.push_back(node.local);
        return all;
    };
    std::map<double, Was> past;
    FluidUpload upload;
    LateView late;
    size_t behind = 0;
    for (size_t k = 0; k < 16; ++k) {
        if (k == 10) (*session)->reset();
        (*session)->step(1.0 / 60, false);
        const ParticleView view = (*session)->world().particles();
        past[(*session)->time()] = {k, {}, placesOf((*session)->solids())};
        if (k % 4 == 0)  // waits: the frames between are asked for without
            past[(*session)->time()].particles = sorted(device.readAll<vec4>(*view.drawn, view.slots));
        ASSERT_TRUE(LateView::suits(**session));
        const auto shown = late.show(upload, **session);
        ASSERT_TRUE(shown) << shown.error().message;
        ASSERT_TRUE(past.contains(shown->time)) << k;
        const Was& was = past[shown->time];
        EXPECT_LE(k - was.frame, 3U);
        behind += k - was.frame;
        EXPECT_EQ(placesOf(*shown->solids), was.places) << k;
        if (was.particles.empty()) continue;
        std::vector<vec4> drawn(shown->fluid.count);
        glGetNamedBufferSubData(shown->fluid.position, 0, static_cast<GLsizeiptr>(drawn.size() * sizeof(vec4)), drawn.data());
        EXPECT_EQ(sorted(drawn), was.particles) << k;
    }
    EXPECT_GT(behind, 0U);  // else this tested nothing
}

}  // namespace
}  // namespace rivulet::late_view_test
