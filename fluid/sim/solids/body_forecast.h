// Where bodies are that a GPU moves, while the host knows them some frames late: their states now, and balls that they do not leave.
#pragma once

#include <span>
#include <vector>

#include "fluid/sim/solids/bodies.h"

namespace rivulet {

class BodyForecast {
  public:
    explicit BodyForecast(std::span<const Body> bodies);
    // Their states at `time` (s), and the fluid's mean forces (N) and torques (N m) on them in the frame before.
    void set(std::span<const BodyState> states, std::span<const BodyLoad> loads, double time);
    // The same of a later time. Returns false, and ignores them, if later ones are known already.
    bool arrived(std::span<const BodyState> states, std::span<const BodyLoad> loads, double time);
    // Expects their path from there to `now`, and on to `end`, under these loads: freely, or with the contacts that `host` (may be null)
    // predicts.
    void expect(const BodyHost* host, const vec3& gravity, double now, double end);
    // All were slow, in that report and the one before; then they may be expected to stay until `end`, if nothing pulls them.
    bool rest() const { return rests_; }
    void expectRest(double end);
    // Where they are expected at `time`.
    std::vector<BodyState> at(double time) const;
    // xyz (m), w (m): from `from` to `to` (s) the centre of mass stays within w of xyz, unless the mean acceleration since the last arrival
    // differs from the expected one by more than kReserve times the largest of that, `gravity` and kLeast (m/s^2), or than what strays have
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
    struct Moment {
        double time;  // s
        std::vector<BodyState> states;
    };
    // m/s^2: how far the mean acceleration may be from the expected one.
    float reserve(size_t body, float gravity) const;
    std::vector<BodyState> onward(const Moment& from, double time) const;  // freely
    std::vector<BodyState> states_;
    std::vector<BodyLoad> loads_;
    std::vector<vec3> acceleration_;  // m/s^2, by loads and gravity
    std::vector<Moment> path_;        // in order of time
    std::vector<float> trust_;        // factor of kReserve
    std::vector<float> mass_;         // kg; 0: it does not move
    std::vector<float> reach_;        // m, from the centre of mass to the farthest sample
    double time_ = 0;
    bool known_ = false;  // by a report
    bool rests_ = false;  // all of them
};

}  // namespace rivulet
