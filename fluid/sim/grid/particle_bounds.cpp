#include "fluid/sim/grid/particle_bounds.h"

#include "shaders/fluid/grid/bounds_row.h"

namespace rivulet {

Result<ParticleBounds> ParticleBounds::create(Device& device) {
    ParticleBounds made;
    Result<Kernel> kernel = device.kernel("fluid/grid/bounds");
    if (!kernel) return kernel.error();
    made.measure_ = *kernel;
    Result<Buffer> rows = device.allocate(BOUNDS_THREADS * sizeof(BoundsRow));
    if (!rows) return rows.error();
    made.rows_ = std::move(*rows);
    return made;
}

void ParticleBounds::set(std::span<const vec4> position) {
    known_ = std::make_shared<Known>();  // what arrives late is of particles that are no more
    steps_ = 0;
    add(position);
}

void ParticleBounds::add(std::span<const vec4> position) {
    for (const vec4& p : position)
        if (!(p.w < 0) && isFinite(vec3(p))) known_->bounds.add(vec3(p));
}

void ParticleBounds::measure(Device& device, const StepParams& step, const NeighborGrid& grid, const Particles& particles) {
    device.run(measure_, step, {&grid.cellStart(), &particles.positionNext, &rows_}, BOUNDS_THREADS);
    if (device.interrupted()) return;
    device.readLater(rows_, BOUNDS_THREADS * sizeof(BoundsRow),
                     [at = steps_, weak = std::weak_ptr(known_)](std::span<const std::byte> bytes) {
                         const std::shared_ptr<Known> into = weak.lock();
                         if (!into) return;
                         const auto* rows = reinterpret_cast<const BoundsRow*>(bytes.data());
                         *into = {.bounds = {}, .step = at};
                         for (uint32_t k = 0; k < BOUNDS_THREADS; ++k) {
                             if (!(rows[k].high.w > 0)) continue;
                             into->bounds.add(vec3(rows[k].low));
                             into->bounds.add(vec3(rows[k].high));
                         }
                     });
}

Bounds ParticleBounds::next(float reach, const Bounds& sources) const {
    Bounds b = known_->bounds;
    if (!sources.empty()) {
        b.add(sources.min);
        b.add(sources.max);
    }
    if (b.empty()) return b;
    const vec3 grown(reach * static_cast<float>(steps_ - known_->step + 1));
    b.min -= grown;
    b.max += grown;
    return b;
}

}  // namespace rivulet
