// Wet surfaces: wet where water is, dry where it is not, drying at the set rate, running down, carried along by their solid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/sim/solids/body_shapes.h"
#include "tests/physics/baked_mesh.h"
#include "tests/physics/worlds.h"

namespace rivulet::wetness_test {
namespace {

constexpr float kSpacing = 0.05F;

// A pool, 0.3 m deep.
FluidParams pool() {
    FluidParams p{.method = "pbf"};
    p.spacing = kSpacing;
    p.box.max = vec3(0.5F, 1.8F, 0.5F);
    p.blocks = {{vec3(0.0F), vec3(0.5F, 0.3F, 0.5F), vec3(0.0F)}};
    p.blocks[0].cut = true;
    p.wetness.on = true;
    p.wetness.dries = 2;
    p.wetness.runs = 0;
    return p;
}

// A box of 0.2 x 0.4 x 0.2 m about its own origin.
const VoxelField& pillar() {
    static const VoxelField field = test::baked(test::makeBox(vec3(-0.1F, -0.2F, -0.1F), vec3(0.1F, 0.2F, 0.1F)), 0.02F, kSpacing);
    return field;
}
constexpr vec3 kInPool{0.25F, 0.35F, 0.25F};

std::vector<float> wetness(FluidWorld& world) {
    const WetnessView view = world.wetness();
    return world.device().readAll<float>(*view.values, view.surface->points.size());
}

// m, own frame.
vec3 placeOf(const FluidWorld& world, size_t point) { return vec3(world.wetness().surface->points[point].place); }

void run(FluidWorld& world, double seconds) {
    for (int k = 0; k < static_cast<int>(std::lround(60 * seconds)); ++k) world.step({}, 1.0 / 60);
}

// The heights (m) of the highest and of the middle particle of the top layer.
struct Level {
    float highest = 0, middle = 0;
};
Level level(FluidWorld& world) {
    std::vector<float> heights;
    for (const vec4& x : world.device().readAll<vec4>(*world.particles().position, world.particles().count)) heights.push_back(x.y);
    std::ranges::sort(heights);
    return {heights.back(), heights[heights.size() - heights.size() / 12]};
}

// Sets the wetness of all points, by a state that is saved and restored.
template <class Of>
void set(FluidWorld& world, const Of& of) {
    WorldState saved, state;
    world.save(saved);
    for (const auto& [name, bytes] : saved.sections())
        if (name != "wetness.points") state.putBytes(name, bytes);
    std::vector<float> values(world.wetness().surface->points.size());
    for (size_t k = 0; k < values.size(); ++k) values[k] = of(placeOf(world, k));
    state.put<float>("wetness.points", values);
    const Status restored = world.restore(state);
    ASSERT_TRUE(restored) << restored.error().message;
}

// Every part of the surface of a pillar that stands in a pool is wet up to the water's surface, and no part above it, within a spacing.
TEST(Wetness, IsWhereTheWaterIs) {
    auto device = cpu();
    auto world = makeWorld(*device, pool(), {.rigid = {{&pillar(), {kInPool}}}});
    ASSERT_TRUE(world);
    float highest = 0;  // at any time
    for (int k = 0; k < 30; ++k) {
        run(*world, 1.0 / 60);
        highest = std::max(highest, level(*world).highest);
    }
    const float surface = level(*world).middle + 0.5F * kSpacing;
    const std::vector<float> wet = wetness(*world);
    size_t below = 0, above = 0;
    for (size_t k = 0; k < wet.size(); ++k) {
        const float y = placeOf(*world, k).y + kInPool.y;
        if (y < surface - kSpacing) {
            EXPECT_GT(wet[k], 0.9F) << "at " << y << " m, below a surface at " << surface;
            ++below;
        } else if (y > highest + 1.4F * kSpacing) {
            EXPECT_EQ(wet[k], 0.0F) << "at " << y << " m, and no particle was above " << highest;
            ++above;
        }
    }
    EXPECT_GT(below, 100U);
    EXPECT_GT(above, 100U);
    EXPECT_LT(highest, surface + kSpacing);
}

// A pillar that leaves the water takes its wetness along, in its own frame, however it turns; there it falls as exp(-t / dries).
TEST(Wetness, LeavesWithItsSolidAndDries) {
    auto device = cpu();
    FluidParams p = pool();
    auto world = makeWorld(*device, p, {.rigid = {{&pillar(), {kInPool}}}});
    ASSERT_TRUE(world);
    run(*world, 0.1);
    const std::vector<float> under = wetness(*world);
    Pose pose{kInPool};
    for (int k = 0; k < 30; ++k) {
        pose.position.y += 0.9F / 30;
        pose.rotation = glm::angleAxis(3.1F * static_cast<float>(k) / 30, glm::normalize(vec3(1, 0.2F, 0.3F)));
        world->step({.poses = std::span(&pose, 1)}, 1.0 / 60);
    }
    run(*world, 0.5);  // what it shed has fallen
    const std::vector<float> out = wetness(*world);
    double wetThen = 0, wetNow = 0;
    for (size_t k = 0; k < out.size(); ++k) {
        if (under[k] == 1 && placeOf(*world, k).y < -0.1F) ++wetThen;
        if (under[k] == 1 && placeOf(*world, k).y < -0.1F && out[k] > 0.3F) ++wetNow;
    }
    EXPECT_GT(wetThen, 50);
    EXPECT_EQ(wetNow, wetThen);
    run(*world, 0.5);
    const std::vector<float> later = wetness(*world);
    const auto kept = static_cast<float>(std::exp(-0.5 / double{p.wetness.dries}));
    for (size_t k = 0; k < out.size(); ++k) EXPECT_NEAR(later[k], kept * out[k], 1.0e-5F);
}

// Of a wet band around a pillar water runs down its sides, as far as fluid.wetness.runs says, and none runs up; upside down likewise.
TEST(Wetness, RunsDown) {
    for (const float turn : {0.0F, kPi}) {
        auto device = cpu();
        FluidParams p = pool();
        p.blocks = {{vec3(0.0F), vec3(0.1F), vec3(0.0F)}};  // far below
        p.wetness.dries = 1000;
        p.wetness.runs = 0.08F;
        const Pose pose{vec3(0.25F, 1.0F, 0.25F), glm::angleAxis(turn, vec3(1, 0, 0))};
        auto world = makeWorld(*device, p, {.rigid = {{&pillar(), pose}}});
        ASSERT_TRUE(world);
        const auto height = [&](const vec3& own) { return (pose.rotation * own).y; };
        set(*world, [&](const vec3& own) { return height(own) > 0.1F && height(own) < 0.15F ? 1.0F : 0.0F; });
        run(*world, 5);
        const std::vector<float> wet = wetness(*world);
        const auto mean = [&](float from, float to) {
            double sum = 0, count = 0;
            for (size_t k = 0; k < wet.size(); ++k) {
                const vec3 own = placeOf(*world, k);
                if (std::max(std::abs(own.x), std::abs(own.z)) < 0.099F || height(own) < from || height(own) > to) continue;
                sum += double{wet[k]};
                ++count;
            }
            EXPECT_GT(count, 10);
            return sum / count;
        };
        const double cell = double{world->wetness().surface->solids[0].cell};
        EXPECT_LT(mean(0.15F + static_cast<float>(cell), 0.21F), 1.0e-6);
        EXPECT_GT(mean(0.05F, 0.1F), 0.5);
        EXPECT_GT(mean(-0.03F, 0.0F), 0.15);
        // Over 0.08 m it falls to 1/e, and a little less than that by the size of its cells.
        EXPECT_NEAR(mean(-0.08F, -0.03F) / mean(0.0F, 0.05F), std::exp(-1.0), 0.08);
    }
}

// A box that floats is wet below and dry above, in its own frame.
TEST(Wetness, OfABodyThatFloats) {
    auto device = cpu();
    Body body{boxShape(vec3(0.25F), 500, kSpacing), {{vec3(0.25F, 0.31F, 0.25F)}}};
    auto world = makeWorld(*device, pool(), {.bodies = {body}});
    ASSERT_TRUE(world);
    ASSERT_EQ(world->wetness().surface->solids.size(), 1U);
    run(*world, 1.0);
    const std::vector<float> wet = wetness(*world);
    double bottom = 0, top = 0, bottoms = 0, tops = 0;
    for (size_t k = 0; k < wet.size(); ++k) {
        const float y = placeOf(*world, k).y;
        if (y < -0.12F) bottom += double{wet[k]}, ++bottoms;
        if (y > 0.12F) top += double{wet[k]}, ++tops;
    }
    EXPECT_GT(bottom / bottoms, 0.95);
    EXPECT_LT(top / tops, 0.05);
}

// Points on the surface of bodies: at no distance from it, everywhere, with normals that point out.
TEST(Wetness, ShellsCoverTheirBodies) {
    Result<MeshBody> ball = meshShape(test::makeSphere(vec3(0.3F), 0.1F).view(), 1000, kSpacing);
    ASSERT_TRUE(ball);
    for (const BodyShape& shape : {boxShape(vec3(0.2F, 0.1F, 0.3F), 1000, kSpacing), sphereShape(0.1F, 1000, kSpacing), ball->shape}) {
        const float apart = 0.01F;
        const std::vector<ShellPoint> shell = shape.shell(apart);
        for (size_t k = 0; k < shell.size(); k += 7) {
            EXPECT_NEAR(shape.distance(shell[k].place), 0.0F, 1.0e-5F);
            EXPECT_NEAR(shape.distance(shell[k].place + 0.01F * shell[k].normal), 0.01F, 1.0e-3F);
        }
        // No sample of the body is further from its shell than it lies deep, and a point's reach.
        for (const vec3& sample : shape.samples) {
            float nearest = 1;
            for (const ShellPoint& p : shell) nearest = std::min(nearest, glm::distance(p.place, sample));
            EXPECT_LT(nearest, std::hypot(0.5F * kSpacing, apart));
        }
    }
}

// Between two points of the surface the wetness is between theirs, off the surface there is none.
TEST(Wetness, IsContinuousBetweenPoints) {
    const VoxelField& field = pillar();
    const WetSurface surface = WetSurface::of({.field = &field}, kSpacing);
    std::vector<float> heights(surface.points.size());
    for (size_t k = 0; k < heights.size(); ++k) heights[k] = surface.points[k].place.y;
    const float cell = surface.solids[0].cell;
    float before = surface.at(heights, 0, vec3(0.1F, -0.19F, 0.03F));
    for (float y = -0.19F; y < 0.19F; y += 0.001F) {
        const float here = surface.at(heights, 0, vec3(0.1F, y, 0.03F));
        EXPECT_NEAR(here, y, cell);
        EXPECT_LT(std::abs(here - before), 0.004F);
        before = here;
    }
    EXPECT_EQ(surface.at(heights, 0, vec3(0.0F)), 0.0F);
    EXPECT_EQ(surface.at(heights, 0, vec3(9.0F)), 0.0F);
    EXPECT_EQ(surface.at(heights, 0, vec3(std::nanf(""))), 0.0F);
}

// A world that is saved and restored has the same wetness, and goes on with it bit for bit; one that starts anew is dry.
TEST(Wetness, IsSavedAndRestored) {
    auto device = cpu();
    FluidParams p = pool();
    p.wetness.runs = 0.05F;
    const Solids solids{.rigid = {{&pillar(), {kInPool}}}};
    auto a = makeWorld(*device, p, solids), b = makeWorld(*device, p, solids);
    ASSERT_TRUE(a && b);
    run(*a, 0.2);
    WorldState state;
    a->save(state);
    ASSERT_TRUE(b->restore(state));
    EXPECT_EQ(wetness(*a), wetness(*b));
    run(*a, 0.2);
    run(*b, 0.2);
    EXPECT_EQ(wetness(*a), wetness(*b));
    EXPECT_GT(std::ranges::max(wetness(*a)), 0.9F);
    a->reset();
    EXPECT_EQ(std::ranges::max(wetness(*a)), 0.0F);
}

// Without fluid.wetness.on there is no buffer, no memory and no kernel of it; and the water moves the same with it.
TEST(Wetness, CostsNothingWhenItIsOff) {
    std::vector<vec4> positions[2];
    size_t bytes[2] = {};
    for (const bool on : {false, true}) {
        auto device = cpu();
        FluidParams p = pool();
        p.wetness.on = on;
        auto world = makeWorld(*device, p, {.rigid = {{&pillar(), {kInPool}}}});
        ASSERT_TRUE(world);
        bytes[on ? 1 : 0] = device->bytesAllocated();
        run(*world, 0.1);
        positions[on ? 1 : 0] = device->readAll<vec4>(*world->particles().position, world->particles().count);
        const std::vector<std::string> kernels = device->kernels();
        EXPECT_EQ(std::ranges::count_if(kernels,
                                        [](const std::string& k) { return k.starts_with("fluid/solids/wet;") || k == "fluid/solids/wet"; }),
                  on ? 1 : 0);
        EXPECT_EQ(world->wetness().surface != nullptr, on);
        EXPECT_EQ(world->wetness().values != nullptr, on);
        if (!on) continue;
        const WetSurface& surface = *world->wetness().surface;
        EXPECT_EQ(bytes[1] - bytes[0],
                  surface.points.size() * (2 * sizeof(vec4) + 2 * sizeof(float)) + surface.cells.size() * sizeof(int32_t));
    }
    EXPECT_EQ(positions[0], positions[1]);
}

}  // namespace
}  // namespace rivulet::wetness_test
