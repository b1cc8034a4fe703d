// What a window shows of a world on OpenCL that shares no memory with OpenGL: a state that was, whole, and not older than three frames.
#include "fluid/session/late_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <string>
#include <tuple>

#include "engine/gpu/buffer.h"
#include "fluid/scene/collider_motion.h"
#include "fluid/session/session.h"
#include "shaders/fluid/solids/body_state.h"
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

// Shows a session on cl as the window does. In every third frame the exact state is read, too, with a wait: `compare` receives it together
// with the picture of the same time.
template <class State>
void showLate(const SceneFile& scene, size_t frames, State (*exactOf)(const Session&),
              void (*compare)(const LateView::Shown& shown, const State& exact)) {
    Result<TestGpu> cl = makeTestGpu("cl");
    if (!cl) GTEST_SKIP() << cl.error().message;
    const auto session = Session::create(scene, *cl->device, {});
    ASSERT_TRUE(session) << session.error().message;
    std::map<double, State> past;
    FluidUpload upload;
    LateView late;
    size_t compared = 0, behind = 0;
    for (size_t k = 0; k < frames; ++k) {
        (*session)->step(1.0 / 60, false);
        if (k % 3 == 0) past[(*session)->time()] = exactOf(**session);
        const auto shown = late.show(upload, **session);
        ASSERT_TRUE(shown) << shown.error().message;
        behind += shown->time < (*session)->time() ? 1 : 0;
        if (!past.contains(shown->time)) continue;
        ++compared;
        compare(*shown, past[shown->time]);
    }
    EXPECT_GT(behind, 0U);
    EXPECT_GT(compared, 2U);
}

// A ball falls 0.5 m into a pool: it is drawn where the device had it, whatever the host expected.
TEST_F(LateViewTest, BodiesAreWhereTheyWereAtThatTime) {
    const std::string path = testing::TempDir() + "late_view_ball.json";
    std::ofstream(path) << R"({"name": "ball", "doc": "", "fluid": {"method": "pbf", "spacing": 0.08,
        "box": {"max": [1.6, 2, 1.6]}, "blocks": [{"max": [1.6, 0.64, 1.6]}]},
        "bodies": [{"shape": "sphere", "radius": 0.12, "density": 400, "position": [0.8, 1.26, 0.8], "spin": [90, 0, 0]}]})";
    const Result<SceneFile> scene = loadScene(path, {});
    ASSERT_TRUE(scene) << scene.error().message;
    showLate<mat4>(
        *scene, 27,
        [](const Session& session) {
            const BodyRows rows = session.world().bodyRows();
            EXPECT_TRUE(rows.current);
            const DeviceBody body = session.world().device().readAll<DeviceBody>(*rows.rows, 1)[0];
            const vec4& q = body.rotation;
            return matrixOf({vec3(body.position), quat(q.w, q.x, q.y, q.z)});
        },
        [](const LateView::Shown& shown, const mat4& exact) {
            for (const Node& node : shown.solids->nodes())
                if (node.body == 0) EXPECT_EQ(node.local, exact) << shown.time;
        });
}

// A session of one ball follows on one of two, at the same time and on the same device, while a picture of both balls is on its way: the
// ball of which it has no state stays where it was expected.
TEST_F(LateViewTest, ABodyThatTheNextSessionLacksStays) {
    Result<TestGpu> cl = makeTestGpu("cl");
    if (!cl) GTEST_SKIP() << cl.error().message;
    Device& device = *cl->device;
    const auto sessionOf = [&](const std::string& bodies) {
        const std::string path = testing::TempDir() + "late_view_balls.json";
        std::ofstream(path) << R"({"name": "balls", "doc": "", "fluid": {"method": "pbf", "spacing": 0.08,
            "box": {"max": [1.6, 2, 1.6]}, "blocks": [{"max": [1.6, 0.64, 1.6]}]}, "bodies": [)"
                            << bodies << "]}";
        const Result<SceneFile> scene = loadScene(path, {});
        EXPECT_TRUE(scene) << scene.error().message;
        auto session = Session::create(*scene, device, {});
        EXPECT_TRUE(session) << session.error().message;
        return std::move(*session);
    };
    const std::string first = R"({"shape": "sphere", "radius": 0.12, "density": 400, "position": [0.5, 1.26, 0.8]})";
    const std::string second = R"({"shape": "sphere", "radius": 0.12, "density": 400, "position": [1.1, 1.26, 0.8]})";
    const auto both = sessionOf(first + ", " + second), one = sessionOf(first);
    constexpr size_t kBytes = size_t{64} << 20;
    Result<Buffer> from = device.allocate(kBytes), to = device.allocate(kBytes);
    ASSERT_TRUE(from && to);
    device.fill(*from, 0);
    const auto workLong = [&] {  // what is read behind it arrives later
        for (int k = 0; k < 8; ++k) device.copy(*from, *to, kBytes);
    };
    const auto placeOf = [](const Scene& solids, int body) {
        const auto node = std::ranges::find(solids.nodes(), body, &Node::body);
        return node == solids.nodes().end() ? mat4(0.0F) : node->local;
    };
    FluidUpload upload;
    LateView late;
    for (int k = 0; k < 7; ++k) {
        for (Session* session : {both.get(), one.get()}) session->step(1.0 / 60, false);
        if (k == 6) workLong();
        const auto shown = late.show(upload, *both);
        ASSERT_TRUE(shown) << shown.error().message;
        if (k == 6) ASSERT_LT(shown->time, both->time());
        if (k == 5) device.finish(), device.poll();
    }
    device.finish();
    device.poll();
    const mat4 expected = placeOf(both->solids(), 1);
    ASSERT_EQ(one->world().bodiesAt(both->time()).value().size(), 1U);
    workLong();
    const auto shown = late.show(upload, *one);
    ASSERT_TRUE(shown) << shown.error().message;
    ASSERT_EQ(shown->time, both->time());
    ASSERT_EQ(std::ranges::count_if(shown->solids->nodes(), [](const Node& n) { return n.body >= 0; }), 2);
    EXPECT_EQ(placeOf(*shown->solids, 1), expected);
}

// A head that speaks: its vertices are those of the time that is shown.
TEST_F(LateViewTest, MeshesHaveTheShapeOfThatTime) {
    const Result<SceneFile> scene =
        loadScene(RIVULET_SOURCE_DIR "/assets/scenes/crying.json", std::vector<std::string>{"flow.0.mapSize=256"});
    ASSERT_TRUE(scene) << scene.error().message;
    using Shapes = std::vector<std::vector<vec4>>;
    showLate<Shapes>(
        *scene, 12,
        [](const Session& session) {
            Shapes all;
            for (const Node& node : session.solids().nodes())
                if (node.deformer)
                    all.push_back(node.deformer->device().readAll<vec4>(node.deformer->positions(), node.deformer->vertices()));
            EXPECT_FALSE(all.empty());
            return all;
        },
        [](const LateView::Shown& shown, const Shapes& exact) {
            size_t at = 0;
            for (const Node& node : shown.solids->nodes())
                if (node.deformed) EXPECT_EQ(node.deformed->positions, exact.at(at++)) << shown.time;
            EXPECT_EQ(at, exact.size());
        });
}

}  // namespace
}  // namespace rivulet::late_view_test
