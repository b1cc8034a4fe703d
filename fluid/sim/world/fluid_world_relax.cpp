// Relaxed starts (position corrections: Macklin and Mueller 2013). Where a start is denser than the liquid at rest, the first steps would
// turn the surplus into velocity. Here positions take it out, before time begins.
#include <algorithm>

#include "engine/compute/device_cpu.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world_impl.h"

namespace rivulet {

namespace {

constexpr double kRelaxed = 1.0e-2;  // compression of the densest particle at which the corrections stop
constexpr int kMostRounds = 10;      // of kCorrections each
constexpr int kCorrections = 5;

bool overlap(const BlockParams& a, const BlockParams& b, float spacing) {
    const vec3 shared = glm::min(a.max, b.max) - glm::max(a.min, b.min);
    return glm::all(glm::greaterThan(shared, vec3(0.1F * spacing)));
}

// Whether particles of blocks may be denser than at rest. A lattice, with or without walls of the box beside it, is not.
bool mayBeDense(const FluidParams& p, const Solids& solids) {
    if (p.blocks.empty()) return false;
    if (solids.field != nullptr || !solids.planes.empty() || !solids.rigid.empty() || !solids.deforming.empty() || !solids.bodies.empty())
        return true;
    for (size_t k = 0; k < p.blocks.size(); ++k) {
        if (p.blocks[k].jitter > 0) return true;
        for (size_t other = 0; other < k; ++other)
            if (overlap(p.blocks[k], p.blocks[other], p.spacing)) return true;
    }
    return false;
}

// The same space and solids, without weight and forces, in which particles move by corrections alone.
FluidParams weightless(const FluidParams& params) {
    FluidParams p;
    p.method = "pbf";
    p.pbf.iterations = kCorrections;
    p.spacing = params.spacing;
    p.supportSpacings = params.supportSpacings;
    p.restDensity = params.restDensity;
    p.gravity = vec3(0.0F);
    p.viscosity = 0;
    p.artificialViscosity = 0;
    p.limits = false;
    p.box = params.box;
    p.collision = params.collision;
    p.collision.walk = CollisionParams{}.walk;
    return p;
}

}  // namespace

// On the cpu, whatever device the world is on: so the start is the same on all, and a GPU compiles no kernels for it. A world that this
// cannot serve (too fine for pbf, say) starts as it is.
void FluidWorld::Impl::relaxStart(const Solids& given) {
    if (!mayBeDense(params, given) || start.empty()) return;
    Solids around = given;
    for (Body& b : around.bodies) {
        b.shape.mass = 0;  // it stays where it is
        b.shape.distance = {};
        b.state.velocity = b.state.spin = vec3(0.0F);
    }
    around.bodyHost = {};
    around.colliders = {};
    const std::unique_ptr<CpuDevice> cpu = makeCpuDevice(cpuKernels());
    cpu->stopOn(device->stopFlag());
    Result<std::unique_ptr<FluidWorld>> made = FluidWorld::create(*cpu, weightless(params), around, {}, {.particles = start});
    if (!made) return;
    Impl& w = *(*made)->impl_;
    if (w.start.size() != start.size()) return;
    const std::vector<vec4> still(w.particles.count, vec4(0.0F));
    for (int round = 0; round < kMostRounds; ++round) {
        cpu->writeAll<vec4>(w.particles.velocityNext, still);
        (*made)->step({vec3(0.0F)}, 1.0e-4);
        if (w.figures->lost > 0 || w.interrupted) return;
        if (w.figures->maxCompression < kRelaxed) break;
    }
    const std::vector<vec4> position = cpu->readAll<vec4>(w.particles.positionNext, w.particles.count);
    const std::vector<uint32_t> id = cpu->readAll<uint32_t>(w.particles.id, w.particles.count);
    for (size_t k = 0; k < id.size(); ++k) {
        if (id[k] >= start.size() || start[id[k]].block == kNoBlock) continue;  // a sample, or the host's
        NewParticle& p = start[id[k]];
        p.position = vec3(position[k]);
        p.velocity = velocityAt(params.blocks[p.block], p.position);
    }
}

}  // namespace rivulet
