#include "fluid/sim/solids/body_forecast.h"

#include <algorithm>
#include <cmath>

namespace rivulet {

BodyForecast::BodyForecast(std::span<const Body> bodies)
    : states_(bodies.size()), acceleration_(bodies.size(), vec3(0.0F)), trust_(bodies.size(), 1.0F) {
    moves_.reserve(bodies.size());
    for (const Body& b : bodies) moves_.push_back(b.shape.mass > 0);
}

void BodyForecast::set(std::span<const BodyState> states, std::span<const vec3> accelerations, double time) {
    states_.assign(states.begin(), states.end());
    acceleration_.assign(accelerations.begin(), accelerations.end());
    time_ = time;
}

bool BodyForecast::arrived(std::span<const BodyState> states, double time) {
    if (!(time > time_)) return false;
    for (size_t k = 0; k < states_.size(); ++k)
        acceleration_[k] = (states[k].velocity - states_[k].velocity) / static_cast<float>(time - time_);
    states_.assign(states.begin(), states.end());
    time_ = time;
    return true;
}

std::vector<BodyState> BodyForecast::at(double time) const {
    std::vector<BodyState> then = states_;
    const auto t = static_cast<float>(time - time_);
    for (size_t k = 0; k < then.size(); ++k) {
        if (!moves_[k]) continue;
        BodyState& s = then[k];
        s.pose.position += t * (s.velocity + 0.5F * t * acceleration_[k]);
        s.velocity += t * acceleration_[k];
        if (const float rate = glm::length(s.spin); rate * t > 0)
            s.pose.rotation = glm::normalize(glm::angleAxis(rate * t, s.spin / rate) * s.pose.rotation);
    }
    return then;
}

float BodyForecast::gain(size_t body, double time) const {
    const float most = glm::length(states_[body].velocity) + kBlow;
    return std::min(kReserve * std::max(glm::length(acceleration_[body]), kLeast) * static_cast<float>(time - time_), most);
}

void BodyForecast::frame(size_t body, bool strayed) {
    constexpr float kMost = 64, kForgets = 0.98F;
    float& t = trust_[body];
    t = strayed ? std::min(2 * t, kMost) : std::max(kForgets * t, 1.0F);
}

float BodyForecast::reserve(size_t body, float gravity) const {
    return kReserve * trust_[body] * std::max({glm::length(acceleration_[body]), gravity, kLeast});
}

std::vector<vec4> BodyForecast::balls(double from, double to, float gravity) const {
    const std::vector<BodyState> begin = at(from), end = at(to);
    std::vector<vec4> balls;
    balls.reserve(states_.size());
    const auto since = static_cast<float>(to - time_), length = static_cast<float>(to - from);
    for (size_t k = 0; k < states_.size(); ++k) {
        if (!moves_[k]) {
            balls.emplace_back(states_[k].pose.position, 0.0F);
            continue;
        }
        const vec3 &a = begin[k].pose.position, &b = end[k].pose.position;
        // The path between is a parabola, which is off its chord by an eighth of its acceleration at most.
        const float bent = 0.125F * glm::length(acceleration_[k]) * length * length;
        balls.emplace_back(0.5F * (a + b), 0.5F * glm::length(b - a) + bent + 0.5F * reserve(k, gravity) * since * since);
    }
    return balls;
}

}  // namespace rivulet
