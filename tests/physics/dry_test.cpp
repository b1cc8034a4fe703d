// Volumes that stay dry: an open boat in waves holds no water and floats as deep as Archimedes says; what comes over its edge is counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/sim/solids/body_shapes.h"
#include "fluid/validate/draught.h"
#include "tests/physics/worlds.h"

namespace rivulet::dry_test {
namespace {

constexpr float s = 0.0125F;  // m, spacing

std::vector<vec4> waterOf(const FluidWorld& world) {
    const ParticleView view = world.particles();
    std::vector<vec4> all = world.device().readAll<vec4>(*view.position, view.count);
    std::erase_if(all, [](const vec4& x) { return x.w < 0; });
    return all;
}

// Of a box that has turned and moved.
size_t inside(std::span<const vec4> water, const Pose& pose, const vec3& size) {
    return static_cast<size_t>(std::ranges::count_if(
        water, [&](const vec4& x) { return glm::all(glm::lessThan(glm::abs(pose.toOwn(vec3(x))), 0.4999F * size)); }));
}

// An open box, 18 by 8 by 14 spacings, with walls and a floor two spacings thick: a sample on each site of a lattice.
constexpr int kLong = 18, kHigh = 8, kWide = 14, kWall = 2;
const vec3 kSize = s * vec3(kLong, kHigh, kWide), kCavity = kSize - s * vec3(2 * kWall, kWall, 2 * kWall),
           kMiddle(0.0F, 0.5F * s * kWall, 0.0F);  // of the cavity, from that of the hull

BodyShape hull(double mass) {
    BodyShape shape = boxShape(kSize, mass / double{kSize.x * kSize.y * kSize.z}, s);
    shape.samples.clear();
    for (int x = 0; x < kLong; ++x)
        for (int y = 0; y < kHigh; ++y)
            for (int z = 0; z < kWide; ++z)
                if (std::min({x, kLong - 1 - x, y, z, kWide - 1 - z}) < kWall)
                    shape.samples.push_back(s * (vec3(x, y, z) + 0.5F) - 0.5F * kSize);
    shape.distance = [](const vec3& p) {
        const vec3 outer = glm::abs(p) - 0.5F * kSize, own = p - kMiddle, inner = glm::abs(own) - 0.5F * kCavity;
        return std::max(std::max({outer.x, outer.y, outer.z}), -std::max({inner.x, -own.y - 0.5F * kCavity.y, inner.z}));
    };
    return shape;
}

struct Voyage {
    double draught = 0, tilt = 0;   // m below the level, mean of the last frames; 1 - cos
    size_t most = 0, last = 0;      // particles in the cavity
    double drained = 0, error = 0;  // m^3; of the ledger
    float farthest = 0;             // m, of the boat from its start
};

constexpr double kMass = 1000.0 * double{s} * double{s} * double{s} * 1000;  // kg: of 1,000 particles

// Dropped from two spacings above its depth, as waves pass and it rains into it.
Voyage sail(bool dry) {
    const float level = 9 * s;
    FluidParams p;
    p.spacing = s;
    p.box.max = vec3(28 * s, 0.4F, 24 * s);
    p.box.periodicX = p.box.periodicZ = true;
    p.artificialViscosity = 0.05F;
    p.blocks = {{.min = vec3(0.0F), .max = vec3(p.box.max.x, level, p.box.max.z)},
                {.min = vec3(0.0F, level, 0.0F), .max = vec3(4 * s, level + 2 * s, p.box.max.z)}};
    const double draught = kMass / 1000 / (double{kSize.x} * double{kSize.z});
    Body body{.shape = hull(kMass), .state = {}};
    const Pose start{vec3(14 * s, level - static_cast<float>(draught) + 2 * s + 0.5F * kSize.y, 12 * s)};
    body.state.pose = start;
    Voyage v;
    Sources sources;
    sources.seconds = 3;
    if (dry) sources.dry = {{.position = start.toWorld(kMiddle), .size = kCavity, .body = 0}};
    sources.emitters.resize(1);
    EmitterParams& rain = sources.emitters[0].params;
    rain.position = vec3(start.position.x, 0.35F, start.position.z);
    rain.radius = 0.012F;
    rain.litresPerSecond = 0.1F;
    auto device = cpu();
    auto world = FluidWorld::create(*device, p, {.bodies = {body}}, {}, sources);
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    if (!world) return v;
    Floater floater{.height = double{kSize.y}, .volume = double{kSize.x * kSize.y * kSize.z}};
    const double area = double{p.box.max.x * p.box.max.z};
    constexpr int kFrames = 100, kLast = 40;
    for (int frame = 0; frame <= kFrames; ++frame) {
        if (frame > 0) (*world)->step({}, 1.0 / 60);
        const std::vector<vec4> water = waterOf(**world);
        const Pose& now = (*world)->bodies()[0].pose;
        v.last = inside(water, {now.toWorld(kMiddle), now.rotation}, kCavity);
        v.most = std::max(v.most, v.last);
        v.farthest = std::max(v.farthest, glm::length(now.position - start.position));
        if (frame <= kFrames - kLast) continue;
        floater.keel = double{now.position.y - 0.5F * kSize.y};
        const double top = waterLevel(waterVolume(water, double{s}), area, std::span(&floater, 1));
        v.draught += (top - floater.keel) / kLast;
        v.tilt = std::max(v.tilt, 1 - double{(now.rotation * vec3(0, 1, 0)).y});
    }
    const FluidStats& stats = (*world)->stats();
    v.drained = stats.drained;
    v.error = stats.emitted - stats.drained - stats.particles * std::pow(double{s}, 3);
    EXPECT_EQ(stats.lost, 0U);
    std::printf("dry %d: draught %.3f of %.3f spacings, tilt %.1e, inside at most %zu, %zu at the end, drained %.0f particles\n", dry,
                v.draught / double{s}, draught / double{s}, v.tilt, v.most, v.last, v.drained / std::pow(double{s}, 3));
    return v;
}

TEST(Dry, AnOpenBoatFloatsAsDeepAsArchimedesSays) {
    const double expected = kMass / 1000 / double{kSize.x * kSize.z};
    const Voyage v = sail(true);
    EXPECT_EQ(v.most, 0U) << "in any frame, the first included";
    EXPECT_NEAR(v.draught / double{s}, expected / double{s}, 0.4) << "of a spacing, as other floating bodies: the rain has no weight";
    EXPECT_LT(v.tilt, 0.01);
    EXPECT_GT(v.farthest, 0.5F * s) << "waves move it";
    EXPECT_GT(v.drained, 40 * std::pow(double{s}, 3)) << "rain";
    EXPECT_NEAR(v.error, 0, 1.0e-3 * std::pow(double{s}, 3)) << "the ledger adds up";
    const Voyage wet = sail(false);
    EXPECT_GT(wet.last, 10U) << "without the volume the same boat fills";
    EXPECT_GT(wet.draught, v.draught + 0.15 * double{s}) << "and sinks under the weight";
    EXPECT_EQ(wet.drained, 0.0);
}

// A box and an ellipsoid that turn and move through water at rest, set anew for each frame.
TEST(Dry, AVolumeMovesThroughTheWater) {
    for (const char* shape : {"box", "ellipsoid"}) {
        FluidParams p;
        p.spacing = 0.025F;
        p.box.max = vec3(0.8F, 0.6F, 0.4F);
        p.blocks = {{.min = vec3(0.0F), .max = vec3(0.8F, 0.3F, 0.4F)}};
        const auto device = cpu();
        DryParams dry{.shape = shape, .position = vec3(0.2F, 0.2F, 0.2F), .rotation = vec3(0, 0, 30), .size = vec3(0.2F, 0.1F, 0.15F)};
        Sources sources{.dry = {dry}};
        auto world = FluidWorld::create(*device, p, {}, {}, sources);
        ASSERT_TRUE(world) << world.error().message;
        const size_t first = waterOf(**world).size();
        EXPECT_LT(first, 32U * 12 * 16) << "blocks leave the volume out";
        for (int frame = 0; frame < 30; ++frame) {
            sources.dry[0].position.x = 0.2F + 0.01F * static_cast<float>(frame);
            sources.dry[0].rotation.z = 30.0F + 3 * static_cast<float>(frame);
            ASSERT_TRUE((*world)->setSources(sources));
            (*world)->step({}, 1.0 / 60);
            const float angle = glm::radians(sources.dry[0].rotation.z);
            for (const vec4& x : waterOf(**world)) {
                const vec3 d = vec3(x) - sources.dry[0].position;
                const vec3 own = vec3(std::cos(angle) * d.x + std::sin(angle) * d.y, std::cos(angle) * d.y - std::sin(angle) * d.x, d.z) /
                                 (0.5001F * dry.size);
                const bool in = dry.shape == "box" ? glm::all(glm::lessThan(glm::abs(own), vec3(0.999F))) : glm::dot(own, own) < 0.998F;
                ASSERT_FALSE(in) << shape << ", frame " << frame << ": " << x.x << ' ' << x.y << ' ' << x.z;
            }
        }
        const size_t left = waterOf(**world).size();
        EXPECT_LT(left + 100, first);
        EXPECT_NEAR((*world)->stats().drained / std::pow(double{p.spacing}, 3), static_cast<double>(first - left), 0.01);
        ASSERT_TRUE((*world)->setSources({}));
        for (int frame = 0; frame < 30; ++frame) (*world)->step({}, 1.0 / 60);
        EXPECT_EQ(waterOf(**world).size(), left) << "without it none is removed";
        (*world)->reset();
        EXPECT_EQ(waterOf(**world).size(), first);
        EXPECT_EQ((*world)->stats().drained, 0.0);
    }
}

// A volume in a body that was added stays with it, whichever other body goes.
TEST(Dry, AVolumeFollowsItsBodyWhileOthersComeAndGo) {
    FluidParams p;
    p.spacing = 0.05F;
    p.gravity = vec3(0.0F);
    p.maxBodySamples = 1000;
    const auto device = cpu();
    auto made = FluidWorld::create(*device, p, {}, {});
    ASSERT_TRUE(made) << made.error().message;
    FluidWorld& world = **made;
    const auto box = [&](const vec3& at, const vec3& velocity) {
        return Body{.shape = boxShape(vec3(0.2F), 500, p.spacing), .state = {.pose = {.position = at}, .velocity = velocity}};
    };
    const Result<uint32_t> still = world.addBody(box(vec3(0.2F, 0.5F, 0.2F), vec3(0.0F)));
    const Result<uint32_t> moves = world.addBody(box(vec3(0.4F, 0.5F, 0.6F), vec3(0.6F, 0.0F, 0.0F)));
    ASSERT_TRUE(still && moves);
    const vec3 above(0.4F, 0.6F, 0.6F);
    ASSERT_TRUE(world.setSources({.dry = {{.position = above, .size = vec3(0.1F), .body = static_cast<int>(*moves)}}}));
    const Status held = world.removeBody(*moves);
    ASSERT_FALSE(held);
    EXPECT_EQ(held.error().message, "dry[0] moves with body 1: remove the dry volume first");
    ASSERT_TRUE(world.removeBody(*still));
    for (int frame = 0; frame < 15; ++frame) world.step({}, 1.0 / 60);
    EXPECT_NEAR(world.dry()[0].centre.x, above.x + 0.6F * 0.25F, 1.0e-3F);
    EXPECT_NEAR(world.dry()[0].centre.y, above.y, 1.0e-3F);
    ASSERT_TRUE(world.setSources({}));
    EXPECT_TRUE(world.removeBody(*moves));
}

TEST(Dry, IsRefusedInASentence) {
    const auto device = cpu();
    const auto said = [&](const DryParams& dry, size_t count = 1) {
        FluidParams p;
        p.spacing = 0.1F;
        const auto world = FluidWorld::create(*device, p, {}, {}, {.dry = std::vector<DryParams>(count, dry)});
        return world ? std::string() : world.error().message;
    };
    EXPECT_EQ(said({.size = vec3(0.1F)}), "");
    EXPECT_EQ(said({.size = vec3(0.1F, 0, 0.1F)}), "dry[0].size is (0.1, 0, 0.1) m: give three lengths above 0");
    EXPECT_NE(said({.size = vec3(0.1F, -1, 0.1F)}).find("dry[0].size"), std::string::npos);
    EXPECT_NE(said({.shape = "cone", .size = vec3(0.1F)}).find("box"), std::string::npos);
    EXPECT_NE(said({.position = vec3(NAN), .size = vec3(0.1F)}).find("dry[0].position"), std::string::npos);
    EXPECT_EQ(said({.size = vec3(0.1F), .body = 0}), "dry[0].body is 0, and no body has this id: use that of one of the 0 bodies, or -1");
    EXPECT_EQ(said({.size = vec3(0.1F)}, 17), "17 volumes stay dry, and 16 are possible: join some");
}

}  // namespace
}  // namespace rivulet::dry_test
