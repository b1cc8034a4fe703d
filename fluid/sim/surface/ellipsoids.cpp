#include "fluid/sim/surface/ellipsoids.h"

#include <algorithm>
#include <numeric>

#include "shaders/fluid/surface/anisotropy_params.h"

namespace rivulet {

Status Ellipsoids::prepare(Device& device, const PairTraits& traits, uint32_t count) {
    if (prepared_) return ok();
    Result<PairKernel> kernel = PairKernel::find(device, "fluid/surface/ellipsoids", traits);
    if (!kernel) return kernel.error();
    Result<Kernel> free = device.kernel("fluid/surface/ellipsoids_free");
    if (!free) return free.error();
    kernel_ = *kernel;
    free_ = *free;
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

void Ellipsoids::clearFree(Device& device, const StepParams& params, const NeighborGrid& grid, uint32_t count) {
    if (prepared_) device.run(free_, params, {&grid.cellStart(), &of_[0], &of_[1], &of_[2]}, count);
}

Result<HostEllipsoids> ellipsoidsOf(Device& device, std::span<const vec4> particles, float spacing) {
    HostEllipsoids all;
    if (particles.empty()) return all;
    const auto count = static_cast<uint32_t>(particles.size());
    Bounds box;
    for (const vec4& p : particles) box.add(vec3(p));
    box.min -= vec3(2 * spacing);
    box.max += vec3(2 * spacing);
    Result<NeighborGrid> grid = NeighborGrid::create(device, box, 2 * spacing, count, {.keeps = false});
    if (!grid) return grid.error();
    Result<Particles> sorted = Particles::create(device, count);
    if (!sorted) return sorted.error();
    Ellipsoids found;
    if (Status ready = found.prepare(device, {}, count); !ready) return ready.error();
    std::vector<uint32_t> id(count);
    std::iota(id.begin(), id.end(), 0U);
    device.writeAll<vec4>(sorted->positionNext, particles);
    device.writeAll<vec4>(sorted->velocityNext, std::vector<vec4>(count));
    device.writeAll<uint32_t>(sorted->id, id);
    StepParams s{};
    s.boxMin = vec4(box.min, 1.0F);
    s.boxMax = vec4(box.max, 0.0F);
    s.count = count;
    s.h = 2 * spacing;
    s.invH = 1 / s.h;
    s.spacing = spacing;
    s.firstSample = count;
    grid->fill(s);
    if (Status built = grid->build(s, *sorted); !built) return built.error();
    found.find(device, s, *grid, *sorted);
    id = device.readAll<uint32_t>(sorted->id, count);
    for (size_t k = 0; k < 3; ++k) {
        const std::vector<vec4> inOrder = device.readAll<vec4>(*found.buffers()[k], count);
        all[k].resize(count);
        for (uint32_t i = 0; i < count; ++i) all[k][id[i]] = inOrder[i];
    }
    return all;
}

}  // namespace rivulet
