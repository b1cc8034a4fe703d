// Where bodies are expected that a GPU moves: the host's engine is asked only where something moves.
#include "fluid/sim/solids/body_forecast.h"

#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "fluid/sim/solids/body_shapes.h"

namespace rivulet::body_forecast_test {
namespace {

constexpr double kFrame = 1.0 / 60;  // s
const vec3 kGravity(0, -9.81F, 0);

// An engine that counts the calls, and lets everything fall.
struct Engine {
    int asked = 0;
    BodyHost host() {
        BodyHost h;
        h.self = this;
        h.predict = [](void* self, std::span<const BodyLoad>, const vec3& gravity, double, double seconds, std::span<BodyState> states) {
            ++static_cast<Engine*>(self)->asked;
            const auto t = static_cast<float>(seconds);
            for (BodyState& s : states) {
                s.velocity += t * gravity;
                s.pose.position += t * s.velocity;
            }
        };
        return h;
    }
};

// Two bodies: `speeds` of the second in the reports of three frames. Returns how often the engine is asked after the last.
int askedAfter(std::span<const float> speeds, std::vector<BodyState>& then) {
    std::vector<Body> bodies(2);
    for (Body& b : bodies) b.shape = boxShape(vec3(0.2F), 500, 0.05F);
    BodyForecast forecast(bodies);
    Engine engine;
    const BodyHost host = engine.host();
    double time = 0;
    for (const float speed : speeds) {
        std::vector<BodyState> states(2);
        states[1].pose.position.x = 1;
        states[1].velocity.y = speed;
        EXPECT_TRUE(forecast.arrived(states, std::vector<BodyLoad>(2), time += kFrame));
        engine.asked = 0;
        forecast.expect(&host, kGravity, time + 3 * kFrame, time + 4 * kFrame);
    }
    then = forecast.at(time + 4 * kFrame);
    return engine.asked;
}

TEST(BodyForecast, AsksTheEngineOnlyWhereSomethingMoves) {
    std::vector<BodyState> then;
    const std::vector<float> resting = {0.01F, -0.01F, 0.005F}, falling = {0, 0, -0.2F}, turningBack = {0.16F, 0.0F, -0.16F};
    EXPECT_EQ(askedAfter(resting, then), 0);
    EXPECT_EQ(then[1].pose.position, vec3(1, 0, 0)) << "it stays";
    EXPECT_GT(askedAfter(falling, then), 0) << "one of two is enough";
    EXPECT_LT(then[1].pose.position.y, -0.02F);
    EXPECT_GT(askedAfter(std::span(turningBack).first(2), then), 0) << "slow, but not for two frames";
    EXPECT_GT(askedAfter(std::span(resting).first(1), then), 0) << "one report tells nothing";
}

}  // namespace
}  // namespace rivulet::body_forecast_test
