// Flow on a skin: films, skins that move, brims that fill. Shapes are shared with flow_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "fluid/flow/surface_flow.h"
#include "fluid/validate/physics_case.h"
#include "tests/physics/skins.h"
#include "tests/physics/worlds.h"

namespace rivulet::flow_skin_test {
namespace {

constexpr uint32_t kMicrolitres = 1000000;  // picolitres

// A drop without tangential forces keeps its position in the world while the skin moves below it, by its frame or by its positions.
TEST(FlowOnAMovingSkin, ADropKeepsItsPlaceOverAPlateThatIsPulledAway) {
    for (const bool bends : {false, true}) {
        auto device = cpu();
        const Shape rest = sheetShape(vec3(-0.2F, 0, 0.2F), vec3(0.4F, 0, 0), vec3(0, 0, -0.4F), 16, 16);
        SurfaceFlowParams p;
        p.hold = p.drag = p.airDrag = p.trail = 0;
        SurfaceFlow flow = flowOn(*device, rest, p);
        flow.add(nearestPoint(flow.mesh(), vec3(0.02F, 0, 0.05F)), kMicrolitres);
        SurfaceFlowInputs inputs;
        EXPECT_TRUE(flow.step(inputs, 1.0 / 60));
        std::vector<vec3> moved = rest.positions;
        double x = 0;
        for (int k = 1; k <= 30; ++k) {
            x = -0.5 * 1.0 * std::pow(k / 60.0, 2);  // 1 m/s^2 to the left
            for (size_t i = 0; i < moved.size(); ++i) moved[i] = rest.positions[i] + vec3(static_cast<float>(x), 0, 0);
            if (bends)
                inputs.positions = moved;
            else
                inputs.toWorld[3] = glm::dvec4(x, 0, 0, 1);
            EXPECT_TRUE(flow.step(inputs, 1.0 / 60));
        }
        const SkinDrop d = flow.drops().at(0);
        const double world = double{d.position.x} + (bends ? 0 : x);
        EXPECT_NEAR(world, 0.02, 2e-4) << (bends ? "positions" : "frame") << ": the plate went " << x;
        EXPECT_NEAR(d.velocity.x, 0.5, 0.02);
    }
}

// The pose of the first step is not a motion: drops stay where they were put, though the skin at rest is elsewhere.
TEST(FlowOnAMovingSkin, TheFirstPoseThrowsNoDrops) {
    auto device = cpu();
    const Shape rest = sheetShape(vec3(-0.2F, 0, 0.2F), vec3(0.4F, 0, 0), vec3(0, 0, -0.4F), 16, 16);
    SurfaceFlowParams p;
    p.hold = p.drag = p.airDrag = p.trail = 0;
    SurfaceFlow flow = flowOn(*device, rest, p);
    const SkinPoint at = nearestPoint(flow.mesh(), vec3(0.02F, 0, 0.05F));
    flow.add(at, kMicrolitres);
    std::vector<vec3> moved = rest.positions;
    for (vec3& x : moved) x = vec3(x.z + 0.1F, x.y + 0.02F, -x.x);  // at most 27 m/s in one frame
    for (int k = 0; k < 3; ++k) {
        EXPECT_TRUE(flow.step({.gravity = vec3(0.0F), .positions = moved}, 1.0 / 60));
        const SkinDrop d = flow.drops().at(0);
        EXPECT_EQ(d.at.triangle, at.triangle) << k;
        EXPECT_LT(glm::length(d.velocity), 1e-6F) << k;
        EXPECT_NEAR(d.position.y, 0.02F, 1e-6F);
    }
    // From then on motion acts: the skin is pulled away below the drop.
    for (vec3& x : moved) x.x += 0.01F;
    EXPECT_TRUE(flow.step({.gravity = vec3(0.0F), .positions = moved}, 1.0 / 60));
    EXPECT_NEAR(flow.drops().at(0).velocity.x, -0.6F, 1e-3F);
}

// On a rotating plate a drop moves straight in the world, which is a spiral relative to the plate (centrifugal and Coriolis forces).
TEST(FlowOnAMovingSkin, ADropWithoutRetentionMovesStraightOverARotatingPlate) {
    auto device = cpu();
    const Shape rest = sheetShape(vec3(-0.2F, 0, 0.2F), vec3(0.4F, 0, 0), vec3(0, 0, -0.4F), 16, 16);
    SurfaceFlowParams p;
    p.hold = p.drag = p.airDrag = p.trail = 0;
    SurfaceFlow flow = flowOn(*device, rest, p);
    const double turns = 2.0;  // rad/s
    const dvec3 start(0.08, 0, 0);
    SurfaceFlowInputs inputs;
    const auto pose = [&](double t) {
        const double c = std::cos(turns * t), s = std::sin(turns * t);
        dmat4 m(1.0);
        m[0] = glm::dvec4(c, 0, -s, 0);
        m[2] = glm::dvec4(s, 0, c, 0);
        return m;
    };
    inputs.toWorld = pose(-1.0 / 240);
    EXPECT_TRUE(flow.step(inputs, 1.0 / 240));
    // At rest in the world: relative to the plate it rotates in the opposite direction. A point at x moves with (0, turns, 0) x x.
    flow.add(nearestPoint(flow.mesh(), vec3(start)), kMicrolitres, -vec3(glm::cross(dvec3(0, turns, 0), start)));
    double t = 0;
    for (int k = 0; k < 240; ++k, t += 1.0 / 240) {
        inputs.toWorld = pose(t);
        EXPECT_TRUE(flow.step(inputs, 1.0 / 240));
    }
    const SkinDrop d = flow.drops().at(0);
    const dvec3 world(inputs.toWorld * glm::dvec4(dvec3(d.position), 1));
    // The path of a step uses the plate's old pose, so it is late by the rotation of one step.
    EXPECT_LT(glm::distance(world, start), 0.02 * 0.08 * turns) << world.x << ", " << world.z;
}

// Two equal skins in one mesh, each a slope, a ceiling and a floor that nearly touch. The second one moves far away from the box that the
// mesh has at rest: drops there merge, touch facing skin and leave as those on the first.
TEST(FlowOnAMovingSkin, DropsBehaveTheSameFarFromTheRestPose) {
    for (const vec3& away : {vec3(0.0F, 0.31F, 0.0F), vec3(4.0F, -2.0F, 8.0F), vec3(-16.0F, 4.0F, -8.0F)}) {
        auto device = cpu();
        Shape both;
        for (const float side : {0.0F, 0.5F})
            for (const Shape& part : {sheetShape(vec3(side, 0.2F, 0), vec3(0.1F, 0, 0), vec3(0, -0.1F, 0.02F), 20, 20),
                                      sheetShape(vec3(side + 0.2F, 0.0008F, 0), vec3(0.04F, 0, 0), vec3(0, 0, 0.04F), 20, 20),
                                      sheetShape(vec3(side + 0.2F, 0, 0.04F), vec3(0.04F, 0, 0), vec3(0, 0, -0.04F), 20, 20)}) {
                for (const uint32_t i : part.indices) both.indices.push_back(static_cast<uint32_t>(both.positions.size()) + i);
                both.positions.insert(both.positions.end(), part.positions.begin(), part.positions.end());
            }
        SurfaceFlowParams p;
        p.pearls = false;
        SurfaceFlow flow = flowOn(*device, both, p);
        const auto half = static_cast<uint32_t>(flow.mesh().triangleCount() / 2);
        std::mt19937 random(5);
        std::uniform_real_distribution<float> any(0.0F, 1.0F);
        std::uniform_int_distribution<uint32_t> volume(2 * kMicrolitres, 5 * kMicrolitres);
        uint64_t added = 0;
        const auto drip = [&](const vec3& x, uint32_t picolitres) {
            const SkinPoint at = nearestPoint(flow.mesh(), x);
            flow.add(at, picolitres);
            flow.add({at.triangle + half, at.b1, at.b2}, picolitres);
            added += picolitres;
        };
        drip(vec3(0.22F, 0.0008F, 0.02F), 6 * kMicrolitres);
        for (int k = 0; k < 120; ++k) drip(vec3(0.1F * any(random), 0.2F - 0.1F * any(random), 0), volume(random));
        std::vector<vec3> moved = both.positions;
        for (size_t i = moved.size() / 2; i < moved.size(); ++i) moved[i] += away;
        uint64_t left[2] = {};
        for (int k = 0; k < 90; ++k) {
            EXPECT_TRUE(flow.step({.positions = moved}, 1.0 / 60));
            for (const LeftDrop& d : flow.takeLeft()) left[d.triangle < half ? 0 : 1] += d.picolitres;
        }
        const SurfaceFlow::Ledger l = flow.ledger();
        EXPECT_EQ(l.added, 2 * added);
        EXPECT_EQ(l.added, l.drops + l.film + l.left + l.evaporated + l.refused);
        EXPECT_GT(l.merges, 60U) << away.x;
        EXPECT_GT(left[0], 0U);
        EXPECT_NEAR(static_cast<double>(left[1]), static_cast<double>(left[0]), 0.01 * static_cast<double>(left[0]));
        std::vector<SkinDrop> here, there;
        for (const SkinDrop& d : flow.drops()) (d.at.triangle < half ? here : there).push_back(d);
        EXPECT_GT(here.size(), 5U);
        EXPECT_NEAR(static_cast<double>(there.size()), static_cast<double>(here.size()), 0.05 * static_cast<double>(here.size())) << away.x;
        const vec3 apart = away + vec3(0.5F, 0, 0);
        // Floats are coarser far away: here and there a drop just misses another.
        size_t same = 0;
        for (const SkinDrop& d : here)
            same += std::any_of(there.begin(), there.end(), [&](const SkinDrop& o) {
                return std::abs(o.volume / d.volume - 1) < 1.0e-2 && glm::distance(o.position - apart, d.position) < 3.0e-4F;
            });
        EXPECT_GT(10 * same, 9 * here.size()) << away.x << ": " << same << " of " << here.size();
        // The drop below the ceiling went over to the floor.
        EXPECT_TRUE(std::any_of(there.begin(), there.end(), [&](const SkinDrop& d) {
            const vec3 x = d.position - apart;
            return x.x > 0.15F && std::abs(x.y) < 2.0e-4F;
        })) << away.x;
    }
}

// Nusselt 1916: a film 100 micrometres thick runs down a vertical wall at rho g h^2 / (3 mu) = 32.7 mm/s.
TEST(FlowFilm, RunsAtNusseltsSpeed) {
    for (const double jitter : {0.0, 0.3}) {
        auto device = cpu();
        const Shape wall = sheetShape(vec3(0, 0.2F, 0), vec3(0, -0.2F, 0), vec3(0.08F, 0, 0), 40, 16);
        SurfaceFlowParams p;
        p.viscosity = 1e-3F;
        p.density = 1000;
        p.advancing = p.receding = 1;  // wetting: otherwise such a thin film would tear
        p.trail = 0;
        SurfaceFlow flow = flowOn(*device, wall, p);
        const double spacing = 1.5e-3, height = 1e-4;
        std::mt19937 random(5);
        std::uniform_real_distribution<double> off(-jitter * spacing, jitter * spacing);
        for (double y = 0.08; y < 0.18; y += spacing)
            for (double x = 0.01; x < 0.07; x += spacing)
                flow.add(nearestPoint(flow.mesh(), vec3(dvec3(x + off(random), y + off(random), 0))),
                         static_cast<uint32_t>(spacing * spacing * height * 1e15), vec3(0.0F), true);
        double sum = 0, count = 0;
        for (int k = 0; k < 18; ++k) {
            EXPECT_TRUE(flow.step({}, 1.0 / 60));
            if (k < 3) continue;
            for (const SkinDrop& d : flow.drops())
                if (std::abs(d.position.x - 0.04F) < 0.02F && std::abs(d.position.y - 0.13F) < 0.03F) {
                    sum -= double{d.velocity.y};
                    count += 1;
                }
        }
        EXPECT_NEAR(sum / count / (1000 * 9.81 * height * height / (3 * 1e-3)), 1, 0.05) << "jitter " << jitter;
    }
}

// A heap of film on a horizontal plate spreads until retention at its rim stops it; its volume is conserved.
TEST(FlowFilm, AHeapSpreadsAndStops) {
    auto device = cpu();
    const Shape plate = sheetShape(vec3(-0.1F, 0, 0.1F), vec3(0.2F, 0, 0), vec3(0, 0, -0.2F), 20, 20);
    SurfaceFlowParams p;
    p.trail = 0;
    SurfaceFlow flow = flowOn(*device, plate, p);
    for (int k = 0; k < 600; ++k) {
        const double r = 0.008 * std::sqrt((k + 0.5) / 600), a = 2.39996 * k;
        flow.add(nearestPoint(flow.mesh(), vec3(dvec3(r * std::cos(a), 0, r * std::sin(a)))), kMicrolitres, vec3(0.0F), true);
    }
    const auto spreadOf = [&] {
        double sum = 0;
        for (const SkinDrop& d : flow.drops()) sum += glm::dot(d.position, d.position);
        return std::sqrt(2 * sum / 600);
    };
    double fastest = 0, before = 0;
    for (int k = 0; k < 600; ++k) {
        EXPECT_TRUE(flow.step({}, 1.0 / 60));
        if (k == 0) before = spreadOf();
        if (k > 560)
            for (const SkinDrop& d : flow.drops()) fastest = std::max(fastest, double{glm::length(d.velocity)});
    }
    EXPECT_EQ(flow.drops().size(), 600U);
    const double after = spreadOf();
    EXPECT_GT(after, 1.3 * before);
    EXPECT_LT(fastest, 1e-3);
    // Thickness of a puddle: e = 2 sqrt(gamma / rho g) sin(theta / 2), theta between receding and advancing; 0.6 ml are then 9.5 to 11.5 mm
    // wide. A sum over 5 mm widens the rim by as much, and the puddle spreads a fifth further.
    const auto radius = [](double degrees) {
        const double e = 2 * std::sqrt(0.0436 / (1005 * 9.81)) * std::sin(0.5 * degrees * kPiD / 180);
        return std::sqrt(600e-9 / (kPiD * e));
    };
    EXPECT_GT(after, radius(60));
    EXPECT_LT(after, 1.25 * radius(40));
    const SurfaceFlow::Ledger l = flow.ledger();
    EXPECT_EQ(l.added, l.drops + l.film + l.left + l.evaporated);
}

// A brim that is lowest in its middle fills most there, holds liquid up to its capacity, and spills tears there.
TEST(FlowBrim, FillsAndSpillsWhereItIsLowest) {
    auto device = cpu();
    const Shape wall = sheetShape(vec3(-0.05F, 0.1F, 0), vec3(0, -0.1F, 0), vec3(0.1F, 0, 0), 20, 20);
    SurfaceFlowParams p;
    p.evaporation = 0;
    Result<FlowMesh> mesh = makeFlowMesh(wall.view());
    ASSERT_TRUE(mesh);
    SkinBrim brim;
    for (int k = 0; k < 30; ++k) {
        const double x = -0.0145 + 0.001 * k, y = 0.07 + 0.003 * std::pow(x / 0.0145, 2);
        brim.places.push_back(nearestPoint(*mesh, vec3(dvec3(x, y, 0))));
        brim.spills.push_back(nearestPoint(*mesh, vec3(dvec3(x, y - 0.002, 0))));
    }
    Result<SurfaceFlow> made = SurfaceFlow::create(*device, std::move(*mesh), p, std::span(&brim, 1));
    ASSERT_TRUE(made) << made.error().message;
    SurfaceFlow& flow = *made;
    for (int k = 0; k < 240; ++k) EXPECT_TRUE(flow.step({}, 1.0 / 60));
    std::vector<SkinDrop> rest = flow.drops();
    ASSERT_EQ(rest.size(), 30U);
    // Hydrostatics of a groove: gamma / r against rho g y, r^2 as the volume.
    const auto radius = [&](size_t k) { return std::sqrt(rest[k].volume / (p.brimHolds * 1e-9 / 30)) * double{p.brimWidth}; };
    const double low = 0.0436 / radius(15), high = 0.0436 / radius(0);
    EXPECT_NEAR((high - low) / (1005 * 9.81 * double(rest[0].position.y - rest[15].position.y)), 1, 0.02);
    // 30 ul/min into one end of it. It spills when its deepest place is full.
    double first = 0, volume = 0, where = 1;
    for (int k = 0; k < 60 * 40; ++k) {
        flow.addToBrim(0, 8333);
        EXPECT_TRUE(flow.step({}, 1.0 / 60));
        for (const SkinDrop& d : flow.drops())
            if (first == 0 && d.id < static_cast<uint32_t>(p.capacity)) {
                first = 1.2 + k * 8333e-6;
                volume = d.volume * 1e9;
                where = d.position.x;
            }
    }
    EXPECT_GT(first, 0.4 * double{p.brimHolds}) << "it spilt too early";
    EXPECT_LE(first, 1.01 * double{p.brimHolds});
    EXPECT_GT(volume, 0.6 * double{p.tear});
    EXPECT_LT(volume, 1.3 * double{p.tear});
    EXPECT_LT(std::abs(where), 0.004);
    const SurfaceFlow::Ledger l = flow.ledger();
    EXPECT_EQ(l.added, l.drops + l.film + l.left + l.evaporated + l.refused);
    EXPECT_EQ(l.added, 1200000U + 2400U * 8333U);
}

// `rivulet validate flow`, the quick size.
TEST(FlowCase, HoldsItsTolerances) {
    auto device = cpu();
    CaseSettings settings;
    settings.device = device.get();
    settings.method = "flow";
    settings.quick = true;
    const Result<Outcome> outcome = runFlow(settings);
    ASSERT_TRUE(outcome) << outcome.error().message;
    EXPECT_GT(outcome->findings.size(), 15U);
    for (const Finding& f : outcome->findings) EXPECT_TRUE(f.pass()) << f.what << ": " << f.measured << " of " << f.reference;
    settings.goOn = [](double) { return false; };
    EXPECT_TRUE(runFlow(settings)->findings.empty());
}

}  // namespace
}  // namespace rivulet::flow_skin_test
