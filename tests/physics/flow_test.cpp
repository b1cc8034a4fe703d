// Flow on a skin: straight paths, retention, sliding speed, merging, and conservation of volume.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "fluid/flow/surface_flow.h"
#include "tests/physics/skins.h"
#include "tests/physics/worlds.h"

namespace rivulet::flow_test {
namespace {

constexpr uint32_t kMicrolitres = 1000000;  // picolitres

TEST(FlowMesh, ABallIsConnectedOverItsSeamAndPoles) {
    const Shape shape = ballShape(0.05F, 24);
    Result<FlowMesh> made = makeFlowMesh(shape.view());
    ASSERT_TRUE(made);
    const FlowMesh& m = *made;
    EXPECT_EQ(m.report.degenerate, 96U);  // at the poles
    EXPECT_EQ(m.report.openEdges, 0U) << m.report.sentence();
    EXPECT_EQ(m.report.components, 1U);
    EXPECT_EQ(m.rest.size(), 2U + 23U * 48U);
    for (uint32_t k = 0; k < m.across.size(); ++k) {
        const uint32_t other = 3 * (m.across[k] / 4) + m.across[k] % 4;
        EXPECT_EQ(m.across[other], 4 * (k / 3) + k % 3);
        // The same two corners in the opposite order.
        const uint32_t from = m.corner[k], to = m.corner[k - k % 3 + (k + 1) % 3];
        EXPECT_EQ(m.corner[other], to);
        EXPECT_EQ(m.corner[other - other % 3 + (other + 1) % 3], from);
    }
    for (size_t p = 0; p < m.rest.size(); ++p) EXPECT_EQ(shape.positions[m.given[p]], m.rest[p]);
}

// A band of `n` quads, closed with half a turn or none.
Shape band(uint32_t n, bool turned) {
    Shape s;
    for (uint32_t k = 0; k < n; ++k) {
        const double f = 2 * kPiD * k / n, t = turned ? 0.5 * f : 0;
        for (const double side : {-1.0, 1.0}) {
            const double r = 0.05 + 0.01 * side * std::cos(t);
            s.positions.emplace_back(r * std::cos(f), 0.01 * side * std::sin(t) + (turned ? 0 : 0.01 * side), r * std::sin(f));
        }
    }
    for (uint32_t k = 0; k < n; ++k) {
        const uint32_t a = 2 * k, b = a + 1;
        const bool last = k + 1 == n;
        const uint32_t c = last ? (turned ? 1U : 0U) : a + 2, d = last ? (turned ? 0U : 1U) : a + 3;
        s.indices.insert(s.indices.end(), {a, b, d, a, d, c});
    }
    return s;
}

TEST(FlowMesh, DefectsAreCountedAndRepairedOrSkipped) {
    const auto report = [](const Shape& shape) {
        Result<FlowMesh> mesh = makeFlowMesh(shape.view());
        EXPECT_TRUE(mesh) << (mesh ? "" : mesh.error().message);
        return mesh ? mesh->report : FlowMeshReport{};
    };
    const Shape plain = sheetShape(vec3(0.0F), vec3(0.1F, 0, 0), vec3(0, 0.1F, 0), 4, 4);
    EXPECT_EQ(report(plain).openEdges, 16U);
    EXPECT_EQ(report(plain).turned, 0U);

    Shape mixed = plain;  // one quad wound the other way
    std::swap(mixed.indices[6], mixed.indices[7]);
    std::swap(mixed.indices[9], mixed.indices[10]);
    EXPECT_EQ(report(mixed).turned, 2U);
    EXPECT_EQ(report(mixed).openEdges, 16U);

    Shape again = plain;  // the first triangle twice
    again.indices.insert(again.indices.end(), plain.indices.begin(), plain.indices.begin() + 3);
    EXPECT_EQ(report(again).repeated, 1U);
    EXPECT_EQ(report(again).branchedEdges, 0U);

    Shape fin = plain;  // a triangle that stands on an inner edge
    fin.positions.emplace_back(0.05F, 0.05F, 0.05F);
    fin.indices.insert(fin.indices.end(), {6U, 12U, static_cast<uint32_t>(fin.positions.size() - 1)});
    Result<FlowMesh> onFin = makeFlowMesh(fin.view());
    ASSERT_TRUE(onFin);
    EXPECT_EQ(onFin->report.branchedEdges, 1U);
    // The sheet continues below the fin; the edge of the fin is open.
    size_t open = 0;
    for (const uint32_t a : onFin->across) open += a == FlowMesh::kOpen ? 1 : 0;
    EXPECT_EQ(open, 16U + 3U);

    EXPECT_EQ(report(band(24, false)).oneSided, 0U);
    EXPECT_EQ(report(band(24, true)).oneSided, 1U);  // at the place where the two sides meet

    for (const Shape& nothing : {Shape{}, Shape{{vec3(0.0F), vec3(1.0F, 0, 0), vec3(2.0F, 0, 0)}, {0, 1, 2}}}) {
        const Result<FlowMesh> refused = makeFlowMesh(nothing.view());
        ASSERT_FALSE(refused);
        EXPECT_NE(refused.error().message.find("triangle"), std::string::npos) << refused.error().message;
    }
}

// A drop passes through triangles without area, which occur where a long edge meets two short ones.
TEST(Flow, PassesThroughTrianglesWithoutArea) {
    auto device = cpu();
    // Two rectangles; the lower edge of the upper one is split in two. Between them lies a triangle with collinear corners.
    const Shape shape{{vec3(0, 0.1F, 0), vec3(0.1F, 0.1F, 0), vec3(0, 0.05F, 0), vec3(0.1F, 0.05F, 0), vec3(0.05F, 0.05F, 0), vec3(0, 0, 0),
                       vec3(0.05F, 0, 0), vec3(0.1F, 0, 0)},
                      {0, 2, 3, 0, 3, 1, 2, 4, 3, 2, 5, 6, 2, 6, 4, 4, 6, 7, 4, 7, 3}};
    SurfaceFlowParams p;
    p.hold = p.drag = p.airDrag = p.trail = 0;
    p.pearls = false;
    SurfaceFlow flow = flowOn(*device, shape, p);
    EXPECT_EQ(flow.mesh().report.flat, 1U);
    for (const float x : {0.02F, 0.05F, 0.071F}) flow.add(nearestPoint(flow.mesh(), vec3(x, 0.09F, 0)), kMicrolitres, vec3(0.1F, -0.8F, 0));
    for (int k = 0; k < 10; ++k) EXPECT_TRUE(flow.step({.gravity = vec3(0.0F)}, 0.01));
    const std::vector<SkinDrop> drops = flow.drops();
    ASSERT_EQ(drops.size(), 3U);
    for (size_t k = 0; k < 3; ++k) {
        EXPECT_NEAR(drops[k].position.y, 0.01F, 1e-5F);
        EXPECT_NEAR(glm::length(drops[k].velocity), std::sqrt(0.65F), 1e-5F);
    }
}

// Without forces a drop moves straight: around a ball it returns to its start.
TEST(Flow, GoesStraightRoundABall) {
    auto device = cpu();
    const Shape shape = ballShape(0.05F, 64);
    SurfaceFlowParams p;
    p.hold = p.drag = p.airDrag = p.trail = 0;
    SurfaceFlow flow = flowOn(*device, shape, p);
    const vec3 start = 0.05F * glm::normalize(vec3(1.0F, 0.3F, 0.2F));
    const vec3 heading = glm::normalize(glm::cross(start, vec3(0.3F, 1.0F, -0.2F)));
    flow.add(nearestPoint(flow.mesh(), start), kMicrolitres, 0.1F * heading);
    double off = 0, speed = 0;
    const int steps = 200;
    for (int k = 0; k < steps; ++k) {
        EXPECT_TRUE(flow.step({.gravity = vec3(0.0F)}, 2 * kPiD * 0.05 / 0.1 / steps));
        const std::vector<SkinDrop> drops = flow.drops();
        ASSERT_EQ(drops.size(), 1U);
        off = std::max(off, double{std::abs(glm::dot(drops[0].position, glm::normalize(glm::cross(start, heading))))});
        speed = glm::length(drops[0].velocity);
    }
    EXPECT_NEAR(speed, 0.1, 1e-4);
    EXPECT_LT(off, 0.01 * 0.05);
    EXPECT_LT(glm::distance(flow.drops()[0].position, start), 0.01F * 2 * kPi * 0.05F);
}

// Le Grand's law without hysteresis: m v' = m g sin(a) - beta w eta v, solved exactly.
TEST(Flow, SlidesDownASlopeByLeGrandsLaw) {
    for (const double dt : {1.0 / 240, 1.0 / 60, 1.0 / 15}) {
        auto device = cpu();
        const double a = 35 * kPiD / 180;
        const Shape shape = sheetShape(vec3(0.0F), vec3(0.0F, 0.0F, -0.1F), vec3(dvec3(0.4 * std::cos(a), -0.4 * std::sin(a), 0)), 7, 31);
        SurfaceFlowParams p;
        p.hold = p.airDrag = p.trail = 0;
        SurfaceFlow flow = flowOn(*device, shape, p);
        ASSERT_GT(flow.mesh().report.openEdges, 0U);
        flow.add(nearestPoint(flow.mesh(), vec3(0.01F, -0.007F, -0.05F)), 8 * kMicrolitres);
        for (int k = 0; k < static_cast<int>(2 / dt + 0.5); ++k) EXPECT_TRUE(flow.step({}, dt));
        const std::vector<SkinDrop> drops = flow.drops();
        ASSERT_EQ(drops.size(), 1U);
        // A cap of 50 degrees: the radius of its foot by its height h = R tan(25 deg), V = pi h (3 R^2 + h^2) / 6.
        const double slope = std::tan(25 * kPiD / 180), volume = 8e-9;
        const double radius = std::cbrt(6 * volume / (kPiD * slope * (3 + slope * slope)));
        const double steady = 1005 * volume * 9.81 * std::sin(a) / (60 * 2 * radius * 1.73e-3);
        EXPECT_NEAR(glm::length(drops[0].velocity) / steady, 1, 1e-3) << dt;
        EXPECT_NEAR(drops[0].position.z, -0.05F, 1e-5F);
    }
}

// Cox 1986 and Voinov 1976: the force that the moving line adds, k (cos r' - cos a') for a small speed with theta^3 = theta_s^3 +- 9 Ca ln.
TEST(Flow, WithAWallFrictionTheAnglesGiveTheDrag) {
    SurfaceFlowParams p;
    EXPECT_EQ(dragOf(p), 60);
    p.viscosity = 0.1F;
    p.wallFriction = 2.0e6F;  // a slip length of 50 nm
    p.hold = 0.7F;
    const double ca = 1e-6, ln = std::log(1e-3 / 50e-9), front = 60 * kPiD / 180, back = 40 * kPiD / 180;
    const auto angle = [&](double rest, double sign) { return std::cbrt(rest * rest * rest + sign * 9 * ca * ln); };
    const double more = std::cos(angle(back, -1)) - std::cos(angle(front, 1)) - std::cos(back) + std::cos(front);
    EXPECT_NEAR(dragOf(p), 0.7 * more / ca, 1e-3 * dragOf(p));
    p.viscosity = 1.0e6F;  // slips by more than its height
    EXPECT_GT(dragOf(p), 0);
}

// Podgorski, Flesselles and Limat 2001: a drop that is faster than its back can recede sheds small ones, which stay behind. All volume is
// there, and a quarter of the slots stays free.
TEST(Flow, AFastDropShedsSmallOnes) {
    const Shape wall = sheetShape(vec3(0, 0.4F, 0), vec3(0.02F, 0, 0), vec3(0, -0.4F, 0), 4, 40);
    SurfaceFlowParams p;
    p.hold = p.airDrag = p.trail = 0;
    p.touch = 0.1F;
    p.capacity = 16;
    for (const double share : {1.4, 1.6}) {
        auto device = cpu();
        SurfaceFlow flow = flowOn(*device, wall, p);
        flow.add(nearestPoint(flow.mesh(), vec3(0.01F, 0.39F, 0)), 8 * kMicrolitres);
        const double slope = std::tan(25 * kPiD / 180), width = 2 * std::cbrt(6 * 8e-9 / (kPiD * slope * (3 + slope * slope)));
        const double gravity = share * cornerSpeed(p) * 60 * width * 1.73e-3 / (1005 * 8e-9);
        for (int k = 0; k < 90; ++k) EXPECT_TRUE(flow.step({.gravity = vec3(0, static_cast<float>(-gravity), 0)}, 1.0 / 60));
        const std::vector<SkinDrop> drops = flow.drops();
        EXPECT_EQ(drops.size(), share < 1.49 ? 1U : 12U) << share;
        const SurfaceFlow::Ledger l = flow.ledger();
        EXPECT_EQ(l.added, l.drops);
        double least = 1, most = 0;
        for (const SkinDrop& d : drops) {
            least = std::min(least, d.volume);
            most = std::max(most, d.volume);
        }
        if (share > 1.49) EXPECT_NEAR(most / least, 512, 12);
    }
}

// Furmidge 1962: a drop of 60 / 40 degrees on a vertical wall begins to slide at 4.07 microlitres, of 90 / 60 at 7.74: rho g V = w gamma
// (cos receding - cos advancing), for a cap with the mean angle. The drop grows by fifty others.
TEST(Flow, IsHeldUntilItIsTooHeavy) {
    struct Row {
        float advancing, receding;
        double microlitres;
    };
    for (const Row& row : {Row{60, 40, 4.07}, Row{90, 60, 7.74}})
        for (const uint32_t quads : {4U, 60U}) {
            auto device = cpu();
            const Shape shape = sheetShape(vec3(0.0F, 0.1F, 0.0F), vec3(0.0F, -0.1F, 0.0F), vec3(0.1F, 0.0F, 0.0F), quads, quads);
            SurfaceFlowParams p;
            p.advancing = row.advancing;
            p.receding = row.receding;
            SurfaceFlow flow = flowOn(*device, shape, p);
            std::mt19937 random(7);
            std::uniform_real_distribution<float> offset(-2e-4F, 2e-4F);
            double grown = 0, first = 0;
            for (int k = 0; k < 60 && first == 0; ++k) {
                const auto birth = static_cast<uint32_t>(row.microlitres * 1e6 / 50);
                flow.add(nearestPoint(flow.mesh(), vec3(0.05F + offset(random), 0.05F + offset(random), 0)), birth);
                for (int step = 0; step < 6; ++step) EXPECT_TRUE(flow.step({}, 1.0 / 60));
                grown += birth * 1e-6;
                for (const SkinDrop& d : flow.drops())
                    if (glm::length(d.velocity) > 1e-3F) first = grown;
            }
            ASSERT_GT(first, 0) << "it never let go";
            EXPECT_NEAR(first / row.microlitres, 1, 0.05) << row.advancing << ", " << quads << " quads";
        }
}

// On an uneven skin the force that holds a drop is normally distributed from place to place. A drop of 0.9 of the volume that begins to
// slide is held by less than 0.9^(2/3) of the mean force in a known share of places, as the weight goes with the volume and the force with
// its cube root. A drop that runs wanders, as its front is held more on one side than on the other; on an even skin its path is straight.
TEST(Flow, AnUnevenSkinHoldsHereAndLetsGoThere) {
    auto device = cpu();
    constexpr float kWide = 0.2F;
    const Shape shape = sheetShape(vec3(0.0F, kWide, 0.0F), vec3(0.0F, -kWide, 0.0F), vec3(kWide, 0.0F, 0.0F), 240, 240);
    for (const double deviation : {0.0, 0.1, 0.25}) {
        SurfaceFlowParams p;
        p.unevenness = static_cast<float>(deviation);
        p.trail = 0;
        SurfaceFlow flow = flowOn(*device, shape, p);
        constexpr int kSide = 18;
        std::vector<vec3> at;
        for (int k = 0; k < kSide * kSide; ++k) {
            at.emplace_back(0.01F * static_cast<float>(1 + k % kSide), 0.01F * static_cast<float>(1 + k / kSide), 0.0F);
            flow.add(nearestPoint(flow.mesh(), at.back()), static_cast<uint32_t>(0.9 * 4.07e6));
        }
        for (int step = 0; step < 6; ++step) EXPECT_TRUE(flow.step({}, 1.0 / 60));
        double slid = 0;
        for (const SkinDrop& d : flow.drops())
            slid += std::none_of(at.begin(), at.end(), [&](const vec3& x) { return glm::distance(x, d.position) < 1e-5F; }) ? 1 : 0;
        const double below = deviation > 0 ? 0.5 * std::erfc((1 - std::pow(0.9, 2.0 / 3)) / (deviation * std::sqrt(2.0))) : 0;
        EXPECT_NEAR(slid / (kSide * kSide), below, 0.07) << deviation;
    }
    for (const float deviation : {0.0F, 0.35F}) {
        SurfaceFlowParams p;
        p.unevenness = deviation;
        SurfaceFlow flow = flowOn(*device, shape, p);
        flow.add(nearestPoint(flow.mesh(), vec3(0.1F, 0.195F, 0.0F)), 10 * kMicrolitres);
        double aside = 0;
        for (int k = 0; k < 120; ++k) {
            EXPECT_TRUE(flow.step({}, 1.0 / 60));
            for (const SkinDrop& d : flow.drops()) aside = std::max(aside, std::abs(double{d.position.x} - 0.1));
        }
        EXPECT_LT(flow.drops().front().position.y, 0.15F) << deviation;
        if (deviation == 0) EXPECT_LT(aside, 1e-4);
        if (deviation > 0) EXPECT_GT(aside, 5e-4);
        EXPECT_LT(aside, 0.02) << deviation;
    }
}

// A trail has no gaps: along its middle the film has the set thickness, on right-angled, oblique and long triangles, at any speed.
TEST(Flow, ATrailHasNoGaps) {
    auto device = cpu();
    for (const vec2 quads : {vec2(60, 10), vec2(37, 23), vec2(20, 40)})
        for (const double drag : {60.0, 15.0}) {
            const Shape shape = sheetShape(vec3(0.0F, 0.1F, 0.0F), vec3(0.01F, -0.1F, 0.0F), vec3(0.03F, 0.0F, 0.0F),
                                           static_cast<uint32_t>(quads.x), static_cast<uint32_t>(quads.y));
            SurfaceFlowParams p;
            p.evaporation = p.hold = 0;
            p.drag = static_cast<float>(drag);
            SurfaceFlow flow = flowOn(*device, shape, p);
            flow.add(nearestPoint(flow.mesh(), vec3(0.015F, 0.098F, 0)), 8 * kMicrolitres);
            for (int k = 0; k < 600; ++k) EXPECT_TRUE(flow.step({}, 1.0 / 60));
            // Cells whose centre lies half a millimetre from the middle line at most.
            double sum = 0, dry = 0, cells = 0;
            for (uint32_t t = 0; t < flow.mesh().triangleCount(); ++t) {
                const std::vector<float> film = flow.film(t);
                const auto n = static_cast<uint32_t>(std::lround(std::sqrt(static_cast<double>(film.size()))));
                for (uint32_t i = 0, at = 0; i < n; ++i)
                    for (uint32_t j = 0; j < 2 * (n - i) - 1; ++j, ++at) {
                        const float third = j % 2 == 0 ? 1.0F / 3 : 2.0F / 3, rows = static_cast<float>(n);
                        const vec3 x = positionOf(flow.mesh(),
                                                  {t, (static_cast<float>(i) + third) / rows, (static_cast<float>(j / 2) + third) / rows});
                        if (std::abs(x.x - 0.015F) > 0.0005F || x.y < 0.01F || x.y > 0.09F) continue;
                        sum += double{film[at]};
                        dry += film[at] < 5e-6F ? 1 : 0;
                        ++cells;
                    }
            }
            ASSERT_GT(cells, 300);
            EXPECT_NEAR(sum / cells, 1e-5, 0.5e-6) << quads.x << " x " << quads.y << " quads, drag " << drag;
            EXPECT_LT(dry / cells, 0.02) << quads.x << " x " << quads.y << " quads, drag " << drag;
        }
}

// A drop on a dry wall leaves a film of the set thickness, as wide as its foot, and stops when it is too light. A second drop that starts
// next to the trail is drawn into it and runs further.
TEST(Flow, TheSecondTearFollowsTheFirst) {
    auto device = cpu();
    const Shape shape = sheetShape(vec3(0.0F, 0.3F, 0.0F), vec3(0.0F, -0.3F, 0.0F), vec3(0.05F, 0.0F, 0.0F), 60, 10);
    SurfaceFlowParams p;
    p.evaporation = 0;
    p.largestDrop = 6;
    SurfaceFlow flow = flowOn(*device, shape, p);
    const auto runDown = [&](float x) {
        flow.add(nearestPoint(flow.mesh(), vec3(x, 0.29F, 0)), 5 * kMicrolitres);
        for (int k = 0; k < 600; ++k) EXPECT_TRUE(flow.step({}, 1.0 / 60));
        const std::vector<SkinDrop> drops = flow.drops();
        return *std::min_element(drops.begin(), drops.end(),
                                 [](const SkinDrop& a, const SkinDrop& b) { return a.position.y < b.position.y; });
    };
    const SkinDrop first = runDown(0.025F);
    EXPECT_LT(glm::length(first.velocity), 5e-4F);  // almost stopped: it has become too light
    const double went = 0.29 - double{first.position.y};
    EXPECT_GT(went, 0.01);
    EXPECT_LT(went, 0.25);
    EXPECT_NEAR(first.position.x, 0.025F, 1e-4F);
    SurfaceFlow::Ledger l = flow.ledger();
    EXPECT_EQ(l.added, l.drops + l.film + l.left);
    // 10 micrometres along its path over 0.7 of the width of its foot, 3.7 mm for 5 microlitres; less as the drop gets lighter.
    const double foot = 2 * 1.0836e-3 * std::cbrt(5.0);
    EXPECT_NEAR(l.film * 1e-15 / (1e-5 * 0.7 * foot * went), 1, 0.2);
    // The film halfway down, on the middle line and next to it.
    const auto thickness = [&](float x, float y) {
        const SkinPoint at = nearestPoint(flow.mesh(), vec3(x, y, 0));
        const std::vector<float> cells = flow.film(at.triangle);
        return *std::max_element(cells.begin(), cells.end());
    };
    const auto middle = static_cast<float>(0.29 - 0.5 * went);
    EXPECT_NEAR(thickness(0.025F, middle), 1e-5F, 2e-6F);
    EXPECT_EQ(thickness(0.035F, middle), 0);

    const SkinDrop second = runDown(0.0262F);
    EXPECT_LT(second.position.y, first.position.y - 0.01F);
    EXPECT_LT(std::abs(second.position.x - 0.025F), 0.0012F);
    l = flow.ledger();
    EXPECT_EQ(l.added, l.drops + l.film + l.left);
}

// A deforming skin carries its drops, even where triangles lose their area: drops keep their places on it, and none becomes infinite.
TEST(Flow, ASkinThatMovesCarriesItsDrops) {
    auto device = cpu();
    const Shape rest = sheetShape(vec3(-0.05F, 0, 0.05F), vec3(0.1F, 0, 0), vec3(0, 0, -0.1F), 20, 20);
    SurfaceFlow flow = flowOn(*device, rest);
    for (int k = 0; k < 12; ++k)
        flow.add(nearestPoint(flow.mesh(), vec3(-0.04F + 0.02F * static_cast<float>(k % 4), 0, -0.02F + 0.02F * static_cast<float>(k / 4))),
                 kMicrolitres);
    EXPECT_TRUE(flow.step({.gravity = vec3(0.0F)}, 1.0 / 60));
    const std::vector<SkinDrop> before = flow.drops();
    ASSERT_EQ(before.size(), 12U);
    std::vector<vec3> moved = rest.positions;
    for (int k = 0; k < 60; ++k) {
        for (size_t i = 0; i < moved.size(); ++i) {
            const vec3& x = rest.positions[i];
            moved[i] = vec3(x.x, 0.01F * std::sin(60 * x.x + 0.2F * static_cast<float>(k)), x.z);
        }
        if (k % 10 == 5) moved[150] = moved[151];  // four triangles lose their area, with drops on them
        EXPECT_TRUE(flow.step({.gravity = vec3(0.0F), .positions = moved}, 1.0 / 60));
        for (const SkinDrop& d : flow.drops()) EXPECT_TRUE(isFinite(d.position) && isFinite(d.velocity));
    }
    const std::vector<SkinDrop> after = flow.drops();
    ASSERT_EQ(after.size(), before.size());
    for (size_t k = 0; k < after.size(); ++k) {
        EXPECT_EQ(after[k].at.triangle, before[k].at.triangle);
        EXPECT_NEAR(after[k].position.x, before[k].position.x, 1e-5F);
        EXPECT_NEAR(after[k].position.y, 0.01F * std::sin(60 * before[k].position.x + 0.2F * 59), 1e-3F);
    }
}

TEST(Flow, InvalidPositionsAreRefusedAndNothingMoves) {
    auto device = cpu();
    const Shape shape = sheetShape(vec3(0.0F, 0.1F, 0.0F), vec3(0.0F, -0.1F, 0.0F), vec3(0.1F, 0.0F, 0.0F), 4, 4);
    SurfaceFlow flow = flowOn(*device, shape);
    flow.add(nearestPoint(flow.mesh(), vec3(0.05F, 0.05F, 0)), 8 * kMicrolitres);
    EXPECT_TRUE(flow.step({}, 1.0 / 60));
    const vec3 before = flow.drops().at(0).position;
    std::vector<vec3> bad = shape.positions;
    bad[7].y = std::numeric_limits<float>::infinity();
    const Status infinite = flow.step({.positions = bad}, 1.0 / 60);
    ASSERT_FALSE(infinite);
    EXPECT_NE(infinite.error().message.find("position 7"), std::string::npos) << infinite.error().message;
    bad.resize(5);
    const Status few = flow.step({.positions = bad}, 1.0 / 60);
    ASSERT_FALSE(few);
    EXPECT_NE(few.error().message.find("too few"), std::string::npos) << few.error().message;
    EXPECT_EQ(flow.drops().at(0).position, before);
}

TEST(Flow, ConservesVolume) {
    auto device = cpu();
    const Shape shape = ballShape(0.04F, 40);
    SurfaceFlowParams p;
    p.capacity = 512;
    SurfaceFlow flow = flowOn(*device, shape, p);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> any(-1.0F, 1.0F);
    std::uniform_int_distribution<uint32_t> volume(1, 3 * kMicrolitres);
    for (int k = 0; k < 600; ++k) {
        if (k < 300)
            for (int n = 0; n < 3; ++n)
                flow.add(nearestPoint(flow.mesh(), vec3(any(random), std::abs(any(random)), any(random))), volume(random));
        EXPECT_TRUE(flow.step({.wind = vec3(k > 400 ? 3.0F : 0.0F, 0, 0)}, 1.0 / 60));
        if (k % 100 != 99) continue;
        const SurfaceFlow::Ledger l = flow.ledger();
        EXPECT_EQ(l.added, l.drops + l.film + l.left + l.evaporated + l.refused);
        for (const SkinDrop& d : flow.drops()) {
            EXPECT_NEAR(glm::length(d.position), 0.04F, 0.04F * 0.004F);
            EXPECT_TRUE(isFinite(d.velocity));
        }
    }
    const SurfaceFlow::Ledger l = flow.ledger();
    EXPECT_GT(l.merges, 200U);
    EXPECT_GT(l.film, 0U);
    EXPECT_GT(l.evaporated, 0U);
    uint64_t told = 0;
    for (const LeftDrop& d : flow.takeLeft()) told += d.picolitres;
    EXPECT_EQ(told, l.left);
}

}  // namespace
}  // namespace rivulet::flow_test
