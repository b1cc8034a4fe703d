// What is drawn of sleeping particles is kept: the picture is as without, and no splat of theirs is drawn again.
#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/compute/device_cpu.h"
#include "engine/core/log.h"
#include "engine/scene/import_model.h"
#include "engine/scene/transform.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/golden/look_fixture.h"

namespace rivulet::look_kept_test {
namespace {

int worstDifference(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
    int worst = a.size() == b.size() ? 0 : 255;
    for (size_t k = 0; k < std::min(a.size(), b.size()); ++k) worst = std::max(worst, std::abs(int{a[k]} - int{b[k]}));
    return worst;
}

// Half floats added in another order, as a picture's 0..255.
constexpr int kRounding = 6;

class LookKept : public LookTest {
  protected:
    void SetUp() override {
        LookTest::SetUp();
        if (IsSkipped()) return;
        settings.fluid.box = {.min = vec3(0.0F), .max = vec3(1.0F, 0.6F, 1.0F)};
        settings.background.showBox = false;
        settings.look.quality = "fine";
        look(vec3(0.5F, 1.2F, 2.2F));
        asleep.spacing = 0.03F;
        for (float x = 0.015F; x < 1.0F; x += 0.03F)
            for (float z = 0.015F; z < 1.0F; z += 0.03F)
                for (float y = 0.015F; y < 0.2F; y += 0.03F) asleep.add(vec3(x, y, z) + 0.005F * random.inCube());
    }
    void look(const vec3& from) {
        camera.position = from;
        camera.target = vec3(0.5F, 0.2F, 0.5F);
        camera.fieldOfView = 40.0F;
        camera.setPlanes(Bounds{vec3(0.0F), vec3(1.0F)});
    }
    // Awake is a ball of water at `at`, above or within what sleeps; and rows that hold no particle.
    void setAwake(const vec3& at, int count = 60) {
        awake = {};
        awake.spacing = asleep.spacing;
        for (int k = 0; k < count; ++k) awake.add(at + 0.08F * random.inCube());
        for (int k = 0; k < 20; ++k) awake.add(vec3(0.5F), -1.0F);
        if (ellipsoids) awake.findEllipsoids();
        if (ellipsoids && asleep.ellipsoids[0].empty()) asleep.findEllipsoids();
    }
    // As a world has it; or `plain`, without what is known of sleep: the same particles, those that sleep before the others, so that half
    // floats are added in the same order.
    FluidView water(bool plain = false) {
        const TestParticles &first = plain ? asleep : awake, &second = plain ? awake : asleep;
        TestParticles all = first;
        all.position.insert(all.position.end(), second.position.begin(), second.position.end());
        for (size_t k = 0; k < 3; ++k) {
            all.ellipsoids[k] = ellipsoids ? first.ellipsoids[k] : std::vector<vec4>();
            if (ellipsoids) all.ellipsoids[k].insert(all.ellipsoids[k].end(), second.ellipsoids[k].begin(), second.ellipsoids[k].end());
        }
        const auto sleeping = static_cast<uint32_t>(asleep.position.size()), others = static_cast<uint32_t>(awake.position.size());
        FluidView view = upload(all);
        view.bounds = Bounds{settings.fluid.box.min, settings.fluid.box.max};
        if (!plain) {
            view.asleep = sleeping;
            view.awake = others - 20;
            view.sleepers = sleepers;
        }
        std::vector<uint32_t> ids;
        for (uint32_t k = 0; k < view.count; ++k) ids.push_back(plain ? k : (k + sleeping) % view.count);
        id = std::move(*gpu::Buffer::from(ids));
        view.id = id.name();
        if (ink) {
            std::vector<vec4> each;
            each.reserve(ids.size());
            for (const uint32_t k : ids) each.emplace_back(0.1F * static_cast<float>(k % 40), 2.0F, 0.5F, 0.3F);
            absorption = std::move(*gpu::Buffer::from(each));
            view.absorption = absorption.name();
        }
        return view;
    }
    // The worst pixel's difference, 0..255, between the picture with what is kept and the plain one.
    int apart() {
        const std::vector<uint8_t> kept = shot(water());
        return worstDifference(kept, shot(water(true)));
    }
    std::vector<uint8_t> shot(const FluidView& fluid) { return picture(camera, width, height, fluid); }
    // Quads drawn for a picture: those of its particles, and some for all its passes; without `photons` none of its caustics.
    // Triangles and points: two a quad.
    uint64_t primitivesOf(const FluidView& fluid, bool photons = false) {
        settings.look.caustics = photons;
        GLuint query = 0;
        glGenQueries(1, &query);
        glBeginQuery(GL_PRIMITIVES_GENERATED, query);
        last = shot(fluid);
        glEndQuery(GL_PRIMITIVES_GENERATED);
        GLuint64 count = 0;
        glGetQueryObjectui64v(query, GL_QUERY_RESULT, &count);
        glDeleteQueries(1, &query);
        settings.look.caustics = true;
        return count;
    }
    // Draws it some times with the ball on its way, then without it.
    void expectSame(const char* what) {
        for (int k = 0; k < 4; ++k) {
            setAwake(vec3(0.4F + 0.05F * static_cast<float>(k), 0.25F, 0.6F));
            EXPECT_EQ(apart(), 0) << what << ", frame " << k;
        }
        setAwake(vec3(0.0F), 0);
        for (int k = 0; k < 4; ++k) EXPECT_EQ(apart(), 0) << what << ", at rest, frame " << k;
    }

    int width = 320, height = 180;
    Camera camera;
    TestParticles asleep, awake;
    TestRandom random;
    bool ellipsoids = false, ink = false;
    std::shared_ptr<const void> sleepers = std::make_shared<int>();
    gpu::Buffer absorption, id;
    std::vector<uint8_t> last;
};

TEST_F(LookKept, thePictureIsTheSame) {
    expectSame("spheres");
    ink = true;
    expectSame("ink");
    ink = false;
    settings.look.quality = "fast";
    expectSame("fast");
    settings.look.quality = "fine";
    ellipsoids = true;
    for (const char* view : {"water", "thickness", "depth", "spheres"}) {
        settings.look.view = view;
        expectSame(view);
    }
}

TEST_F(LookKept, whateverChangesIsDrawn) {
    expectSame("at first");
    look(vec3(0.2F, 1.0F, 2.3F));
    expectSame("camera");
    width = 250;
    height = 190;
    expectSame("size");
    settings.look.filter = "bilateral";
    expectSame("filter");
    settings.look.smoothing = 0.1F;
    expectSame("smoothing");
    settings.look.absorption = vec3(20.0F, 3.0F, 1.0F);
    expectSame("absorption");
    settings.light.direction = vec3(0.7F, 1.0F, 0.1F);
    expectSame("light");
    settings.fluid.box.max.x = 0.8F;
    expectSame("box");
    for (vec4& p : asleep.position) p.y += 0.05F * std::sin(8.0F * p.x);
    sleepers = std::make_shared<int>();
    expectSame("particles");
}

// The thickness is cut at the scene, which a host moves as it likes.
TEST_F(LookKept, theSceneMayMoveInTheWater) {
    Node node;
    Result<Mesh> mesh = importMesh(std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/spot.obj");
    ASSERT_TRUE(mesh) << mesh.error().message;
    const Bounds size = mesh->bounds();
    node.mesh = std::make_shared<const Mesh>(std::move(*mesh));
    scene.add(std::move(node));
    for (int k = 0; k < 6; ++k) {
        const int place = k / 2;
        scene.nodes()[0].local = Transform::fitted(size, 0.4F, vec3(0.3F + 0.06F * static_cast<float>(place), 0.12F, 0.7F), vec3(0.0F));
        setAwake(vec3(0.0F), 0);
        EXPECT_EQ(apart(), 0) << k;
    }
}

TEST_F(LookKept, eachViewKeepsItsOwn) {
    setAwake(vec3(0.5F, 0.3F, 0.5F));
    for (int k = 0; k < 4; ++k)
        for (const float eye : {-0.03F, 0.03F}) {
            look(vec3(0.5F + eye, 1.2F, 2.2F));
            EXPECT_EQ(apart(), 0) << k;
            if (k > 1) EXPECT_LT(primitivesOf(water()), 2 * asleep.position.size()) << k;
        }
}

TEST_F(LookKept, noSplatOfASleeperIsDrawnAgain) {
    setAwake(vec3(0.5F, 0.3F, 0.5F));
    const FluidView plain = water(true);
    // Points for occluders, depth, thickness, spray and the light; the rest is for the picture.
    constexpr uint64_t kEach = 5;
    const uint64_t all = primitivesOf(plain), others = all - kEach * plain.count;
    ASSERT_LT(others, 2 * plain.count);
    constexpr uint64_t kTiles = 400;  // of the pass that looks for a change of the scene
    const FluidView some = water();
    for (int k = 0; k < 3; ++k) (void)shot(some);
    EXPECT_LE(primitivesOf(some), others + kEach * some.awake + kTiles);
    EXPECT_GE(primitivesOf(some), kEach * some.awake);
    setAwake(vec3(0.0F), 0);
    const FluidView still = water();
    for (int k = 0; k < 3; ++k) (void)shot(still);
    EXPECT_LE(primitivesOf(still), others + kTiles);
    EXPECT_LE(primitivesOf(still, true), others + kTiles) << "photons are kept as well";
    // A camera that moves draws all, but for the light's map of the water.
    look(vec3(0.2F, 1.0F, 2.3F));
    const uint64_t moved = primitivesOf(still);
    EXPECT_GE(moved, 3 * still.asleep);
    EXPECT_LE(moved, others + 3 * still.asleep + kTiles);
}

// A pool that settles, and then wakes again under a jet.
class UploadOfSleepers : public LookKept, public testing::WithParamInterface<float> {};
INSTANTIATE_TEST_SUITE_P(FixedSteps, UploadOfSleepers, testing::Values(0.0F, 1.0F / 90, 1.0F / 24));

TEST_P(UploadOfSleepers, HasWhatTheWorldHasAndCopiesWhatMoves) {
    const std::unique_ptr<Device> device = makeCpuDevice(cpuKernels(), {});
    FluidParams p;
    p.method = "dfsph";
    p.spacing = 0.02F;
    p.sleep.on = true;
    p.ellipsoids = true;
    p.fixedStep = GetParam();
    p.box.max = vec3(1.2F, 0.3F, 0.1F);
    p.blocks = {{.min = vec3(0.0F), .max = vec3(1.2F, 0.1F, 0.1F)}};
    Sources jet;
    jet.emitters = {{.params = {.litresPerSecond = 0.0F, .position = vec3(0.1F, 0.2F, 0.05F), .radius = 0.02F}, .triangles = {}}};
    jet.seconds = 2;
    Result<std::unique_ptr<FluidWorld>> made = FluidWorld::create(*device, p, {}, stderrLog(LogLevel::error), jet);
    ASSERT_TRUE(made) << made.error().message;
    FluidWorld& world = **made;
    settings.fluid.box.min = p.box.min;
    settings.fluid.box.max = p.box.max;
    FluidUpload upload;
    FluidLookParams looks = settings.look;
    looks.quality = "auto";
    FluidView shown;
    int whole = 0, mixed = 0, frames = 0;
    const auto frame = [&] {
        world.step({}, 1.0 / 60);
        const Result<FluidView> view = upload.view(world, looks);
        ASSERT_TRUE(view) << view.error().message;
        const ParticleView truth = world.particles();
        const auto id = device->readAll<uint32_t>(*truth.id, truth.slots);
        std::vector<uint32_t> idDrawn(view->count);
        glGetNamedBufferSubData(view->id, 0, static_cast<GLsizeiptr>(idDrawn.size() * 4), idDrawn.data());
        for (const auto& [from, name] :
             {std::pair(truth.drawn, view->position), std::pair(truth.velocity, view->velocity),
              std::pair(truth.ellipsoids[0], view->ellipsoids[0]), std::pair(truth.ellipsoids[2], view->ellipsoids[2])}) {
            if (from == nullptr) continue;  // before the first step
            std::vector<vec4> drawn(view->count), a(view->count), b(view->count);
            glGetNamedBufferSubData(name, 0, static_cast<GLsizeiptr>(drawn.size() * sizeof(vec4)), drawn.data());
            const auto now = device->readAll<vec4>(*from, truth.slots);
            for (uint32_t k = 0; k < view->count; ++k) {
                a[id[k]] = now[k];
                b[idDrawn[k]] = drawn[k];
            }
            ASSERT_EQ(a, b) << "frame " << frames;
        }
        const size_t all = size_t{view->count} * ((truth.ellipsoids[0] != nullptr ? 5 : 2) * sizeof(vec4) + 4);
        const size_t bytes = upload.facts().bytes;
        whole += bytes == all ? 1 : 0;
        mixed += bytes < all && view->awake > 0 ? 1 : 0;
        FluidView plain = *view;
        plain.asleep = plain.awake = 0;
        plain.sleepers = nullptr;
        if (frames % 8 == 0) EXPECT_LE(worstDifference(shot(*view), shot(plain)), kRounding) << "frame " << frames;
        shown = *view;
        ++frames;
    };
    look(vec3(0.6F, 0.7F, 1.9F));
    for (int k = 0; k < 600 && world.stats().asleep < world.stats().particles; ++k) frame();
    ASSERT_EQ(world.stats().asleep, world.stats().particles);
    EXPECT_GT(whole, 10);
    for (int k = 0; k < 20; ++k) frame();
    EXPECT_GE(shown.asleep, world.stats().particles);
    EXPECT_EQ(shown.awake, 0U);
    const size_t emptyRows = shown.count - shown.asleep;
    EXPECT_LE(upload.facts().bytes, emptyRows * (5 * sizeof(vec4) + 4)) << "what sleeps is not copied again";
    const std::vector<uint8_t> before = shot(shown);
    const int mixedBefore = mixed;
    for (const float rate : {1.5F, 0.0F}) {
        jet.emitters[0].params.litresPerSecond = rate;
        ASSERT_TRUE(world.setSources(jet));
        for (int k = 0; k < 20; ++k) frame();
        if (rate > 0) EXPECT_GT(worstDifference(before, shot(shown)), 4 * kRounding) << "the jet is seen";
    }
    EXPECT_GT(mixed, mixedBefore) << "some water sleeps beside the jet";
}

}  // namespace
}  // namespace rivulet::look_kept_test
