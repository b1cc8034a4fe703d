// Thesis mode: flow in UV obeys (11)-(21) with the corrections; the printed formulas fail.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "fluid/flow/flow_maps.h"
#include "fluid/flow/thesis_picture.h"
#include "fluid/validate/thesis_forms.h"
#include "tests/physics/charted_skins.h"
#include "tests/physics/skins.h"
#include "tests/physics/worlds.h"

namespace rivulet::flow_thesis_test {
namespace {

constexpr uint32_t kMicrolitre = 1000000;  // picolitres
constexpr double kGravity = 9.81;
constexpr double kStep = 1.0 / 60;

// A tangential force only, without retention and without neighbours.
ThesisParams bare() {
    ThesisParams p;
    p.friction = p.adhesive = p.curvature = p.stiffness = p.viscosity = 0;
    return p;
}

struct Thesis {
    std::unique_ptr<Device> device;
    std::vector<vec2> uvs;
    std::unique_ptr<SurfaceFlow> flow;

    Thesis(const MeshView& shape, const ThesisParams& params, const SurfaceFlowParams& liquid = {}) : device(cpu()) {
        Result<FlowMesh> mesh = makeFlowMesh(shape);
        EXPECT_TRUE(mesh);
        uvs = cornerUvs(*mesh, shape);
        Result<SurfaceFlow> made = SurfaceFlow::createThesis(*device, std::move(*mesh), uvs, liquid, params);
        EXPECT_TRUE(made) << (made ? "" : made.error().message);
        flow = std::make_unique<SurfaceFlow>(std::move(*made));
    }
    // Of the only drop.
    vec2 uv() const {
        const std::vector<SkinDrop> drops = flow->drops();
        return drops.size() == 1 ? uvAt(uvs, drops[0].at) : vec2(-1.0F);
    }
    double speed() const {
        const std::vector<SkinDrop> drops = flow->drops();
        return drops.size() == 1 ? double{glm::length(drops[0].velocity)} : -1;
    }
    void add(const vec3& at, uint32_t picolitres = kMicrolitre, const vec3& velocity = vec3(0.0F)) {
        flow->add(nearestPoint(flow->mesh(), at), picolitres, velocity);
    }
};

// A wall of 0.2 m, u to the right and v up over it, facing +z; `shear`: u grows upwards as well.
Shape wall(float shear = 0) {
    Shape s = sheetShape(vec3(0), vec3(0.2F, 0, 0), vec3(0, 0.2F, 0), 8, 8);
    for (vec2& uv : s.uvs) uv.x += shear * uv.y;
    return s;
}
// The same, horizontal and facing up; `under`: facing down.
Shape lying(bool under = false) {
    return under ? sheetShape(vec3(0), vec3(0.2F, 0, 0), vec3(0, 0, 0.2F), 8, 8)
                 : sheetShape(vec3(0), vec3(0, 0, 0.2F), vec3(0.2F, 0, 0), 8, 8);
}

TEST(ThesisForms, ThePrintedFrameFlipsVAndDropsClimb) {
    // u to the right, v up, 0.2 m a unit: gravity on a wall.
    const std::array<dvec3, 3> x = {dvec3(0), dvec3(0.2, 0, 0), dvec3(0, 0.2, 0)};
    const dmat3 m0 = thesisFrame(x, {dvec2(0, 0), dvec2(1, 0), dvec2(0, 1)});
    const dvec3 down(0, -kGravity, 0), out(0, 0, 3);
    const dvec3 mended = glm::inverse(correctedFrame(m0, out)) * down, printed = glm::inverse(printedFrame(m0, out)) * down;
    EXPECT_NEAR(mended.y, -kGravity / 0.2, 1e-9);
    EXPECT_NEAR(mended.x, 0, 1e-9);
    EXPECT_GT(printed.y, 0);  // up
    EXPECT_NEAR(turnedBy(m0, correctedFrame(m0, out), down), 0, 1e-6);
    EXPECT_NEAR(turnedBy(m0, printedFrame(m0, out), down), kPiD, 1e-6);
    // T x (T x B) = -|T|^2 B: too weak or too strong by |T|^2 as well, here 1 / 25.
    EXPECT_NEAR(printed.y, -mended.y * 25, 1e-6);
}

TEST(ThesisForms, ThePrintedNormalPutsAnAreaIntoTheForceAwayFromTheSkin) {
    const dvec3 pull(1, -3, 2), out(0, 0, 1);
    for (const double size : {0.1, 0.2, 2.0}) {
        const dmat3 m0 = thesisFrame({dvec3(0), dvec3(size, 0, 0), dvec3(0, size, 0)}, {dvec2(0, 0), dvec2(1, 0), dvec2(0, 1)});
        EXPECT_NEAR((glm::inverse(correctedFrame(m0, out)) * pull).z, 2, 1e-9) << size;
        EXPECT_NEAR((glm::inverse(printedFrame(m0, out)) * pull).z * size * size, 2, 1e-9) << size;
    }
}

TEST(ThesisForms, ThePrintedSignDetachesRestingDropsAndHoldsASingleDrop) {
    const double weight = 1.0e-5;
    // On a floor the force away from the skin is -weight.
    EXPECT_LT(printedHold(-weight, 1.0e-6, 0, 1), 0);
    EXPECT_GT(correctedHold(-weight, 1.0e-6, 0, 1, 0), 0);
    // On a ceiling it is +weight.
    EXPECT_GT(printedHold(weight, 1.0e-6, 0, 1), 0);
    EXPECT_LT(correctedHold(weight, 1.0e-6, 0, 1, 0), 0);
    EXPECT_TRUE(std::isinf(printedHold(0, 0, 1.0e-8, 0)));
    EXPECT_DOUBLE_EQ(correctedHold(0, 0, 1.0e-8, 0, 1.0e-6), 1.0e-6);
}

TEST(FlowThesis, AStepAddsGravityAlongTheSkinInEveryLayout) {
    for (const float shear : {0.0F, 0.7F})
        for (const Layout layout : {Layout::own, Layout::stretched, Layout::turned, Layout::pieces}) {
            Shape shape = wall(shear);
            // Tilted about x and z.
            const dmat3 turned(glm::rotate(glm::rotate(dmat4(1.0), 0.5, dvec3(1, 0, 0)), 0.4, dvec3(0, 0, 1)));
            for (vec3& p : shape.positions) p = vec3(turned * dvec3(p));
            shape = laidOut(shape, layout);
            ThesisParams p = bare();
            p.adhesive = 1;
            Thesis t(shape.view(), p);
            t.add(vec3(turned * dvec3(0.085, 0.112, 0)));
            // So short that it stays in its triangle: in the next one the same UV/s are other m/s.
            constexpr double kShort = 1.0e-3;
            ASSERT_TRUE(t.flow->step({}, kShort));
            const std::vector<SkinDrop> drops = t.flow->drops();
            ASSERT_EQ(drops.size(), 1U);
            const dvec3 n = turned * dvec3(0, 0, 1), g(0, -kGravity, 0), expected = (g - n * glm::dot(g, n)) * kShort;
            EXPECT_NEAR(glm::distance(dvec3(drops[0].velocity), expected), 0, 1e-6) << layoutName(layout) << shear;
        }
}

TEST(FlowThesis, TheFieldFollowsARotatingAndAStretchedSkin) {
    const Shape shape = wall();
    const auto falls = [&](const SurfaceFlowInputs& inputs) {
        Thesis t(shape.view(), bare());
        t.add(vec3(0.1F, 0.1F, 0));
        EXPECT_TRUE(t.flow->step({.gravity = vec3(0)}, kStep));  // M^-1 as it was
        const vec2 from = t.uv();
        EXPECT_TRUE(t.flow->step(inputs, kStep));
        return (dvec2(t.uv()) - dvec2(from)) / (kStep * kStep);
    };
    EXPECT_NEAR(glm::distance(falls({}), dvec2(0, -kGravity / 0.2)), 0, 0.02);
    const dmat4 quarter = glm::rotate(dmat4(1.0), kPiD / 2, dvec3(0, 0, 1));  // up becomes left
    EXPECT_NEAR(glm::distance(falls({.toWorld = quarter}), dvec2(-kGravity / 0.2, 0)), 0, 0.02);
    std::vector<vec3> taller = shape.positions;
    for (vec3& p : taller) p.y *= 2;
    EXPECT_NEAR(glm::distance(falls({.positions = taller}), dvec2(0, -kGravity / 0.4)), 0, 0.02);
    EXPECT_NEAR(glm::distance(falls({.gravity = vec3(0), .wind = vec3(10, 0, 0)}), dvec2(10 / 0.2, 0)), 0, 0.02);
}

TEST(FlowThesis, FrictionStopsAndHoldsButNeverReverses) {
    ThesisParams p = bare();
    p.friction = 0.5F;
    Thesis t(lying().view(), p);
    // v = 0.05 UV/s along u (0.01 m/s along z) against mu g: it stops after v^2 / (2 mu g).
    t.add(vec3(0.1F, 0, 0.1F), kMicrolitre, vec3(0, 0, 0.01F));
    const vec2 from = uvAt(t.uvs, nearestPoint(t.flow->mesh(), vec3(0.1F, 0, 0.1F)));
    double furthest = 0;
    constexpr double kShort = 1.0 / 6000;
    for (int k = 0; k < 200; ++k) {
        ASSERT_TRUE(t.flow->step({}, kShort));
        const double way = glm::distance(dvec2(t.uv()), dvec2(from));
        EXPECT_GE(way, furthest - 1e-7);
        furthest = way;
    }
    EXPECT_NEAR(furthest, 0.05 * 0.05 / (2 * 0.5 * kGravity), 6e-6);
    EXPECT_EQ(t.speed(), 0);
    // Static friction on a wall with enough adhesion: the position is exactly constant.
    p.adhesive = 0.01F;
    Thesis held(wall().view(), p);
    held.add(vec3(0.1F, 0.1F, 0));
    ASSERT_TRUE(held.flow->step({}, kStep));
    const vec2 there = held.uv();
    for (int k = 0; k < 30; ++k) ASSERT_TRUE(held.flow->step({}, kStep));
    EXPECT_EQ(held.uv(), there);
}

TEST(FlowThesis, ADropHasNoTerminalSpeed) {
    Thesis t(sheetShape(vec3(0), vec3(2, 0, 0), vec3(0, 20, 0), 2, 20).view(), bare());
    t.add(vec3(1, 19.9F, 0));
    double half = 0;
    for (int k = 1; k <= 60; ++k) {
        ASSERT_TRUE(t.flow->step({}, kStep));
        if (k == 30) half = t.speed();
    }
    EXPECT_NEAR(t.speed() / half, 2, 1e-3);
}

TEST(FlowThesis, WhetherADropIsHeldDependsOnTheLayout) {
    // The same wall, drop and friction, with a map twice as wide. In metres nothing has changed.
    ThesisParams p = bare();
    p.friction = 1;
    p.adhesive =
        static_cast<float>(1.5 * kGravity / 0.2 * 1005 * 1.0e-9);  // 1.5 times what moves a microlitre of it, in the thesis's units
    const auto slides = [&](float scale) {
        Shape s = wall();
        for (vec2& uv : s.uvs) uv *= scale;
        Thesis t(s.view(), p);
        t.add(vec3(0.1F, 0.1F, 0));
        for (int k = 0; k < 5; ++k) EXPECT_TRUE(t.flow->step({}, kStep));
        return t.speed() > 0;
    };
    EXPECT_FALSE(slides(1));
    EXPECT_TRUE(slides(2));
}

TEST(FlowThesis, WithoutAdhesionHangingDropsDetachAndLyingDropsStay) {
    for (const bool under : {false, true}) {
        Thesis t(lying(under).view(), bare());
        t.add(vec3(0.1F, 0, 0.1F), kMicrolitre, vec3(0.02F, 0, 0.01F));
        ASSERT_TRUE(t.flow->step({}, kStep));
        const std::vector<LeftDrop> left = t.flow->takeLeft();
        ASSERT_EQ(left.size(), under ? 1U : 0U);
        EXPECT_EQ(t.flow->drops().size(), under ? 0U : 1U);
        if (!under) continue;
        EXPECT_EQ(left[0].picolitres, kMicrolitre);
        // In metres, as it was set.
        EXPECT_NEAR(glm::distance(left[0].velocity, vec3(0.02F, 0, 0.01F)), 0, 1e-5F);
        EXPECT_NEAR(glm::distance(left[0].position, vec3(0.1F, 0, 0.1F)), 0, 1e-3F);
    }
    ThesisParams sticky = bare();
    sticky.adhesive = 2.0e-5F;  // a microlitre weighs half of it
    Thesis t(lying(true).view(), sticky);
    t.add(vec3(0.1F, 0, 0.1F));
    ASSERT_TRUE(t.flow->step({}, kStep));
    EXPECT_EQ(t.flow->drops().size(), 1U);
}

TEST(FlowThesis, TheLayoutIsCutAtSeamsAndOnlyThere) {
    const auto cuts = [](const Shape& shape) {
        Result<FlowMesh> mesh = makeFlowMesh(shape.view());
        EXPECT_TRUE(mesh);
        const std::vector<uint32_t> across = acrossInUv(*mesh, cornerUvs(*mesh, shape.view()));
        size_t open = 0;
        for (size_t k = 0; k < across.size(); ++k) {
            open += across[k] == FlowMesh::kOpen ? 1 : 0;
            if (across[k] != FlowMesh::kOpen) EXPECT_EQ(across[3 * (across[k] / 4) + across[k] % 4], 4 * (k / 3) + k % 3);
        }
        return open - mesh->report.openEdges;
    };
    EXPECT_EQ(cuts(wall()), 0U);
    // A ball's meridian, both sides of it; round each pole the triangles have a corner each in UV.
    EXPECT_EQ(cuts(ballShape(0.05F, 24)), 2U * 22U + 2U * 2U * 48U);
    EXPECT_EQ(cuts(coneShape(0.03F, 0.02F, 0.1F, 24, 10)), 2U * 10U);
    // 4 x 4 squares, of two quads along each side: three inner lines each way, 8 edges long, both sides.
    EXPECT_EQ(cuts(laidOut(wall(), Layout::pieces)), 2U * 2U * 3U * 8U);
}

TEST(FlowThesis, DropsThatCrossASeamDrainAndVolumesBalance) {
    const Shape shape = laidOut(ballShape(0.05F, 24), Layout::pieces);
    ThesisParams p;
    p.friction = 0;
    Thesis t(shape.view(), p);
    uint64_t told = 0;
    std::mt19937 random(3);
    std::uniform_real_distribution<float> any(-1, 1);
    for (int k = 0; k < 120; ++k) {
        for (int n = 0; n < 3; ++n) t.add(0.05F * glm::normalize(vec3(any(random), any(random), any(random))), 100000 + k);
        ASSERT_TRUE(t.flow->step({.wind = vec3(k % 50 > 40 ? 8 : 0, 0, 0)}, kStep));
        for (const LeftDrop& d : t.flow->takeLeft()) {
            told += d.picolitres;
            EXPECT_NEAR(glm::length(d.position), 0.05F, 0.001F);  // on the skin in space
        }
    }
    const SurfaceFlow::Ledger l = t.flow->ledger();
    EXPECT_EQ(l.added, l.drops + l.film + l.left + l.evaporated + l.refused);
    EXPECT_EQ(l.left, told);
    EXPECT_GT(l.left, l.added / 3);
    EXPECT_EQ(l.merges, 0U);
    EXPECT_EQ(l.film, 0U);
}

TEST(FlowThesis, PressureAndViscosityMatchTheirSums) {
    ThesisParams p = bare();
    p.reach = 0.05F;
    p.restDensity = 0.004F;
    p.stiffness = 0.5F;
    p.viscosity = 2.0e-4F;
    Thesis t(wall().view(), p);
    std::mt19937 random(9);
    std::uniform_real_distribution<double> off(-0.03, 0.03), some(0.3, 1.2), speed(-0.05, 0.05);
    struct Particle {
        dvec2 uv, v;
        double mass;
    };
    std::vector<Particle> all;
    for (int k = 0; k < 24; ++k) {
        const Particle one{dvec2(0.5) + dvec2(off(random), off(random)), dvec2(speed(random), speed(random)), 1005e-9 * some(random)};
        all.push_back(one);
        const vec3 x(dvec3(one.uv * 0.2, 0));
        t.add(x, static_cast<uint32_t>(one.mass / 1005 * 1.0e15), vec3(dvec3(one.v * 0.2, 0)));
    }
    constexpr double kShort = 1.0e-3;
    ASSERT_TRUE(t.flow->step({.gravity = vec3(0)}, kShort));
    // (3)-(6), all pairs, in double precision.
    const double h = 0.05, rest = 0.004;
    std::vector<double> rho;
    for (const Particle& a : all) {
        double sum = 0;
        for (const Particle& b : all) {
            const double q2 = glm::dot(a.uv - b.uv, a.uv - b.uv) / (h * h);
            if (q2 < 1) sum += b.mass * 4 / (kPiD * h * h) * std::pow(1 - q2, 3);
        }
        rho.push_back(sum);
    }
    const std::vector<SkinDrop> drops = t.flow->drops();
    ASSERT_EQ(drops.size(), all.size());
    double fastest = 0;
    for (size_t i = 0; i < all.size(); ++i) {
        dvec2 a(0.0);
        for (size_t j = 0; j < all.size(); ++j) {
            const dvec2 d = all[i].uv - all[j].uv;
            const double r = glm::length(d);
            if (i == j || r >= h) continue;
            const double over = 1 / std::max(rho[j], rest), pressures = 0.5 * (rho[i] + rho[j] - 2 * rest);
            a += d / r * (all[j].mass * pressures / 2 * over * 30 / (kPiD * std::pow(h, 5)) * (h - r) * (h - r));
            a += (all[j].v - all[i].v) * (2.0e-4 * rest * all[j].mass * over * 40 / (kPiD * std::pow(h, 5)) * (h - r));
        }
        const dvec2 expected = all[i].v + a / std::max(rho[i], rest) * kShort;
        fastest = std::max(fastest, glm::length(expected - all[i].v));
        // Drops are reported by id: this one is found by its mass.
        const auto same = std::min_element(drops.begin(), drops.end(), [&](const SkinDrop& x, const SkinDrop& y) {
            return std::abs(x.volume * 1005 - all[i].mass) < std::abs(y.volume * 1005 - all[i].mass);
        });
        EXPECT_NEAR(glm::distance(dvec2(vec2(same->velocity)) / 0.2, expected), 0, 2e-5) << i;
    }
    EXPECT_GT(fastest, 1e-3);  // there was something to compare
}

TEST(FlowThesis, ALoneDropIsHeldByCappedTensionOnly) {
    ThesisParams p = bare();
    p.friction = 1;
    p.curvature = 1;  // N kg/UV^3, over a gradient of 0
    const auto speed = [&](double most) {
        p.curvatureMost = static_cast<float>(most);
        Thesis t(wall().view(), p);
        t.add(vec3(0.1F, 0.1F, 0));
        EXPECT_TRUE(t.flow->step({}, kStep));
        return t.speed() / 0.2;
    };
    // |q| - mu F_N dt / m.
    const double pull = kGravity / 0.2, mass = 1005e-9;
    EXPECT_NEAR(speed(0.5 * pull * mass), 0.5 * pull * kStep, 1e-4);
    EXPECT_EQ(speed(1.5 * pull * mass), 0);
}

TEST(FlowThesis, InvalidUvsAreRefusedOrSkippedWithAMessage) {
    auto device = cpu();
    const Shape shape = wall();
    Result<FlowMesh> mesh = makeFlowMesh(shape.view());
    ASSERT_TRUE(mesh);
    const auto made = [&](const std::vector<vec2>& uvs) { return SurfaceFlow::createThesis(*device, FlowMesh(*mesh), uvs, {}, {}); };
    std::vector<vec2> uvs = cornerUvs(*mesh, shape.view());
    EXPECT_EQ(made({}).error().message, "thesis mode has 0 UVs for 384 corners: give one for each corner of each triangle");
    EXPECT_EQ(made(std::vector<vec2>(uvs.size(), vec2(0.5F))).error().message,
              "no triangle of the skin has an area in UV, which thesis mode flows in: give it UVs, or mode drops");
    for (size_t k = 0; k < 30; ++k) uvs[k * 5] = vec2(k % 2 == 0 ? std::nanf("") : 1.0e30F, 0);
    Result<SurfaceFlow> flow = made(uvs);
    ASSERT_TRUE(flow);
    for (uint32_t k = 0; k < 100; ++k) flow->add({k, 0.3F, 0.3F}, kMicrolitre);
    // Strong wind, and a skin that collapses to a line and recovers.
    std::vector<vec3> line = shape.positions;
    for (vec3& p : line) p.x = 0.1F;
    for (int k = 0; k < 20; ++k)
        ASSERT_TRUE(flow->step({.wind = vec3(k % 7 == 6 ? 1.0e3F : 0, 0, 0), .positions = k % 3 == 1 ? line : shape.positions}, kStep));
    for (const SkinDrop& d : flow->drops()) EXPECT_TRUE(isFinite(d.position) && isFinite(d.velocity));
    for (const LeftDrop& d : flow->takeLeft()) EXPECT_TRUE(isFinite(d.position) && isFinite(d.velocity));
    const SurfaceFlow::Ledger l = flow->ledger();
    EXPECT_EQ(l.added, l.drops + l.left + l.refused);
}

// The thesis's figure 3.7 on the default head, a stream under each eye: by gravity alone, with wind to the right, with wind to the back.
TEST(FlowThesis, ThePictureFollowsTheWind) {
    const test::Skin head = test::headSkin();
    ASSERT_FALSE(head.positions.empty());
    // Centre of the height field of the streams left and right of the nose.
    const auto middle = [&](const vec3& pull, double side) {
        Thesis t(head.view(), {});
        std::mt19937 random(1);
        std::uniform_real_distribution<float> off(-0.002F, 0.002F);
        std::vector<ThesisParticle> particles;
        for (int k = 0; k < 60; ++k) {
            for (int n = 0; n < 3; ++n) t.add(vec3(0.036 * side + double{off(random)}, 0.016F + off(random), 0.038F), kMicrolitre / 5);
            EXPECT_TRUE(t.flow->step({.gravity = pull}, kStep));
            for (const SkinDrop& d : t.flow->drops()) particles.push_back({uvAt(t.uvs, d.at), static_cast<float>(d.volume * 1005)});
        }
        const ThesisPicture picture = thesisPicture(particles, 256, 0.01F, 201e-9F);
        double sum = 0, u = 0;
        for (size_t k = 0; k < picture.height.size(); ++k) {
            sum += double{picture.height[k]};
            u += double{picture.height[k]} * (static_cast<double>(k % 256) + 0.5) / 256;
        }
        EXPECT_GT(sum, 100);
        return u / sum;
    };
    const vec3 down(0, -10, 0), right(10, -10, 0), back(0, -10, -10);
    for (const double side : {-1.0, 1.0}) {
        EXPECT_GT(middle(right, side), middle(down, side) + 0.02) << side;
        EXPECT_GT((middle(back, side) - middle(down, side)) * side, 0.01) << side;  // round the face, away from the nose
    }
    EXPECT_NEAR(middle(down, -1) + middle(down, 1), 1, 0.01);  // the head's halves are mirrored
}

}  // namespace
}  // namespace rivulet::flow_thesis_test
