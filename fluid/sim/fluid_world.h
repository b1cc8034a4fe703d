// FluidWorld: the one object a host owns. Particles, neighbour grid, method, boundaries; stepped once a frame.
#pragma once

#include <memory>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "engine/core/result.h"
#include "fluid/sim/fluid_params.h"
#include "fluid/sim/solids.h"
#include "fluid/sim/stats.h"

namespace rivulet {

// Where the particles are on the Device. Valid until the next step(), reset() or destruction. Order changes every step; ids do not.
struct ParticleView {
    const Buffer* position = nullptr;  // vec4: xyz m, w = density / rest density
    const Buffer* velocity = nullptr;  // vec4: xyz m/s, w unused
    const Buffer* id = nullptr;        // uint
    const Buffer* normal = nullptr;    // vec4: of the surface, w its length; null unless fluid.forces.normals asks for them
    uint32_t count = 0;                // lost ones last
    float spacing = 0;                 // m
    float mass = 0;                    // kg, of one
};

// What the scene says to the fluid each frame.
struct FluidInputs {
    vec3 gravity{0.0F, -9.81F, 0.0F};  // m/s^2
    // Where solids are when the frame's time has gone by; on the way there they move evenly. Empty: they stay.
    std::span<const Pose> poses = {};                    // of Solids::rigid
    std::span<const std::span<const vec3>> shapes = {};  // m, the vertices of Solids::deforming
};

class FluidWorld {
  public:
    // Error: a value that makes no sense together with another, out of memory. `device` must outlive the world.
    static Result<std::unique_ptr<FluidWorld>> create(Device& device, const FluidParams& params, const Solids& solids, Log log);
    ~FluidWorld();
    FluidWorld(const FluidWorld&) = delete;
    FluidWorld& operator=(const FluidWorld&) = delete;

    // Advances by `seconds` (a frame) in as many substeps as the CFL, viscous and acoustic limits ask. 0 or less: nothing happens.
    // A frame longer than maxSubsteps can cover advances less, and stats().limited says so: simulated time slows, steps do not grow.
    void step(const FluidInputs& inputs, double seconds);
    void reset();                                         // back to t = 0
    void setParams(const FluidParams&);                   // takes what can change between steps; `fixed` values wait for a new world
    void setSurfaces(std::span<const Surface> surfaces);  // in place of Solids::surfaces

    const FluidParams& params() const;
    ParticleView particles() const;
    const FluidStats& stats() const;         // late on a GPU
    double time() const;                     // s simulated
    int lastSubsteps() const;                // of the last step(), not late
    const std::vector<Pose>& poses() const;  // of the rigid solids, as they are now: where time slows, short of what was asked
    uint64_t voxelsRewritten() const;        // of deforming solids, since the start
    Device& device() const;

  private:
    FluidWorld();
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
