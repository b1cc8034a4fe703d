// The look of a fluid without settings of its own.
#include <gtest/gtest.h>

#include "fluid/render/look_params.h"
#include "fluid/sim/sources/liquids.h"

namespace rivulet::liquid_look_test {
namespace {

// A metre of pure water lets pass e^-a of red, green and blue light; a from table III of Pope and Fry 1997: 0.2755 at 620 nm, 0.0565 at 550
// nm, 0.00922 at 450 nm.
TEST(LiquidLook, withoutALiquidItIsPureWater) {
    const Result<FluidLook> look = fluidLookOf({}, "");
    ASSERT_TRUE(look) << look.error().message;
    EXPECT_FLOAT_EQ(look->absorption.r, 0.2755F);
    EXPECT_FLOAT_EQ(look->absorption.g, 0.0565F);
    EXPECT_FLOAT_EQ(look->absorption.b, 0.00922F);
    EXPECT_FLOAT_EQ(look->refractiveIndex, 1.333F);
    EXPECT_LT(look->scattering.b, 0.005F);
    const FluidLook plain;  // a host's, without a scene
    for (int k = 0; k < 3; ++k) {
        EXPECT_FLOAT_EQ(plain.absorption[k], look->absorption[k]);
        EXPECT_NEAR(plain.scattering[k], look->scattering[k], 1.0e-5F);
    }
}

TEST(LiquidLook, aSceneOrItsLiquidDecides) {
    FluidLookParams own;
    own.absorption = vec3(1.0F, 2.0F, 3.0F);
    const Result<FluidLook> milk = fluidLookOf({}, "milk"), tinted = fluidLookOf(own, "milk");
    ASSERT_TRUE(milk && tinted);
    EXPECT_EQ(milk->absorption, liquids().find("milk")->absorption);
    EXPECT_EQ(tinted->absorption, own.absorption);
    EXPECT_EQ(tinted->scattering, liquids().find("milk")->scattering);
}

}  // namespace
}  // namespace rivulet::liquid_look_test
