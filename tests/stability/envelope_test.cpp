// The stability envelope, one test per row: with the limits on, all is finite, bounded and present, and the limits are reported; with them
// off it fails where the literature predicts, within the factor that its margin explains. Predictors are sufficient conditions, so
// a ratio below 1 (less the tenth to which a threshold is known) needs a reason, and is given one.
#include <gtest/gtest.h>

#include <cstdio>

#include "fluid/validate/envelope.h"
#include "tests/physics/worlds.h"

namespace rivulet::envelope_test {
namespace {

constexpr double kKnown = 0.9;  // a threshold is known to a tenth
constexpr const char* kCut = "is cut into shorter steps";

std::vector<EnvelopeFinding> findings(const char* name) {
    auto device = cpu();
    const EnvelopeRow* row = envelope().find(name);
    EXPECT_NE(row, nullptr) << name;
    if (row == nullptr) return {};
    Result<std::vector<EnvelopeFinding>> found = row->run({.device = device.get()});
    EXPECT_TRUE(found) << (found ? "" : found.error().message);
    if (!found) return {};
    EXPECT_FALSE(found->empty()) << name << " has nothing to say";
    for (const EnvelopeFinding& f : *found) {
        std::printf("%s, %s: predicted %.4g %s, measured %s%.4g, ratio %.3g; asked for %.4g, %llu steps\n", f.method.c_str(),
                    f.what.c_str(), f.predicted, f.unit.c_str(), f.measured ? "" : "none to ", f.measured.value_or(f.reached), f.ratio(),
                    f.limited.asked, static_cast<unsigned long long>(f.limited.steps));
        EXPECT_EQ(f.row, name);
    }
    return *found;
}

void expectHolds(const EnvelopeFinding& f, const char* notice = "") {
    EXPECT_TRUE(f.limited.finite) << f.method << ", " << f.what;
    EXPECT_TRUE(f.limited.bounded) << f.method << ", " << f.what;
    EXPECT_TRUE(f.limited.nothingLost) << f.method << ", " << f.what;
    EXPECT_NE(f.limited.notice.find(notice), std::string::npos) << f.method << ", " << f.what << ": " << f.limited.notice;
}

// With the limits off, from `low` to `high` times the predictor.
void expectFailsAt(const EnvelopeFinding& f, double low, double high) {
    ASSERT_TRUE(f.measured) << f.method << ", " << f.what << " never failed";
    EXPECT_GE(f.ratio(), low) << f.method << ", " << f.what;
    EXPECT_LE(f.ratio(), high) << f.method << ", " << f.what;
}

// 0.4 hs / (c0 + v) is a margin on w dt < 2. The stiffest mode that this lattice knows has w near c0 / hs, so 2 hs / c0 and 5 times the
// predictor are to be expected, more where viscosity takes what a step gives.
TEST(Envelope, Sound) {
    const std::vector<EnvelopeFinding> all = findings("sound");
    ASSERT_EQ(all.size(), 3U);
    for (const EnvelopeFinding& f : all) {
        expectFailsAt(f, 1, 8);
        if (f.method == "wcsph") expectHolds(f, kCut);
    }
    // Ten times the speed of sound, a tenth of the step.
    EXPECT_NEAR(*all[0].measured / *all[1].measured, (300.0 + 3.1) / (30.0 + 3.1), 3);
}

// The shortest wave of a lattice decays at 8 to 14 nu / hs^2, and dt w < 2 is 0.14 to 0.25 hs^2 / nu.
TEST(Envelope, Viscosity) {
    for (const EnvelopeFinding& f : findings("viscosity")) {
        expectFailsAt(f, 0.14 / 0.125 * kKnown, 2);
        expectHolds(f, "viscosity");
    }
}

// A wave of k grows where a step is longer than 2 / w, w^2 = sigma k^3 / rho: with the shortest that a lattice knows, k = pi / hs, that is
// 3.6 times the predictor. Particles pull along the surface as far as their support, 2 hs: shorter waves feel no tension, and it can be
// 2^1.5 times as long, 10.2.
// dfsph holds longer than pbf: twice the predictor's margin (ratios of 5.2 and 10.4).
TEST(Envelope, Tension) {
    for (const EnvelopeFinding& f : findings("tension")) {
        expectFailsAt(f, 3.6 * kKnown, f.method == "dfsph" ? 10.6 : 10.2);
        expectHolds(f, kCut);
    }
}

TEST(Envelope, LargeSteps) {
    for (const EnvelopeFinding& f : findings("large_steps")) {
        expectFailsAt(f, kKnown, 4);
        expectHolds(f, kCut);
    }
}

// PBF fails a little before a fall of a whole diameter: its three corrections permit steps of 17 ms at this height (see Pbf), not of 45.
TEST(Envelope, FrameSpike) {
    for (const EnvelopeFinding& f : findings("frame_spike")) {
        expectFailsAt(f, f.method == "pbf" ? 0.7 : kKnown, 4);
        EXPECT_EQ(f.limited.asked, 0.25);
        expectHolds(f, "longestFrame");
    }
}

// The predictor is exact to first order: where a column's floor would be a tenth too dense. A single correction that goes the whole way
// overshoots (a Jacobi iteration of a matrix whose largest eigenvalue is above 2) and stands a third of it; half the way stands more.
TEST(Envelope, Pbf) {
    const std::vector<EnvelopeFinding> all = findings("pbf");
    ASSERT_EQ(all.size(), 4U);
    expectFailsAt(all[0], kKnown, 2);
    expectFailsAt(all[1], 0.5, 1.3);
    expectFailsAt(all[2], 0.8, 1.3);
    expectFailsAt(all[3], 0.8, 1.3);
    for (const EnvelopeFinding& f : all) expectHolds(f, kCut);
}

// All of the last step's pressure as the next one's start, without a gate, adds no more energy than none of it: none at any step.
TEST(Envelope, Dfsph) {
    const std::vector<EnvelopeFinding> all = findings("dfsph");
    ASSERT_EQ(all.size(), 3U);
    for (const EnvelopeFinding& f : all) {
        EXPECT_FALSE(f.measured) << f.what << " gains energy at " << f.measured.value_or(0);
        EXPECT_GE(f.reached, 60 * f.predicted) << f.what;
        expectHolds(f, kCut);
    }
}

// Dehnen and Aly's own simulations paired above 55; theirs have h and masses that differ, and a glass pairs a little later than a lattice.
TEST(Envelope, Pairing) {
    const std::vector<EnvelopeFinding> all = findings("pairing");
    ASSERT_EQ(all.size(), 2U);
    expectFailsAt(all[0], kKnown, 1.3);
    EXPECT_TRUE(all[0].limited.nothingLost && all[0].limited.finite);
    EXPECT_NE(all[0].limited.notice.find("form pairs"), std::string::npos) << all[0].limited.notice;
    EXPECT_FALSE(all[1].measured) << "Wendland C2 pairs at " << all[1].measured.value_or(0);
    EXPECT_GT(all[1].reached, 260);
    expectHolds(all[1]);
}

TEST(Envelope, Clumping) {
    for (const EnvelopeFinding& f : findings("clumping")) {
        if (f.method == "wcsph_thesis") {
            expectFailsAt(f, 1, 1);
            EXPECT_TRUE(f.limited.finite && f.limited.nothingLost);
            continue;
        }
        EXPECT_FALSE(f.measured) << f.method << " clumps at " << f.measured.value_or(0);
        expectHolds(f);
    }
}

// Floats are 2^-10 m apart from 8192 m on: more than twice 0.4 mm.
TEST(Envelope, FarOrigin) {
    for (const EnvelopeFinding& f : findings("far_origin")) {
        ASSERT_TRUE(f.measured);
        EXPECT_GE(*f.measured, 8192) << f.method;
        EXPECT_LE(*f.measured, 8192 * 1.1) << f.method;
        expectHolds(f);
    }
}

// Without end, but for slides that end outside the box (see the row's remark); the thesis's walk lets some pass.
TEST(Envelope, Tunnelling) {
    for (const EnvelopeFinding& f : findings("tunnelling")) {
        EXPECT_GE(f.ratio(), f.what.find("exact") != std::string::npos ? 4 : 1) << f.method << ", " << f.what;
        if (f.what.find("exact") != std::string::npos) expectHolds(f, kCut);
    }
}

// Finite and complete, for any number of particles spawned at one place.
// What pbf and wcsph throw apart is slowed; dfsph throws it less far, and its steps are cut.
TEST(Envelope, Spawning) {
    for (const EnvelopeFinding& f : findings("spawning")) {
        EXPECT_GE(f.ratio(), 1) << f.method;
        expectHolds(f, f.method == "dfsph" ? kCut : "slowed");
        if (f.method == "dfsph") EXPECT_EQ(f.limited.notice.find("slowed"), std::string::npos) << f.limited.notice;
    }
}

TEST(Envelope, Coupling) {
    for (const EnvelopeFinding& f : findings("coupling")) {
        EXPECT_FALSE(f.measured) << f.method << " throws the ball at " << f.measured.value_or(0);
        EXPECT_GE(f.reached, 100) << f.method;
        expectHolds(f);
    }
}

}  // namespace
}  // namespace rivulet::envelope_test
