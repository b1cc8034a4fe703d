// Drops that hang: their shape and largest volume, what falls and what stays, and the volume that is drawn of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/flow/air_drops.h"
#include "fluid/flow/pendant_drop.h"
#include "tests/physics/skins.h"
#include "tests/physics/worlds.h"

namespace rivulet::pendant_test {
namespace {

constexpr uint32_t kMicrolitres = 1000000;  // picolitres

// What falls from a tip, over 2 pi r (surface tension) / (density x gravity), by r over the cube root of its volume: measured.
TEST(PendantDrop, WhatFallsIsWhatHarkinsAndBrownMeasured) {
    constexpr double kTable[][2] = {{0.30, 0.7256}, {0.50, 0.6515}, {0.70, 0.6093}, {0.85, 0.5992}, {1.00, 0.6098}, {1.20, 0.6535}};
    for (const auto& [x, share] : kTable) {
        const double foot = std::sqrt(2 * kPiD * share) * std::pow(x, 1.5);  // V = 2 pi r share, r = x V^(1/3)
        EXPECT_NEAR(fallenVolume(foot) / (2 * kPiD * foot), share, 0.015 * share) << x;
    }
}

// The vertical forces on a drop: its weight and the pressure over its foot hang on the tension along the foot. Pressure and tension follow
// from the outline: the curvature at the tip and the slope at the foot.
TEST(PendantDrop, EveryShapeIsInEquilibrium) {
    for (const double advancing : {50.0, 60.0, 90.0}) {
        const PendantDrop drop(advancing, 0.7 * advancing);
        for (const double share : {0.1, 0.3, 0.5, 0.7, 0.9, 1.0}) {
            const double volume = share * drop.largest(0);
            const DropProfile p = drop.profile(0, volume);
            EXPECT_NEAR(p.volume(), volume, 0.015 * volume);
            const double foot = std::sqrt(p.square(0)), step = 1.0e-4,
                         slope = (p.square(step) - p.square(0)) / (step * p.length) / (2 * foot);
            const double tip = 2 * p.length / (p.square(1 - step) / step);  // curvature
            const double up = 2 * kPiD * foot / std::sqrt(1 + slope * slope), pressure = 2 * tip - p.length;
            EXPECT_NEAR(up - kPiD * foot * foot * pressure, volume, 0.06 * (volume + up)) << advancing << " " << share;
        }
    }
}

// Wente 1980: on a level plate an inflection appears before the drop becomes unstable. A small drop is a cap.
TEST(PendantDrop, TheLargestHasANeckAndASmallOneNone) {
    const PendantDrop drop(60, 40);
    const auto bends = [&](double share) {  // how often the curvature of the outline changes its sign
        const DropProfile p = drop.profile(0, share * drop.largest(0));
        int changes = 0;
        double before = 0;
        for (int k = 1; k < 19; ++k) {
            const auto r = [&](double s) { return std::sqrt(p.square(s)); };
            const double curve = r(0.05 * k - 0.02) + r(0.05 * k + 0.02) - 2 * r(0.05 * k);
            changes += before * curve < 0 ? 1 : 0;
            before = curve;
        }
        return changes;
    };
    EXPECT_EQ(bends(0.1), 0);
    EXPECT_EQ(bends(1), 1);
}

TEST(PendantDrop, LessHangsFromATipAndFromWhatWetsLess) {
    const PendantDrop tear(60, 40);
    for (double bend = 0; bend < 0.99; bend += 0.1) EXPECT_LT(tear.largest(bend + 0.1), tear.largest(bend));
    double last = 1.0e9;
    for (const double advancing : {10.0, 30.0, 60.0, 90.0, 120.0, 150.0, 175.0}) {
        const PendantDrop drop(advancing, 0.7 * advancing);
        EXPECT_LT(drop.largest(0), last) << advancing;
        last = drop.largest(0);
        // Of a liquid that wets, more hangs than Tate's law lets fall from the same foot, and less than all of it falls.
        EXPECT_GT(drop.falls(0), 0.55);
        EXPECT_LT(drop.falls(0), 1);
    }
}

// A drop that grows on the underside of a level plate, of a ball. It lets go at the volume that a program of its own found, by the same
// equation, for that plate: 9.53 l^3; what falls from it is 5.95 l^3 (a tip of 1.58 l), and the rest stays.
TEST(FlowHanging, GrowsLetsGoAndLeavesTheRestOnTheSkin) {
    auto device = cpu();
    const Shape plate = sheetShape(vec3(-0.02F, 0, -0.02F), vec3(0.04F, 0, 0), vec3(0, 0, 0.04F), 16, 16), ball = ballShape(0.012F, 24);
    const SurfaceFlowParams p;
    const vec3 gravity(0, -9.81F, 0);
    const double l = std::sqrt(double{p.surfaceTension} / (double{p.density} * 9.81)), cube = l * l * l * 1.0e9;  // ul
    double fromPlate = 0;
    for (const bool level : {true, false}) {
        SurfaceFlow flow = flowOn(*device, level ? plate : ball, p);
        const SkinPoint at = nearestPoint(flow.mesh(), level ? vec3(0.0012F, 0, 0.0007F) : vec3(0.0004F, -0.012F, 0.0003F));
        std::vector<LeftDrop> left;
        double most = 0;
        for (int k = 0; k < 1200 && left.empty(); ++k) {
            flow.add(at, kMicrolitres / 4);
            ASSERT_TRUE(flow.step({.gravity = gravity}, 1.0 / 60));
            for (const SkinDrop& d : flow.drops()) most = std::max(most, d.volume * 1.0e9);
            left = flow.takeLeft();
        }
        ASSERT_EQ(left.size(), 1U) << level;
        ASSERT_TRUE(left[0].hung);
        const SurfaceFlow::Ledger ledger = flow.ledger();
        EXPECT_EQ(ledger.added, ledger.drops + ledger.film + ledger.left + ledger.evaporated + ledger.refused);
        const double fallen = left[0].picolitres * 1.0e-6, stayed = static_cast<double>(ledger.drops) * 1.0e-6;
        if (level) {
            fromPlate = most;
            EXPECT_NEAR(most, 9.53 * cube, 0.02 * 9.53 * cube);
            EXPECT_NEAR(fallen, 5.95 * cube, 0.03 * 5.95 * cube);
        } else {
            // The ball has 1 / 12 mm: less hangs than from the plate, between that of 1 / 24 mm and that of 1 / 8 mm.
            EXPECT_LT(most, flow.pendant()->largest(l / 0.024) * cube);
            EXPECT_GT(most, flow.pendant()->largest(l / 0.008) * cube);
            EXPECT_LT(most, 0.85 * fromPlate);
        }
        EXPECT_NEAR(fallen + stayed, most, 0.6);  // and what was added since
        EXPECT_GT(stayed, 0.2 * most);
        // What stays hangs on.
        for (int k = 0; k < 10; ++k) ASSERT_TRUE(flow.step({.gravity = gravity}, 1.0 / 60));
        ASSERT_EQ(flow.hanging().size(), 1U);
        EXPECT_NEAR(flow.hanging()[0].picolitres * 1.0e-6, stayed, 0.01);
    }
}

// From the drop that hangs to the ball that falls: the shape is continuous, it goes down, and it does not land where it came from.
TEST(FlowHanging, ADropThatLetsGoFallsOnANeck) {
    auto device = cpu();
    SurfaceFlow flow = flowOn(*device, ballShape(0.012F, 24));
    PlacedFlow placed(flow, [](double) { return dmat4(1.0); });
    PlacedFlow* const skins[] = {&placed};
    const SkinPoint at = nearestPoint(flow.mesh(), vec3(0.0004F, -0.012F, 0.0003F));
    const vec3 gravity(0, -9.81F, 0), wind(0.0F);
    constexpr double kStep = 1.0 / 480;
    flow.add(at, 60 * kMicrolitres);
    AirDrops air;
    double time = 0, tip = 0;
    int frames = 0;
    for (int k = 0; k < 2000; ++k, time += kStep) {
        if (air.drops().empty() && k % 8 == 0) flow.add(at, kMicrolitres / 4);
        ASSERT_TRUE(air.step({.skins = skins, .gravity = gravity, .winds = std::span(&wind, 1), .floor = -10, .time = time}, kStep));
        placed.moveTo(time + kStep);
        ASSERT_TRUE(flow.step({.gravity = gravity}, kStep));
        for (const LeftDrop& d : flow.takeLeft()) {
            AirDrop drop{dvec3(d.position), dvec3(d.velocity), d.picolitres};
            ASSERT_TRUE(d.hung);
            drop.hung = placed.hung(*d.hung);
            air.add(drop);
        }
        if (air.drops().empty()) {
            const std::vector<HungDrop> hanging = placed.hanging();
            if (hanging.size() == 1) tip = hanging[0].tip().y;
            continue;
        }
        ASSERT_EQ(air.drops().size(), 1U);
        const std::vector<AirDrops::LetGo> shapes = air.letGo(skins);
        if (shapes.empty()) break;  // it is a ball
        ++frames;
        const double now = shapes[0].shape.tip().y;
        EXPECT_LT(now, tip + 1.0e-4) << frames;
        EXPECT_GT(now, tip - 1.5e-3) << frames;  // m: no jump
        tip = now;
        const DropProfile& p = shapes[0].shape.profile;
        const double volume = air.drops()[0].picolitres * 1.0e-15;
        EXPECT_GT(p.volume(), 0.95 * volume) << frames;
        EXPECT_LT(p.volume(), 2 * volume) << frames;  // with what its neck takes of what stays
        for (int s = 0; s <= 20; ++s) EXPECT_GT(p.square(0.05 * s), -1.0e-7) << frames << " " << s;
    }
    EXPECT_GT(frames, 20);
    ASSERT_EQ(air.drawn().size(), 2U);
    EXPECT_LT(air.drawn()[0].y, -0.016F);
}

}  // namespace
}  // namespace rivulet::pendant_test
