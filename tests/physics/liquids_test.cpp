// Liquids: the table, and two of them in one world against hydrostatics.
#include "fluid/sim/sources/liquids.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "fluid/sim/world/fluid_world.h"
#include "tests/parity/devices.h"

namespace rivulet::liquids_test {
namespace {

constexpr double kFrame = 1.0 / 60;

// Two blocks side by side, from wall to wall: the world's liquid on the left and `right` on the right.
FluidParams sideBySide(const char* method, float ownDensity, const char* right, float spacing = 0.02F) {
    FluidParams p;
    p.method = method;
    p.spacing = spacing;
    p.box.max = vec3(0.24F, 0.4F, 0.12F);
    p.restDensity = ownDensity;
    p.viscosity = 1.0e-3F;
    BlockParams a, b;
    a.max = vec3(0.12F, 0.2F, 0.12F);
    b.min = vec3(0.12F, 0.0F, 0.0F);
    b.max = vec3(0.24F, 0.2F, 0.12F);
    b.liquid = right;
    p.blocks = {a, b};
    return p;
}

std::unique_ptr<FluidWorld> make(Device& device, const FluidParams& params, const Sources& sources = {}) {
    auto world = FluidWorld::create(device, params, {}, {}, sources);
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    return world ? std::move(*world) : nullptr;
}

// Mean height of the particles of a liquid, by its row in matterOf; m.
struct Heights {
    double own = 0, other = 0;
    bool finite = true;
};
Heights heights(const FluidWorld& world) {
    const ParticleView view = world.particles();
    Device& device = world.device();
    const auto x = device.readAll<vec4>(*view.position, view.count), matter = device.readAll<vec4>(*view.matterOf, view.count);
    const auto id = device.readAll<uint32_t>(*view.id, view.count);
    Heights h;
    double own = 0, other = 0;
    for (size_t i = 0; i < x.size(); ++i) {
        if (x[i].w < 0) continue;
        h.finite = h.finite && isFinite(vec3(x[i]));
        const bool isOwn = matter[id[i]].w == 0;
        (isOwn ? h.own : h.other) += double{x[i].y};
        (isOwn ? own : other) += 1;
    }
    h.own /= own;
    h.other /= other;
    return h;
}

TEST(Liquids, EveryRowIsCompleteAndNamesItsSource) {
    EXPECT_GE(liquids().rows.size(), 6U);
    for (const LiquidRow& l : liquids().rows) {
        EXPECT_GT(l.density, 500) << l.name;
        EXPECT_LT(l.density, 2000) << l.name;
        EXPECT_GT(l.viscosity, 5.0e-4F) << l.name;
        EXPECT_GT(l.surfaceTension, 0.02F) << l.name;
        EXPECT_LT(l.surfaceTension, 0.08F) << l.name;
        EXPECT_GE(l.refractiveIndex, 1.33F) << l.name;
        EXPECT_GT(std::string(l.source).size(), 20U) << l.name;
        EXPECT_TRUE(glm::all(glm::greaterThan(l.absorption, vec3(0.0F)))) << l.name;
        EXPECT_TRUE(glm::all(glm::greaterThan(l.scattering, vec3(0.0F)))) << l.name;
    }
    // Independent of the table: oil floats on water, honey sinks in the sea; honey is the stiffest.
    const auto of = [](const char* name) { return *liquids().find(name); };
    EXPECT_LT(of("oil").density, of("water").density);
    EXPECT_LT(of("water").density, of("seawater").density);
    EXPECT_LT(of("seawater").density, of("blood").density);
    for (const LiquidRow& l : liquids().rows) EXPECT_LE(l.viscosity, of("honey").viscosity);
}

TEST(Liquids, ANamedLiquidSetsDensityAndViscosity) {
    auto device = makeTestCpu();
    FluidParams p{.method = "wcsph"};
    p.restDensity = 7;
    p.liquid = "honey";
    auto world = make(*device, p);
    EXPECT_EQ(world->params().restDensity, 1420.0F);
    EXPECT_NEAR(world->params().viscosity, 10.0 / 1420, 1e-6);
    p.liquid = "mercury";
    const auto wrong = FluidWorld::create(*device, p, {}, {});
    ASSERT_FALSE(wrong);
    EXPECT_NE(wrong.error().message.find("must be one of water, seawater"), std::string::npos) << wrong.error().message;
}

// Side by side at the start. After complete separation, the centre of the oil is 0.1 m above that of the water. With so few particles the
// two stay mixed for long.
TEST(Liquids, OilEndsAboveWater) {
    for (const auto& [method, least] : {std::pair("wcsph", 0.045), std::pair("dfsph", 0.022), std::pair("pbf", 0.045)}) {
        auto device = makeTestCpu();
        FluidParams p = sideBySide(method, 1, "oil", 0.012F);
        p.liquid = "water";
        auto world = make(*device, p);
        for (int k = 0; k < 120; ++k) world->step({.gravity = p.gravity}, kFrame);
        const Heights h = heights(*world);
        ASSERT_TRUE(h.finite) << method;
        EXPECT_GT(h.other - h.own, least) << method;
        EXPECT_EQ(world->stats().lost, 0U) << method;
    }
}

TEST(Liquids, AHundredTimesHeavierOrLighterStaysFiniteAndSeparates) {
    for (const char* method : {"wcsph", "pbf", "dfsph"})
        for (const float own : {9.982F, 99820.0F}) {
            auto device = makeTestCpu();
            FluidParams p = sideBySide(method, own, "water", 0.024F);
            auto world = make(*device, p);
            for (int k = 0; k < 90; ++k) world->step({.gravity = p.gravity}, kFrame);
            const Heights h = heights(*world);
            ASSERT_TRUE(h.finite) << method << own;
            const double above = own < 998 ? h.own - h.other : h.other - h.own;
            EXPECT_GT(above, 0.05) << method << own;
            EXPECT_EQ(world->stats().lost, 0U) << method << own;
            EXPECT_LT(world->stats().maxSpeed, 3.0) << method << own;
        }
}

// Two layers at rest: in each, the pressure gradient is the weight of that liquid.
TEST(Liquids, PressureGrowsByTheWeightOfEachLayer) {
    auto device = makeTestCpu();
    FluidParams p;
    p.method = "wcsph";
    p.spacing = 0.02F;
    p.restDensity = 1000;
    p.soundSpeed = 20;
    p.artificialViscosity = 0.2F;
    p.box.max = vec3(0.2F, 0.5F, 0.2F);
    BlockParams low, high;
    low.max = vec3(0.2F, 0.2F, 0.2F);
    high.min = vec3(0.0F, 0.2F, 0.0F);
    high.max = vec3(0.2F, 0.4F, 0.2F);
    high.liquid = "oil";
    p.blocks = {low, high};
    auto world = make(*device, p);
    for (int k = 0; k < 90; ++k) world->step({.gravity = p.gravity}, kFrame);
    const ParticleView view = world->particles();
    struct Slope {
        double n = 0, y = 0, p = 0, yy = 0, yp = 0;
        double value() const { return (n * yp - y * p) / (n * yy - y * y); }
    } upper, lower;
    // The column still swings up and down as a spring does, with a period of 4 H / c = 0.08 s: the mean over five periods.
    for (int k = 0; k < 24; ++k) {
        world->step({.gravity = p.gravity}, kFrame);
        for (const vec4& x : device->readAll<vec4>(*view.position, view.count)) {
            const double y = double{x.y}, pressure = std::max(20.0 * 20.0 * 1000 / 7 * (std::pow(double{x.w}, 7) - 1), 0.0);  // Tait
            if ((y < 0.03 || y > 0.17) && (y < 0.23 || y > 0.37)) continue;
            Slope& s = y > 0.2 ? upper : lower;
            s.n += 1;
            s.y += y;
            s.p += pressure;
            s.yy += y * y;
            s.yp += y * pressure;
        }
    }
    EXPECT_NEAR(upper.value(), -9.81 * 911, 0.1 * 9810);
    EXPECT_NEAR(lower.value(), -9.81 * 1000, 0.1 * 9810);
}

// Mass, centre of mass and energy use the density of each particle's liquid.
TEST(Liquids, StatisticsUseTheDensityOfEachParticle) {
    auto device = makeTestCpu();
    FluidParams p = sideBySide("wcsph", 1, "honey");
    p.liquid = "water";
    p.gravity = vec3(0.0F);
    for (BlockParams& b : p.blocks) {
        b.velocity = vec3(0, 0.1F, 0);
        b.jitter = 0;
    }
    auto world = make(*device, p);
    world->step({.gravity = vec3(0.0F)}, 1.0e-6);
    const double volume = 0.12 * 0.2 * 0.12, water = volume * 998.2, honey = volume * 1420;
    EXPECT_NEAR(world->stats().centreOfMass[0], (0.06 * water + 0.18 * honey) / (water + honey), 1e-5);
    EXPECT_NEAR(world->stats().kinetic, 0.5 * (water + honey) * 0.01, 1e-3 * water * 0.01);
}

TEST(Liquids, DyeStaysWithItsParticles) {
    auto device = makeTestCpu();
    FluidParams p;
    p.method = "pbf";
    p.spacing = 0.025F;
    BlockParams clear, red;
    clear.max = vec3(0.5F, 0.3F, 0.5F);
    red.min = vec3(0.5F, 0.0F, 0.0F);
    red.max = vec3(1.0F, 0.3F, 0.5F);
    red.dye = vec3(0.8F, 0.1F, 0.1F);
    red.dyeAmount = 10;
    red.dyeScattering = 700;
    p.blocks = {clear, red};
    Emitter green;
    green.params.dye = vec3(0.1F, 0.9F, 0.1F);
    green.params.position = vec3(0.5F, 0.8F, 0.75F);
    auto world = make(*device, p, {.emitters = {green}});
    for (int k = 0; k < 30; ++k) world->step({.gravity = p.gravity}, kFrame);
    const ParticleView view = world->particles();
    EXPECT_EQ(view.matterOf, nullptr) << "dye is no other matter";
    ASSERT_NE(view.absorption, nullptr);
    const auto x = device->readAll<vec4>(*view.position, view.count), a = device->readAll<vec4>(*view.absorption, view.count);
    const auto id = device->readAll<uint32_t>(*view.id, view.count);
    const uint32_t clearOnes = 20 * 12 * 20;
    std::set<int> seen;
    for (size_t i = 0; i < x.size(); ++i) {
        if (x[i].w < 0) continue;
        const int kind = id[i] < clearOnes ? 0 : id[i] < 2 * clearOnes ? 1 : 2;
        seen.insert(kind);
        const vec3 colour = kind == 0 ? vec3(1.0F) : kind == 1 ? red.dye : green.params.dye;
        const float amount = kind == 1 ? 10.0F : 20.0F;
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::exp(-a[i][k] / amount), colour[k], 1e-5);
        EXPECT_EQ(a[i].w, kind == 1 ? 700.0F : 0.0F);
    }
    EXPECT_EQ(seen.size(), 3U);
}

}  // namespace
}  // namespace rivulet::liquids_test
