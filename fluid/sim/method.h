// A Method advances velocities for one substep: pressure, viscosity, gravity. Methods are rows of methods().
#pragma once

#include <memory>

#include "engine/compute/device.h"
#include "engine/core/table.h"
#include "fluid/sim/fluid_params.h"
#include "fluid/sim/neighbor_grid.h"
#include "fluid/sim/particles.h"
#include "shaders/fluid/step_params.h"

namespace rivulet {

// Everything a step needs is handed to it.
struct StepContext {
    Device& device;
    const StepParams& params;
    const NeighborGrid& grid;  // built for this step
    Particles& particles;      // boundary is filled when the method uses walls in its density
};

class Method {
  public:
    virtual ~Method() = default;
    // Fills the method's part of StepParams (kernel factors, stiffness). `soundSpeed` m/s.
    virtual void fill(const FluidParams& params, float soundSpeed, StepParams& step) const = 0;
    // Speed of sound of its equation of state, m/s; `fastest`: the speed the scene's water can reach by falling, m/s.
    virtual float soundSpeed(const FluidParams& params, float fastest) const = 0;
    virtual bool wallsInDensity() const = 0;
    // Reads position, velocity; writes acceleration and density (what else it needs is its own).
    virtual void step(StepContext& context) = 0;
};

struct MethodRow {
    const char* name;
    const char* doc;
    Result<std::unique_ptr<Method>> (*make)(Device& device);
};
Table<MethodRow> methods();

}  // namespace rivulet
