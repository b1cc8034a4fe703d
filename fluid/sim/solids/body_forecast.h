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
    // differs from the one before by more than kReserve times the largest of that, `gravity` and kLeast (m/s^2), or than what strays have
    // made of it.
    std::vector<vec4> balls(double from, double to, float gravity) const;
    // m/s: how much faster than expected the body may be at `time`. Not more than its speed and kBlow: the water's own speed limits steps,
    // too.
    float gain(size_t body, double time) const;
    // A frame in which it left its ball: its reserve is twice as large. It falls back to kReserve, by half in about 35 frames without.
    void frame(size_t body, bool strayed);
    double time() const { return time_; }  // s, of the last arrival

    static constexpr float kReserve = 2;
    static constexpr float kLeast = 1;  // m/s^2
    static constexpr float kBlow = 1;   // m/s

  private:
    // m/s^2: how far the mean acceleration may be from the expected one.
    float reserve(size_t body, float gravity) const;
    std::vector<BodyState> states_;
    std::vector<vec3> acceleration_;  // m/s^2, mean before the last arrival
    std::vector<float> trust_;        // factor of kReserve
    std::vector<bool> moves_;         // false: has no mass
    double time_ = 0;
};

}  // namespace rivulet
