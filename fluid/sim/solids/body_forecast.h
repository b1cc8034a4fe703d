// Where bodies are that a GPU moves, while the host knows them some frames late: their states now, and balls that they do not leave.
#pragma once

#include <span>
#include <vector>

#include "fluid/sim/solids/bodies.h"

namespace rivulet {

class BodyForecast {
  public:
    explicit BodyForecast(std::span<const Body> bodies);
    // Their states at `time` (s), and the accelerations (m/s^2) that they had lately, contacts left out.
    void set(std::span<const BodyState> states, std::span<const vec3> accelerations, double time);
    // Their states at a later time, when nothing has touched them since. Returns false, and ignores them, if later ones are known already.
    bool arrived(std::span<const BodyState> states, double time);
    // Where they are expected at `time`: by their velocity, spin and mean acceleration before the last arrival.
    std::vector<BodyState> at(double time) const;
    // xyz (m), w (m): from `from` to `to` (s) the centre of mass stays within w of xyz, unless the mean acceleration since the last arrival
    // differs from the one before by more than kReserve times the largest of that, `gravity` and kLeast (m/s^2).
    std::vector<vec4> balls(double from, double to, float gravity) const;
    // m/s^2: how much faster than expected the body's velocity may have changed.
    float reserve(size_t body, float gravity) const;
    // A body left its ball: from now on its reserve is twice as large.
    void strayed(size_t body) { trust_[body] *= 2; }
    double time() const { return time_; }  // s, of the last arrival

    static constexpr float kReserve = 2;
    static constexpr float kLeast = 1;  // m/s^2

  private:
    std::vector<BodyState> states_;
    std::vector<vec3> acceleration_;  // m/s^2, mean before the last arrival
    std::vector<float> trust_;        // factor of kReserve
    std::vector<bool> moves_;         // false: has no mass
    double time_ = 0;
};

}  // namespace rivulet
