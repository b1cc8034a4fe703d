// Queries of a game: the water at a place, and where a ray meets it. FluidWorld passes them on, in batches.
//
// The field is that of the particles as they are now: the density ratio they make by Wendland's kernel, about 1 amid water, 0 in the air;
// its surface is where that is 0.5, as IsoSurface::kLevel: on a lattice half a spacing beyond the outermost centres. A drop of fewer than
// about four particles is thinner than that everywhere: it can be sampled, and rays pass it. Water that walls hold ends at them.
//
// Cost: a query goes to the device and its answer comes back, which waits for all work queued before; a thread a place or
// ray, and a sum over the particles around at each place, at each half spacing of a ray and 16 times where it hits. In 62,500 particles
// 1,000 places took 0.8 ms, 1,000 rays of some 50 half spacings 15 ms (two shared cpu cores).
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/world/fluid_params.h"
#include "fluid/sim/world/particles.h"

namespace rivulet {

struct FluidSample {
    float density = 0;    // over the rest density; 0 in the air, outside of the world, at a place that is no number
    vec3 velocity{0.0F};  // m/s, mean of the particles around, the nearer the more; 0 in the air
    vec3 gradient{0.0F};  // 1/m, of density: points into the water
};

struct FluidRay {
    vec3 origin{0.0F};                                     // m
    vec3 direction{0.0F};                                  // of any length; without one, or where something is no number, it misses
    float reach = std::numeric_limits<float>::infinity();  // m
};

struct FluidHit {
    bool hit = false;
    bool inside = false;  // it began in water: the hit, if there is one, is where it comes out
    float distance = 0;   // m
    vec3 place{0.0F};     // m
    vec3 normal{0.0F};    // unit, out of the water
    vec3 velocity{0.0F};  // m/s, of the water there
};

class WaterQuery {
  public:
    // Whose particles: in the grid's order, where they are now.
    struct Water {
        const StepParams& step;
        const NeighborGrid& grid;
        const Buffer &position, &velocity;
    };
    // Error: out of memory, a kernel that cannot be built.
    static Result<WaterQuery> create(Device& device, const FluidParams& params, const PairTraits& traits);
    bool any() const { return device_ != nullptr; }

    // Errors: out of memory. Both wait.
    Result<std::vector<FluidSample>> sample(const Water& water, std::span<const vec3> places);
    Result<std::vector<FluidHit>> cast(const Water& water, std::span<const FluidRay> rays);
    // Does not wait: `then` is called by some later poll() of the device; on the cpu at once.
    Status sampleLater(const Water& water, std::span<const vec3> places, std::function<void(std::span<const FluidSample>)> then);

  private:
    Status ask(Kernel kernel, const Water& water, std::span<const vec4> asked, uint32_t count);

    Device* device_ = nullptr;
    float weight_ = 0;
    Kernel sample_, cast_;
    Buffer asked_, answers_;
};

}  // namespace rivulet
