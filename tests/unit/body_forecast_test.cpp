// Where bodies are expected that a GPU moves: those that rest stay, without the host's engine.
#include "fluid/sim/solids/body_forecast.h"

#include <gtest/gtest.h>

#include <vector>

#include "fluid/sim/solids/body_shapes.h"

namespace rivulet::body_forecast_test {
namespace {

constexpr double kFrame = 1.0 / 60;  // s

// Two bodies, of which the second has these speeds in the reports of some frames.
BodyForecast after(const std::vector<float>& speeds) {
    std::vector<Body> bodies(2);
    for (Body& b : bodies) b.shape = boxShape(vec3(0.2F), 500, 0.05F);
    BodyForecast forecast(bodies);
    double time = 0;
    for (const float speed : speeds) {
        std::vector<BodyState> states(2);
        states[1].pose.position.x = 1;
        states[1].velocity.y = speed;
        EXPECT_TRUE(forecast.arrived(states, std::vector<BodyLoad>(2), time += kFrame));
    }
    return forecast;
}

TEST(BodyForecast, WhatIsSlowInTwoReportsRests) {
    BodyForecast resting = after({0.2F, -0.01F, 0.0F});
    ASSERT_TRUE(resting.rest());
    resting.expectRest(resting.time() + 4 * kFrame);
    EXPECT_EQ(resting.at(resting.time() + 3 * kFrame)[1].pose.position, vec3(1, 0, 0));
    EXPECT_FALSE(after({0, 0, -0.2F}).rest()) << "one of two falls";
    EXPECT_FALSE(after({0.16F, 0}).rest()) << "it turns back in the air: slow in one report";
    EXPECT_FALSE(after({0.01F}).rest()) << "one report tells nothing";
}

}  // namespace
}  // namespace rivulet::body_forecast_test
