#include "fluid/sim/ellipsoids.h"

#include <algorithm>

#include "shaders/fluid/anisotropy_params.h"

namespace rivulet {

Status Ellipsoids::prepare(Device& device, const PairTraits& traits, uint32_t count) {
    if (prepared_) return ok();
    Result<PairKernel> kernel = PairKernel::find(device, "fluid/ellipsoids", traits);
    if (!kernel) return kernel.error();
    kernel_ = *kernel;
    for (Buffer& buffer : of_) {
        Result<Buffer> made = device.allocate(size_t{count} * sizeof(vec4));
        if (!made) return made.error();
        buffer = std::move(*made);
    }
    prepared_ = true;
    return ok();
}

void Ellipsoids::find(Device& device, const StepParams& params, NeighborGrid& grid, const Particles& particles) {
    if (!prepared_) return;
    StepParams s = params;
    const float support = std::min(params.h, ANISOTROPY_SUPPORT * params.spacing), spacings = support / params.spacing;
    s.force = vec4(support, 1.0F / support, 1.0F / (ANISOTROPY_CROWD * spacings * spacings * spacings), 0.0F);
    std::vector<const Buffer*> buffers = {&grid.neighbors(), &particles.position, &of_[0], &of_[1], &of_[2]};
    if (kernel_.matter) buffers.push_back(&particles.matter);
    device.dispatch(kernel_.kernel, std::as_bytes(std::span(&s, 1)), buffers, grid.pairThreads());
    found_ = true;
}

}  // namespace rivulet
