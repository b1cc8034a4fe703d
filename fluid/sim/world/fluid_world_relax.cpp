// Relaxed starts (position corrections: Macklin and Mueller 2013). Where a start is denser than the liquid at rest, the first steps would
// turn the surplus into velocity. Here positions take it out, before time begins.
//
// A small start is corrected as a whole. In a large one nearly all particles are in the inside of blocks: these take their offsets from a
// tile that is corrected once, in a periodic box, and repeats; what is still too dense then, at walls, surfaces, solids and seams, is
// corrected together with its surroundings, which become fewer from round to round.
#include <algorithm>
#include <cmath>

#include "engine/compute/device_cpu.h"
#include "engine/core/large_pages.h"
#include "fluid/sim/grid/sparse_cells.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world_impl.h"

namespace rivulet {

namespace {

constexpr double kRelaxed = 1.0e-2;  // compression of the densest particle at which the corrections stop
constexpr int kMostRounds = 10;      // of kCorrections each
constexpr int kCorrections = 5;
constexpr size_t kMostWhole = size_t{1} << 18U;           // particles of a small start: one or two seconds
constexpr int kTileRounds = 40;                           // a tile has no surface to expand to, and is small
constexpr double kTileRelaxed = 1.0e-3;                   // of a tile
constexpr double kDense = 5.0e-3;                         // in a large start: of particles that are corrected with their surroundings
constexpr double kTileShare = 0.05, kSearchShare = 0.35;  // of the work of a large start: until the tile, and the first correction, is done

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

// The solids as they stand at the start, without what moves them.
Solids atRest(const Solids& given) {
    Solids around = given;
    for (Body& b : around.bodies) {
        b.shape.mass = 0;  // it stays where it is
        b.shape.distance = {};
        b.state.velocity = b.state.spin = vec3(0.0F);
    }
    around.bodyHost = {};
    around.colliders = {};
    return around;
}

// The surroundings of places, in cells of one support radius; also across periodic axes.
class Surroundings {
  public:
    Surroundings(std::span<const vec3> places, const FluidParams& p) {
        const float h = p.supportSpacings * p.spacing;
        const vec3 size = p.box.max - p.box.min, slack(4 * h);
        SparseCells hot;
        std::vector<vec3> all;
        for (const vec3& place : places)
            for (int k = 0; k < 27; ++k) {
                const ivec3 turn(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
                bool valid = true;
                for (int axis = 0; axis < 3; ++axis) valid = valid && (turn[axis] == 0 || p.box.periodic()[axis]);
                const vec3 image = place + vec3(turn) * size;
                if (valid && (turn == ivec3(0) || glm::clamp(image, p.box.min - slack, p.box.max + slack) == image)) all.push_back(image);
            }
        hot.build(static_cast<uint32_t>(all.size()), h, [&](uint32_t i, const auto& add) { add(hot.cellOf(dvec3(all[i] - p.box.min))); });
        grow(hot, moves_);
        grow(moves_, acts_);
        origin_ = p.box.min;
    }
    // Whether it may move: it is within one radius of a place. All on which that depends is in acts().
    bool moves(const vec3& p) const { return moves_.occupied(moves_.cellOf(dvec3(p - origin_))); }
    bool acts(const vec3& p) const { return acts_.occupied(acts_.cellOf(dvec3(p - origin_))); }

  private:
    static void grow(const SparseCells& from, SparseCells& to) {
        const std::vector<ivec3>& cells = from.cells();
        to.build(static_cast<uint32_t>(cells.size()), from.edge(), [&](uint32_t i, const auto& add) {
            for (int k = 0; k < 27; ++k) add(cells[i] + ivec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1));
        });
    }

    SparseCells moves_, acts_;
    vec3 origin_{0.0F};
};

}  // namespace

// Up to `rounds` of corrections of `those`, until none is compressed by more than `until`. Returns where they are, m, with the ratio of
// density in w, and notes the part of the start that is done, `from` .. `to`. Empty: not possible (too fine for pbf, say), interrupted or
// cancelled.
std::vector<vec4> FluidWorld::Impl::corrected(CpuDevice& cpu, const FluidParams& p, const Solids& walls, std::vector<NewParticle> those,
                                              double until, int rounds, double from, double to) {
    const size_t count = those.size();
    if (!advanced(from)) return {};
    Sources setup;
    setup.particles = std::move(those);
    Result<std::unique_ptr<FluidWorld>> made = FluidWorld::create(cpu, p, walls, {}, std::move(setup));
    // A stop that has ended since must not leave a start that is corrected in part.
    const auto stopped = [&] {
        startInterrupted = startInterrupted || cpu.interrupted() || cpu.stopAsked();
        return startInterrupted;
    };
    if (!made && made.error().memory) shortage = noMemory("there is not enough memory to correct the start: " + made.error().message);
    if (stopped() || !made) return {};
    Impl& w = *(*made)->impl_;
    if (w.start.size() != count) return {};
    for (int round = 0; round < rounds; ++round) {
        cpu.fill(w.particles.velocityNext, 0);
        (*made)->step({vec3(0.0F)}, 1.0e-4);
        if (!(*made)->lastStep()) {
            // On the cpu nothing else ends a step.
            if (!stopped()) shortage = noMemory("there is not enough memory to correct the start: use fewer particles");
            return {};
        }
        if (stopped() || w.figures->lost > 0 || w.interrupted || !advanced(from + (to - from) * (round + 1) / rounds)) return {};
        if (w.figures->maxCompression < until) break;
    }
    const vec4* position = hostPointer<vec4>(w.particles.positionNext);
    const uint32_t* id = hostPointer<uint32_t>(w.particles.id);
    std::vector<vec4> at = largeVector<vec4>(count);
    cpu.parallelFor(w.particles.count, 4096, [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k)
            if (id[k] < count) at[id[k]] = position[k];  // not a sample
    });
    return at;
}

bool FluidWorld::Impl::largeStart() const {
    double wanted = static_cast<double>(sourceSetup.particles.size());
    for (const BlockParams& b : params.blocks) wanted += blockCount(b, params.spacing);
    // Once the start is filled, it holds the host's particles too.
    return std::max(wanted, static_cast<double>(start.size())) > static_cast<double>(kMostWhole);
}

// Offsets of a tile without a surplus of density, in spacings. Empty: not possible.
std::vector<vec3> FluidWorld::Impl::relaxedTile(float jitter) {
    FluidParams p = weightless(params);
    p.box = {.min = vec3(0.0F), .max = vec3(kTile * p.spacing), .periodicX = true, .periodicY = true, .periodicZ = true};
    std::vector<vec3> offsets = randomTile(jitter);
    const auto site = [&](size_t k) { return p.spacing * (vec3(k % kTile, k / kTile % kTile, k / (kTile * kTile)) + 0.5F); };
    std::vector<NewParticle> those(offsets.size());
    for (size_t k = 0; k < offsets.size(); ++k) those[k].position = glm::clamp(site(k) + p.spacing * offsets[k], p.box.min, p.box.max);
    const std::unique_ptr<CpuDevice> cpu = makeCpuDevice(cpuKernels());
    cpu->stopOn(device->stopFlag());
    const std::vector<vec4> at = corrected(*cpu, p, {}, std::move(those), kTileRelaxed, kTileRounds, 0, kTileShare);
    if (at.empty()) return {};
    for (size_t k = 0; k < offsets.size(); ++k) {
        offsets[k] = (vec3(at[k]) - site(k)) / p.spacing;
        offsets[k] -= static_cast<float>(kTile) * glm::round(offsets[k] / static_cast<float>(kTile));  // across the period
    }
    return offsets;
}

// On the cpu, whatever device the world is on: so the start is the same on all, and a GPU compiles no kernels for it. A world that this
// cannot serve (too fine for pbf, say) starts as it is.
void FluidWorld::Impl::relaxStart(const Solids& given) {
    if (!mayBeDense(params, given) || start.empty()) return;
    const Solids walls = atRest(given);
    FluidParams p = weightless(params);
    const std::unique_ptr<CpuDevice> cpu = makeCpuDevice(cpuKernels());
    cpu->stopOn(device->stopFlag());
    cpu->keepReleased();
    const auto put = [&](size_t k, const vec4& at) {
        NewParticle& particle = start[k];
        if (particle.block == kNoBlock) return;  // the host's
        particle.position = vec3(at);
        particle.velocity = velocityAt(params.blocks[particle.block], particle.position);
    };
    const auto putAll = [&](const std::vector<vec4>& at) {
        cpu->parallelFor(at.size(), 4096, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) put(k, at[k]);
        });
    };
    if (!largeStart()) {
        putAll(corrected(*cpu, p, walls, start, kRelaxed, kMostRounds, 0, 1));
        return;
    }
    // One correction of all tells where the surplus is.
    p.pbf.iterations = 1;
    std::vector<vec4> at = corrected(*cpu, p, walls, start, 0, 1, kTileShare, kSearchShare);
    putAll(at);
    p.pbf.iterations = kCorrections;
    for (int round = 0; round < kMostRounds && !at.empty(); ++round) {
        std::vector<vec3> dense;
        for (const vec4& x : at)
            if (x.w > 1 + kDense) dense.emplace_back(x);
        if (dense.empty()) break;
        const Surroundings surroundings(dense, p);
        std::vector<uint8_t> acts(start.size());
        cpu->parallelFor(start.size(), 4096, [&](size_t begin, size_t end) {
            for (size_t k = begin; k < end; ++k) acts[k] = surroundings.acts(start[k].position) ? 1 : 0;
        });
        const auto acting = static_cast<size_t>(std::count(acts.begin(), acts.end(), 1));
        std::vector<NewParticle> part;
        std::vector<uint32_t> which;
        reserveLarge(part, acting);
        reserveLarge(which, acting);
        for (uint32_t k = 0; k < start.size(); ++k)
            if (acts[k] != 0) {
                part.push_back(start[k]);
                which.push_back(k);
            }
        const double each = (1 - kSearchShare) / kMostRounds, from = kSearchShare + each * round;
        const std::vector<vec4> moved = corrected(*cpu, p, walls, std::move(part), 0, 1, from, from + each);
        if (moved.empty()) break;
        cpu->parallelFor(which.size(), 4096, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) {
                const size_t k = which[i];
                if (!surroundings.moves(start[k].position)) continue;
                at[k] = moved[i];
                put(k, moved[i]);
            }
        });
    }
}

bool FluidWorld::Impl::advanced(double share) {
    if (!cancelled && progress && !progress(share)) cancelled = true;
    return !cancelled;
}

}  // namespace rivulet
