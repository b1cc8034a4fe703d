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

// What a pressure solver did. On a GPU the figures come some frames late.
struct SolveFigures {
    double iterations = 0;           // of the last substep
    std::optional<double> residual;  // what it stopped at: mean compression it predicts, a fraction; of a method that knows
    uint64_t sweeps = 0;             // over all neighbours, of all kernels since the start
};

struct StepContext {
    Device& device;
    const FluidParams& fluid;
    const StepParams& params;
    NeighborGrid& grid;
    Particles& particles;
    SolveFigures& solve;
    double fastest = 0;   // m/s, as last known; on a GPU that is some frames ago
    const Buffer& stats;  // rows of fluid/world/stats as they were last measured: where a kernel asks, they are not late
    // Sorts the newest state into position and velocity, and moves solids and bodies on. false: it could not, and the substep ends here.
    // `fromPositions`: velocityNext holds where particles come from, m.
    std::function<bool(bool fromPositions)> build;
    // Adds to the forces on bodies what fluid does to their samples; a world without bodies has none. `pressures`: of the fluid, as the
    // pair terms of the method have them; `scale`: an acceleration of one particle (m/s^2) over pressure * gradient (1/m); `weight`: by
    // how much they grow a metre beyond the fluid, in the same unit (wcsph: its form of the kernel knows gravity; 0).
    std::function<void(const Buffer& position, const Buffer& pressures, float scale, const vec3& weight)> pushSamples;
    const Buffer& planes;  // as integrate.kernel wants them
    // Fills particles.boundary for these positions (in sorted order). Methods whose density knows no walls do not ask.
    std::function<void(const Buffer& position)> boundary;
    // Whether any row of forces() is on.
    bool hasForces = false;
    // Adds what the rows of forces() ask for to particles.acceleration, from position and velocity, as sorted.
    std::function<void()> forces;
    // What no-slip walls do at these positions (in sorted order): w sum of k (1/m^2), xyz sum of k times the wall's velocity; the
    // acceleration is nu (xyz - w v). Empty: there are none.
    std::function<void(const Buffer& position, Buffer& friction)> wallFriction = {};
    // Adds what walls at rest pull at particles by adhesion to particles.acceleration; `params`.force.w as fluid/forces/wall_adhesion wants
    // it.
    std::function<void(const StepParams& params)> wallAdhesion = {};

    // The params of a world where nothing weighs anything.
    StepParams noGravity() const {
        StepParams p = params;
        p.gravity = vec4(0.0F);
        return p;
    }
};

// A kernel with FOR_NEIGHBORS, in the form that the world's particles need. It binds particles.matter by itself, where it is used.
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
