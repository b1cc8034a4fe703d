// Trial: a physics case's scene under way, with an eye on what it costs.
#pragma once

#include <memory>

#include "fluid/session/run_stats.h"
#include "fluid/session/session.h"
#include "fluid/validate/physics_case.h"

namespace rivulet {

// Changes the particles of a world where they stand (position: xyz m, w < 0 takes one away; velocity: m/s). Error: as FluidWorld::savable.
Status changeParticles(FluidWorld& world, const std::function<void(vec4& position, vec4& velocity)>& each);

// How much of a field of velocities is in those of particles: least squares.
double amplitudeOf(const HostParticles& particles, const std::function<dvec3(const dvec3&)>& mode);

// Where a curve passes zero, by straight lines between its points.
std::vector<double> zerosOf(std::span<const glm::dvec2> curve);

class Trial {
  public:
    // cases/`name`.json with the method and assignments that were asked for. Error: as loadScene and Session::create.
    static Result<Trial> open(const char* name, const CaseSettings& settings);

    const FluidParams& params() const { return session_->world().params(); }
    FluidWorld& world() { return session_->world(); }
    const SceneFile& scene() const { return session_->scene(); }
    double time() const { return session_->world().time(); }

    // Gives each particle the velocity (m/s) of its place.
    Status setVelocities(const std::function<dvec3(const dvec3&)>& at);
    // Leaves out the particles of other places.
    Status keep(const std::function<bool(const dvec3&)>& where);
    // Frames of `frame` s until the scene's duration, or until then (s), `each` after every one. false: it was stopped, or its device has
    // failed.
    bool run(double frame, const std::function<void()>& each, double until = 3600);
    HostParticles particles() const { return readParticles(session_->world()); }

    // What was found, with the cost of the way there.
    Outcome outcome(std::vector<Finding> findings, Plot plot) const;

  private:
    Trial() = default;
    std::unique_ptr<Session> session_;
    std::function<bool(double)> goOn_;
    double wall_ = 0, compression_ = 0;
    uint64_t steps_ = 0;
};

}  // namespace rivulet
