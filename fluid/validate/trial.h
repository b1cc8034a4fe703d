// Trial: the running scene of a physics case, with its cost.
#pragma once

#include <memory>

#include "fluid/session/run_stats.h"
#include "fluid/session/session.h"
#include "fluid/validate/physics_case.h"

namespace rivulet {

// Changes particles of a world in place (position: xyz m, w < 0 removes the particle; velocity: m/s). Error: as FluidWorld::savable.
Status changeParticles(FluidWorld& world, const std::function<void(vec4& position, vec4& velocity)>& each);

// The amplitude of a velocity field `mode` in the velocities of particles, by least squares.
double amplitudeOf(const HostParticles& particles, const std::function<dvec3(const dvec3&)>& mode);

// The zeros of a curve, by linear interpolation between its points.
std::vector<double> zerosOf(std::span<const glm::dvec2> curve);

class Trial {
  public:
    // Opens cases/`name`.json with the requested method and assignments. Error: as loadScene and Session::create.
    static Result<Trial> open(const char* name, const CaseSettings& settings);

    const FluidParams& params() const { return session_->world().params(); }
    FluidWorld& world() { return session_->world(); }
    const SceneFile& scene() const { return session_->scene(); }
    double time() const { return session_->world().time(); }

    // Sets the velocity (m/s) of each particle by its position.
    Status setVelocities(const std::function<dvec3(const dvec3&)>& at);
    // Removes particles at positions where `where` is false.
    Status keep(const std::function<bool(const dvec3&)>& where);
    // Runs frames of `frame` s until the duration of the scene or `until` (s) and calls `each` after every frame. false: the run was
    // stopped, or its device has failed.
    bool run(double frame, const std::function<void()>& each, double until = 3600);
    HostParticles particles() const { return readParticles(session_->world()); }

    // The findings with the cost of the run. Error (failed): as FluidWorld::lastStep, if that ended the run.
    Result<Outcome> outcome(std::vector<Finding> findings, Plot plot) const;

  private:
    Trial() = default;
    std::unique_ptr<Session> session_;
    std::function<bool(double)> goOn_;
    double wall_ = 0, compression_ = 0;
    uint64_t steps_ = 0;
    double awake_ = 0;  // particles times substeps, if none slept
    Status stepped_ = ok();
};

}  // namespace rivulet
