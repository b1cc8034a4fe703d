// Eyeballs turn as rigid bodies, and a blink ends where the lids meet.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/scene/eye_motion.h"

namespace rivulet::eye_motion_test {
namespace {

const vec3 kCentre(0.03F, 0.02F, 0.01F);
constexpr float kRadius = 0.012F;

MorphTarget rotated(const std::vector<vec3>& rest, const std::string& name, float degrees, const vec3& axis) {
    const mat3 turn(glm::rotate(mat4(1.0F), degrees * kDegree, axis));
    MorphTarget morph{name, {}, {}};
    for (uint32_t v = 0; v < rest.size(); ++v) {
        morph.vertices.push_back(v);
        morph.offsets.push_back(kCentre + turn * (rest[v] - kCentre) - rest[v]);
    }
    return morph;
}

ModelPart ball() {
    ModelPart part;
    for (int i = 0; i < 40; ++i) {
        const float z = 1 - static_cast<float>(i) / 20, a = static_cast<float>(i) * 2.4F, r = std::sqrt(std::max(1 - z * z, 0.0F));
        part.mesh.positions.push_back(kCentre + kRadius * vec3(r * std::cos(a), r * std::sin(a), z));
    }
    const std::vector<vec3> rest = part.mesh.positions;
    part.morphs = {rotated(rest, "lookLeft", 25, {0, 1, 0}), rotated(rest, "lookDown", 20, {1, 0, 0})};
    return part;
}

TEST(EyeMotion, aBallTurnsByTheShareOfItsTargetAndKeepsItsRadius) {
    ModelPart part = ball();
    const std::vector<vec3> whole = [&] {
        std::vector<vec3> x = part.mesh.positions;
        for (size_t v = 0; v < x.size(); ++v) x[v] += part.morphs[0].offsets[v];
        return x;
    }();
    const vec3 centres[] = {vec3(0.0F), kCentre};
    const std::optional<EyeTurns> eye = takeEyeTurns(part, centres);
    ASSERT_TRUE(eye);
    EXPECT_TRUE(part.morphs.empty()) << "nothing deforms it any more";
    ASSERT_EQ(eye->turns.size(), 2U);
    EXPECT_NEAR(glm::length(eye->turns.at("lookLeft")), 25 * kDegree, 1e-3F);
    EXPECT_GT(eye->turns.at("lookDown").x, 0.3F);
    for (const float weight : {0.0F, 0.5F, 1.0F}) {
        const mat4 turn = eye->at(weight * eye->turns.at("lookLeft"));
        for (size_t v = 0; v < whole.size(); ++v) {
            const vec3 x(turn * vec4(part.mesh.positions[v], 1));
            EXPECT_NEAR(glm::distance(x, kCentre), kRadius, 1e-6F);
            if (weight == 1) EXPECT_LT(glm::distance(x, whole[v]), 1e-6F);
        }
    }
}

TEST(EyeMotion, aPartWithAnotherTargetStaysDeformed) {
    ModelPart part = ball();
    part.morphs[1].offsets[3] += vec3(0, 0.004F, 0);
    const vec3 centres[] = {kCentre};
    EXPECT_FALSE(takeEyeTurns(part, centres));
    EXPECT_EQ(part.morphs.size(), 2U);
}

TEST(EyeMotion, sharesOfABlinkAreThoseWhereItMovesFurthest) {
    const std::vector<MorphTarget> morphs = {{"blink", {1, 4, 6}, {{0, -1, 0}, {0, -3, 1}, {0, -2, 0}}},
                                             {"lookDown", {4, 6}, {{0, -1.5F, 0.5F}, {0, -7, 0}}},
                                             {"smile", {1}, {{0, 5, 0}}}};
    const std::vector<float> shares = sharesOfBlink(morphs, 0);
    ASSERT_EQ(shares.size(), 3U);
    EXPECT_FLOAT_EQ(shares[0], 1);
    EXPECT_FLOAT_EQ(shares[1], 0.5F);
    EXPECT_FLOAT_EQ(shares[2], 0);
}

}  // namespace
}  // namespace rivulet::eye_motion_test
