// Everything a substep needs, handed to the Method and the forces.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/world/fluid_params.h"
#include "fluid/sim/world/particles.h"
#include "shaders/fluid/world/step_params.h"

namespace rivulet {

// Results of a pressure solver. On a GPU they arrive some frames late.
struct SolveFigures {
    double iterations = 0;           // of the last substep
    std::optional<double> residual;  // mean compression predicted at the end, a fraction; empty: the method predicts none
    uint64_t sweeps = 0;             // over all neighbours, of all kernels since the start
};

// Measures what walls do to particles in a substep. Each function is called beside the kernel whose effect it measures.
class WallLoads {
  public:
    virtual ~WallLoads() = default;
    // Pressure at walls: the images' part in pair forces at `position` (sorted; the grid was built at `home`), with particles.nearWalls
    // there, as found at `start`. `multiplier`: pressures in the form of the method's pair terms; `scale`: impulse (N s) over multiplier *
    // gradient.
    virtual void pressure(const StepParams& step, const Buffer& home, const Buffer& start, const Buffer& position, const Buffer& multiplier,
                          float scale) = 0;
    // The same for dfsph, at the end of its solve: `solve` as in dfsph_rate.kernel, particles.velocity with what stopped particles at
    // walls.
    virtual void solved(const StepParams& step, const Buffer& solve) = 0;
    // No-slip walls, with the result of StepContext::wallFriction, on particles of these velocities.
    virtual void friction(const StepParams& step, const Buffer& friction, const Buffer& velocity) = 0;
    // The box and the planes at the end of a step, as integrate.kernel: velocity + `share` * acceleration * dt from `position`.
    virtual void response(const StepParams& step, const Buffer& position, const Buffer& velocity, const Buffer& acceleration,
                          float share) = 0;
    // As pbf_finish.kernel and pbf_predict.kernel; the latter before it, on the newest state.
    virtual void responseFromPositions(const StepParams& step, const Buffer& start, const Buffer& corrected) = 0;
    virtual void predicted(const StepParams& step) = 0;
};

struct StepContext {
    Device& device;
    const FluidParams& fluid;
    const StepParams& params;
    NeighborGrid& grid;
    Particles& particles;
    SolveFigures& solve;
    double fastest = 0;   // m/s, the last measured value; on a GPU some frames old
    const Buffer& stats;  // rows of fluid/world/stats of the last measurement; for a kernel they are not late
    // Sorts the newest state into position and velocity, and advances solids and bodies. False: this failed, and the substep ends here.
    // `fromPositions`: velocityNext holds the previous positions, m.
    std::function<bool(bool fromPositions)> build;
    // Adds the fluid's forces on samples to the forces on bodies; empty in a world without bodies. `pressures`: of the fluid, in the form
    // of the method's pair terms; `scale`: acceleration of one particle (m/s^2) over pressure * gradient (1/m); `weight`: growth of the
    // pressure per metre beyond the fluid, in the same unit (wcsph: 0, because its kernel includes gravity).
    std::function<void(const Buffer& position, const Buffer& pressures, float scale, const vec3& weight)> pushSamples;
    const Buffer& planes;  // in the layout of integrate.kernel
    // Fills particles.nearWalls for these positions (in sorted order). Methods without walls in their density do not call it.
    std::function<void(const Buffer& position)> nearWalls;
    // Moves the planes of particles.nearWalls, which were right for particles at `from`, to particles at `to` (in sorted order).
    std::function<void(const Buffer& from, const Buffer& to)> followWalls = {};
    // True if any row of forces() is on.
    bool hasForces = false;
    // Adds the forces of all active rows of forces() to particles.acceleration, from the sorted position and velocity.
    std::function<void()> forces;
    // Computes the effect of no-slip walls at these positions (in sorted order): w sum of k (1/m^2), xyz sum of k times the wall's
    // velocity; the acceleration is nu (xyz - w v). Empty: there are no such walls.
    std::function<void(const Buffer& position, Buffer& friction)> wallFriction = {};
    // Adds the adhesion of walls at rest to particles.acceleration; `params`.force.w: see fluid/forces/wall_adhesion.
    std::function<void(const StepParams& params)> wallAdhesion = {};
    WallLoads* probes = nullptr;  // null in a world without probes

    // The params of a world without gravity.
    StepParams noGravity() const {
        StepParams p = params;
        p.gravity = vec4(0.0F);
        return p;
    }
};

// A kernel with FOR_NEIGHBORS, in the form that the world's particles need. It binds particles.matter itself if that is used.
struct PairKernel {
    Kernel kernel;
    bool matter = false;
    // `extra`: further defines.
    static Result<PairKernel> find(Device& device, std::string_view path, const PairTraits& traits, std::span<const Define> extra = {});
    void run(StepContext& context, const StepParams& params, std::initializer_list<const Buffer*> buffers, uint32_t threads) const;
    // The same outside a world's substep: the sweep is not counted.
    void run(Device& device, const Particles& particles, const StepParams& params, std::initializer_list<const Buffer*> buffers,
             uint32_t threads) const;
};

}  // namespace rivulet
