// The passes of a step that know solids: what walls add to density, and what keeps particles out of them.
#pragma once

#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/fluid_params.h"
#include "fluid/sim/neighbor_grid.h"
#include "fluid/sim/particles.h"
#include "fluid/sim/solids.h"
#include "shaders/fluid/step_params.h"

namespace rivulet {

// The solids of a world, on its Device.
class SolidPasses {
  public:
    // Error: a plane without direction (badInput), out of memory. `device` and the solids' fields must outlive it.
    static Result<SolidPasses> create(Device& device, const StaticSolids& solids);

    // Whether a particle may be born at `p`: on the fluid's side of every plane, outside every mesh, and not nearer than it would rest.
    bool mayBeBorn(const vec3& p, float spacing) const;
    uint32_t planeCount() const { return static_cast<uint32_t>(planeSolids_.size()); }
    const Buffer& planes() const { return planes_; }  // as integrate.kernel wants them

    // Before both of a step's passes: `gravity` m/s^2.
    void prepare(const FluidParams& params, const StepParams& step, float gravity);
    // Fills particles.boundary.
    void boundary(const StepParams& step, const NeighborGrid& grid, Particles& particles);
    // Moves particles.positionNext and velocityNext out of the meshes.
    void collide(const NeighborGrid& grid, Particles& particles);

  private:
    Status upload();

    Device* device_ = nullptr;
    std::vector<PlaneSolid> planeSolids_;
    Buffer planes_;
    Kernel boundary_, collide_;
    const VoxelField* field_ = nullptr;  // null: no mesh in the scene, and no pass for one
    std::vector<uint8_t> outside_;       // of the field's voxels: reachable from its border
    FieldParams block_{};
    Buffer fieldBlock_, fieldBits_, fieldDistance_, fieldNormal_;
    float blockDt_ = 0;  // fieldBlock_ was written for this step length
};

}  // namespace rivulet
