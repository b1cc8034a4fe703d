// Creation of a world: room for its particles, its kernels, and its state at t = 0.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "fluid/sim/methods/smoothing.h"
#include "fluid/sim/sources/liquids.h"
#include "fluid/sim/world/fluid_world_impl.h"
#include "fluid/sim/world/start_surface.h"
#include "shaders/fluid/solids/body_state.h"
#include "shaders/fluid/world/stats_row.h"

namespace rivulet {

namespace {

// More than any device's memory holds; refused before anything is allocated.
constexpr double kMostParticles = 64.0e6;

}  // namespace

Status FluidWorld::Impl::prepare(const Solids& given) {
    const float h = params.supportSpacings * params.spacing;
    double wanted = static_cast<double>(sourceSetup.particles.size());
    for (const BlockParams& b : params.blocks) wanted += blockCount(b, params.spacing);
    if (wanted > kMostParticles)
        return badInput(fmt::format(
            "fluid.blocks hold {:.3g} particles at a spacing of {} m, more than {:.0f} million: use a spacing of at least {:.3g} m", wanted,
            params.spacing, kMostParticles / 1e6, params.spacing * std::cbrt(wanted / kMostParticles)));
    if (Status s = checkStart(); !s) return s;
    traits.periodic = params.box.periodic();
    traits.walls = !glm::all(traits.periodic) || solids.any();
    traits.samples = bodies.sampleCount();
    traits.keeps = methodOf(params).keepsPairs;
    traits.sleeps = params.sleep.on;
    traits.asleepRows = traits.sleeps && device->backend() != Backend::cpu;
    traits.follows = sourceSetup.expectedDeposit == 0 && !traits.sleeps;  // deposits come at any place
    if (Status s = checkDry(sourceSetup.dry, bodies.ids()); !s) return s;
    if (!sourceSetup.dry.empty()) {
        if (Status s = dry.prepare(*device, sourceSetup.dry); !s) return s;
        dry.set(sourceSetup.dry, bodies.ids(), bodies.starts(), bodies.states());
    }
    // Before millions of particles are made.
    if (Status s = NeighborGrid::checkCells(Bounds{params.box.min, params.box.max}, h, wanted, traits); !s) return s;
    fillStart();
    if (Status s = findSlots(); !s) return s;
    findLiquids();

    struct Wanted {
        Kernel* kernel;
        const char* path;
        std::vector<Define> defines;
        bool wanted;
    };
    const Define fromPositions{"FROM_POSITIONS", "1"};
    traits.matter = traits.matter || traits.samples > 0;
    for (const Wanted& w : {Wanted{&stats, "fluid/world/stats",
                                   traits.matter   ? std::vector<Define>{{"MATTER", "1"}}
                                   : traits.linked ? std::vector<Define>{{"LINKED_LIST", "1"}}
                                                   : std::vector<Define>{},
                                   true},
                            Wanted{&wrap, "fluid/world/wrap", {}, glm::any(traits.periodic)},
                            Wanted{&wrapFromPositions, "fluid/world/wrap", {fromPositions}, glm::any(traits.periodic)},
                            Wanted{&gatherMatter, "fluid/world/gather_matter", {}, traits.matter},
                            Wanted{&gatherVectors, "fluid/world/gather_vectors", {}, coloured || !params.attributes.empty()},
                            Wanted{&setAttribute, "fluid/world/set_attribute", {}, !params.attributes.empty()},
                            Wanted{&paintAttribute, "fluid/world/paint_attribute", {}, !params.attributes.empty()}}) {
        if (!w.wanted) continue;
        Result<Kernel> found = device->kernel(w.path, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    const uint32_t count = slots + traits.samples;
    Result<std::unique_ptr<Method>> made =
        methodOf(params).make(*device, {.params = params, .count = count, .traits = traits, .closed = startsClosed()});
    if (!made) return made.error();
    method = std::move(*made);
    if (Status s = checkPrecision(); !s) return s;

    Result<NeighborGrid> newGrid = NeighborGrid::create(*device, Bounds{params.box.min, params.box.max}, h, count, traits);
    if (!newGrid) return newGrid.error();
    grid = std::make_unique<NeighborGrid>(std::move(*newGrid));
    if (grid->isWindow()) {
        Result<ParticleBounds> bounds = ParticleBounds::create(*device);
        if (!bounds) return bounds.error();
        around = std::move(*bounds);
    }
    if (glm::any(traits.periodic)) {
        Result<Buffer> low = device->allocate(sizeof(vec4));
        if (!low) return low.error();
        corner = std::move(*low);
        const vec4 value(params.box.min, 0.0F);
        device->write(corner, std::as_bytes(std::span(&value, 1)));
    }
    Result<Particles> newParticles = Particles::create(*device, count, traits.matter, coloured, params.attributes.size());
    if (!newParticles) return newParticles.error();
    particles = std::move(*newParticles);
    Result<Buffer> rows = device->allocate(STATS_THREADS * sizeof(StatsRow));
    if (!rows) return rows.error();
    statsRows = std::move(*rows);
    if (Status room = bodies.allocate(count); !room) return room.error();
    Result<SourcePasses> passes = SourcePasses::create(*device, sourceSetup, params, traits.matter, coloured);
    if (!passes) return passes.error();
    sources = std::move(*passes);
    hasFree = sources.any() || dry.any();
    if (sourceSetup.expectedDeposit > 0) {
        Result<ExchangePasses> handed = ExchangePasses::create(*device);
        if (!handed) return handed.error();
        exchange = std::move(*handed);
    }
    if (params.foam.most > 0) {
        Result<FoamPasses> foaming = FoamPasses::create(*device, params, traits, count);
        if (!foaming) return foaming.error();
        foam = std::move(*foaming);
    }
    if (params.wetness.on) {
        Result<WetPasses> wetting = WetPasses::create(*device, given, params.spacing, traits.linked);
        if (!wetting) return wetting.error();
        wet = std::move(*wetting);
    }
    if (Status s = prepareSleep(); !s) return s;
    if (count == 0) log.notice("the scene has no particles");
    relaxStart(given);
    if (shortage) return *shortage;
    if (dry.any()) std::erase_if(start, [&](const NewParticle& p) { return isDry(dry.volumes(), p.position); });
    writeStart();
    return ok();
}

Status FluidWorld::Impl::mayLink() const {
    if (device->backend() == Backend::cpu)
        return badInput("fluid.grid linked_list needs the atomics of a GPU: simulate with --backend gl or cl, or choose fluid.grid sorted");
    if (!methodOf(params).linkedLists) {
        std::string able;
        for (const MethodRow& row : methods().rows)
            if (row.linkedLists) able += able.empty() ? row.name : std::string(", ") + row.name;
        return badInput(
            fmt::format("fluid.grid linked_list is for method {}, not {}: choose that method, or fluid.grid sorted", able, params.method));
    }
    if (!sourceSetup.emitters.empty() || !sourceSetup.sinks.empty() || !sourceSetup.dry.empty() || sourceSetup.expectedDeposit > 0)
        return badInput(
            "fluid.grid linked_list does not support emitters, sinks, dry volumes and skins: remove them, or choose fluid.grid sorted");
    if (params.sleep.on)
        return badInput("fluid.grid linked_list does not support fluid.sleep: set fluid.sleep.on to false, or choose fluid.grid sorted");
    if (params.foam.most > 0)
        return badInput("fluid.grid linked_list does not support foam: set fluid.foam.most to 0, or choose fluid.grid sorted");
    return forces.refuseForLinkedLists(params, methodOf(params).doesViscosity);
}

// Factors of the smoothing kernels go with the eighth or ninth power of the support radius: those of a very small one are no floats.
Status FluidWorld::Impl::checkPrecision() const {
    const auto fits = [this](float spacing) {
        FluidParams p = params;
        p.spacing = spacing;
        StepParams s{};
        s.h = p.supportSpacings * spacing;
        s.invH = 1.0F / s.h;
        s.contact = 0.5F * spacing;
        method->fill(p, 1.0F, s);
        FluidParams ofForces = p;  // they have Wendland's kernel, whatever the method has
        ofForces.kernel = "wendland";
        StepParams f = s;
        fillSmoothing(ofForces, f);
        return std::isfinite(s.kernelK) && std::isfinite(s.gradientK) && std::isfinite(f.kernelK) && std::isfinite(f.gradientK);
    };
    float least = params.spacing;
    while (!fits(least)) least *= 1.1F;
    if (least == params.spacing) return ok();
    return badInput(
        fmt::format("fluid.spacing is {} m, too fine for single precision with method {} and a reach of {} spacings: use at "
                    "least {:.2g} m",
                    params.spacing, params.method, params.supportSpacings, 1.1F * least));
}

// Meshes of blocks, and particles that the host placed.
Status FluidWorld::Impl::checkStart() const {
    for (size_t k = 0; k < params.blocks.size(); ++k) {
        if (params.blocks[k].shape != "mesh") continue;
        if (k >= sourceSetup.blockTriangles.size() || sourceSetup.blockTriangles[k].size() < 3)
            return badInput(fmt::format("fluid.blocks[{}].shape is mesh, and no triangles are given for it: use another shape", k));
        const std::vector<vec3>& corners = sourceSetup.blockTriangles[k];
        if (corners.size() % 3 != 0 || !std::all_of(corners.begin(), corners.end(), [](const vec3& c) { return isFinite(c); }))
            return badInput(fmt::format("the mesh of fluid.blocks[{}] has corners that are not finite or not in threes: correct it", k));
    }
    const BoxParams& box = params.box;
    for (size_t k = 0; k < sourceSetup.particles.size(); ++k) {
        const vec3 &at = sourceSetup.particles[k].position, &velocity = sourceSetup.particles[k].velocity;
        if (!isFinite(at) || !isWithin(velocity, kMostSpeed))
            return badInput(
                fmt::format("particles[{}] has the position ({}, {}, {}) m and the velocity ({}, {}, {}) m/s: give finite numbers, and at "
                            "most {} m/s",
                            k, at.x, at.y, at.z, velocity.x, velocity.y, velocity.z, kMostSpeed));
        if (glm::clamp(at, box.min, box.max) != at)
            return badInput(
                fmt::format("particles[{}] at ({}, {}, {}) m is outside fluid.box from ({}, {}, {}) to ({}, {}, {}) m: move it "
                            "into the box, or enlarge the box",
                            k, at.x, at.y, at.z, box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z));
    }
    return ok();
}

// The particles of the blocks, without those that would start inside or too near a mesh or behind a plane; those that the host placed,
// without those inside a solid: a wall pushes the others out.
void FluidWorld::Impl::fillStart() {
    std::map<float, std::vector<vec3>> tiles;  // by jitter
    const bool large = largeStart();
    for (size_t k = 0; k < params.blocks.size(); ++k) {
        const size_t first = start.size();
        const BlockParams& b = params.blocks[k];
        if (large && b.jitter > 0 && !tiles.contains(b.jitter)) tiles[b.jitter] = relaxedTile(b.jitter);
        fillBlock(b, params.spacing, start,
                  k < sourceSetup.blockTriangles.size() ? std::span<const vec3>(sourceSetup.blockTriangles[k]) : std::span<const vec3>(),
                  tiles[b.jitter]);
        for (size_t i = first; i < start.size(); ++i) start[i].block = static_cast<uint32_t>(k);
    }
    if (!sourceSetup.particles.empty()) {
        Bounds bounds;
        float fastest = 0;
        for (NewParticle& p : sourceSetup.particles) {
            bounds.add(p.position);
            fastest = std::max(fastest, glm::length(p.velocity));
            p.block = kNoBlock;
        }
        if (start.empty())
            start = std::move(sourceSetup.particles);
        else
            start.insert(start.end(), sourceSetup.particles.begin(), sourceSetup.particles.end());
        placed = BlockParams{.min = bounds.min, .max = bounds.max, .velocity = vec3(fastest, 0.0F, 0.0F)};
    }
    sourceSetup.particles = {};
    sourceSetup.blockTriangles = {};
    size_t left = 0, leftPlaced = 0;
    std::erase_if(start, [&](const NewParticle& p) {
        const float near = p.block == kNoBlock ? 0.0F : 1.0F;
        const bool may = solids.maySpawn(p.position, params.spacing, near) && bodies.maySpawn(p.position, params.spacing, near);
        if (!may && !blockOf(p).cut) ++(p.block == kNoBlock ? leftPlaced : left);
        return !may || isDry(dry.volumes(), p.position);
    });
    if (leftPlaced > 0) log.notice(fmt::format("{} of the placed particles are inside a solid: they were left out", leftPlaced));
    if (left > 0) log.notice(fmt::format("{} particles of fluid.blocks would start inside or too near a solid: they were left out", left));
}

// Whether the liquid has no free surface and gets none by what flows in or out. In a box that is periodic along all axes there may be none.
bool FluidWorld::Impl::startsClosed() const {
    if (glm::all(traits.periodic)) return true;
    if (!sourceSetup.emitters.empty() || !sourceSetup.sinks.empty() || dry.any() || sourceSetup.expectedDeposit > 0 || start.empty())
        return false;
    // Where nothing but liquid fills the box, half of a box has one.
    const vec3 box = params.box.max - params.box.min;
    const double filled = static_cast<double>(start.size()) * std::pow(double{params.spacing}, 3);
    if (!solids.any() && !bodies.any() && filled < 0.5 * double{box.x} * double{box.y} * double{box.z}) return false;
    return !hasFreeSurface(start, params,
                           [&](const vec3& p) { return solids.maySpawn(p, params.spacing) && bodies.maySpawn(p, params.spacing, 1); });
}

// Which particles of t = 0 are inside solids that were added since. Empty: none.
std::vector<bool> FluidWorld::Impl::insideAdded() {
    if (!solidsChanged) return {};
    std::vector<bool> inside(start.size());
    for (size_t k = 0; k < start.size(); ++k)
        inside[k] = !solids.maySpawn(start[k].position, params.spacing, 0) || bodies.insideAdded(start[k].position, params.spacing);
    const auto count = std::ranges::count(inside, true);
    if (count == 0) return {};
    hasFree = true;
    log.notice(fmt::format("{} particles of t = 0 are inside solids that were added since: they were left out", count));
    return inside;
}

// The number of slots.
Status FluidWorld::Impl::findSlots() {
    const double held = static_cast<double>(start.size()), wanted = SourcePasses::slotsFor(sourceSetup, params);
    double room = held + wanted;
    if (params.maxParticles > 0) {
        room = params.maxParticles;
        if (room < held)
            return badInput(fmt::format(
                "fluid.maxParticles is {}, but the world starts with {} particles: increase it, or set 0 to reserve memory for all",
                params.maxParticles, start.size()));
    } else if (!sourceSetup.emitters.empty() || sourceSetup.expectedDeposit > 0) {
        room = std::min(room, kMostParticles);
        const bool lets = sourceSetup.expectedDeposit > 0 || std::any_of(sourceSetup.emitters.begin(), sourceSetup.emitters.end(),
                                                                         [](const Emitter& e) { return e.params.litresPerSecond > 0; });
        if (lets)
            log.notice(fmt::format(
                "memory for {} particles: {} of the blocks, and those that emitters spawn in {} s, as far as the box holds them",
                static_cast<uint64_t>(room), start.size(), sourceSetup.seconds));
    }
    slots = std::max(static_cast<uint32_t>(room), sourceSetup.least);
    return ok();
}

// Whether particles differ in their liquid or in their colour.
void FluidWorld::Impl::findLiquids() {
    std::vector<LiquidOf> all = {liquidOf(params, "")};
    const auto add = [&](const std::string& name, const vec3& dye, float amount, float scattering) {
        if (liquids().find(name) == nullptr && !name.empty()) return;  // refused when the sources are created
        all.push_back(liquidOf(params, name));
        if (all.back().row != 0) traits.matter = coloured = true;
        if ((dye != vec3(1.0F) && amount > 0) || scattering > 0) coloured = true;
    };
    for (const BlockParams& b : params.blocks) add(b.liquid, b.dye, b.dyeAmount, b.dyeScattering);
    for (const Emitter& e : sourceSetup.emitters) add(e.params.liquid, e.params.dye, e.params.dyeAmount, e.params.dyeScattering);
    // A pair has the harmonic mean of the two.
    mostViscous = 0;
    for (const LiquidOf& a : all)
        for (const LiquidOf& b : all)
            mostViscous =
                std::max(mostViscous, 2 * a.viscosity * b.viscosity / std::max((a.viscosity + b.viscosity) * a.density, 1.0e-30F));
}

void FluidWorld::Impl::writeStart(const std::vector<bool>& leftOut) {
    // Piece by piece, so that a large world does not stand in memory twice.
    constexpr uint32_t kPiece = 65536;
    std::vector<vec4> position, velocity;
    std::vector<uint32_t> id;
    if (around) around->set({});
    for (uint32_t first = 0; first < particles.count; first += kPiece) {
        position.clear();
        velocity.clear();
        id.clear();
        for (uint32_t k = first; k < std::min(first + kPiece, particles.count); ++k) {
            id.push_back(k);
            if (k < start.size() && (leftOut.empty() || !leftOut[k])) {
                position.emplace_back(start[k].position, 1.0F);
                velocity.emplace_back(start[k].velocity, 0.0F);
            } else {
                // A free slot, or a sample on a body: these come last, and each substep puts them where they are.
                position.emplace_back(k < slots ? params.box.min : vec3(NOWHERE), -1.0F);
                velocity.emplace_back(0.0F);
            }
        }
        device->write(particles.positionNext, std::as_bytes(std::span(position)), size_t{first} * sizeof(vec4));
        device->write(particles.velocityNext, std::as_bytes(std::span(velocity)), size_t{first} * sizeof(vec4));
        device->write(particles.id, std::as_bytes(std::span(id)), size_t{first} * sizeof(uint32_t));
        if (around) around->add(position);
    }
    std::vector<vec4> matterOf, absorptionOf;
    if (traits.matter || coloured)
        for (const NewParticle& p : start) {
            const BlockParams& b = blockOf(p);
            const LiquidOf liquid = liquidOf(params, b.liquid);
            if (traits.matter) matterOf.emplace_back(1.0F, params.restDensity / liquid.density, liquid.viscosity, liquid.row);
            if (coloured) absorptionOf.push_back(dyed(liquid, b.dye, b.dyeAmount, b.dyeScattering));
        }
    if (traits.matter) {
        matterOf.resize(slots, vec4(1.0F, 1.0F, params.viscosity * params.restDensity, 0.0F));
        const std::vector<vec4> samples = bodies.matter();
        matterOf.insert(matterOf.end(), samples.begin(), samples.end());
        device->writeAll<vec4>(particles.matterOf, matterOf);
    }
    if (coloured) device->writeAll<vec4>(particles.absorptionOf, absorptionOf);
    writeAttributes();
    sources.reset();
    dry.reset(bodies.states());
    withdrawn = std::make_shared<uint64_t>(0);
    before = {};
    if (foam) foam->reset();
    if (wet) wet->reset();
    volumes.reset();
    if (probes) probes->reset();
    sorted = false;
    invalidateCells();
    gatherForDrawing();
    if (sleep) sleep->reset(0);
    stepped = 0;
    sleptUnder = vec3(0.0F);
    clock.time = clock.dropped = 0;
    clock.frame = 0;
    clock.dtMin = clock.dtMax = 0;
    limits.fastestEver = limits.fastestStart = 0;
    clock.budgetReported = clock.costReported = false;
    stepper.reset();
    drawn.forget();
    ellipsoids.forget();
    posesBefore.clear();
    for (const NamedBuffer& b : method->remembered()) device->fill(*b.buffer, 0);
    method->reset();
    figures = std::make_shared<FluidStats>();
    startCount = static_cast<uint32_t>(start.size() - static_cast<size_t>(std::ranges::count(leftOut, true)));
    figures->particles = startCount;
    // The first step needs it, too.
    for (const NewParticle& p : start) limits.fastestStart = std::max(limits.fastestStart, glm::length(p.velocity));
    assumeFastest(double{limits.fastestStart});
    figures->emitted = static_cast<double>(startCount) * std::pow(double{params.spacing}, 3);
}

Status FluidWorld::Impl::follow(StepParams& s) {
    Bounds spawned;
    for (const Emitter& e : sourceSetup.emitters) {
        const vec3 reach(e.params.radius + glm::length(e.params.size) + e.params.fitSize + params.spacing);
        spawned.add(e.params.position - reach);
        spawned.add(e.params.position + reach);
        for (const vec3& corner : e.triangles) spawned.add(corner);
    }
    for (const vec3& place : sources.depositPlaces()) {
        spawned.add(place - vec3(params.spacing));
        spawned.add(place + vec3(params.spacing));
    }
    // A step takes no particle further than a spacing, unless limits are off.
    const Bounds wanted = around->next((params.limits ? 1.0F : 4.0F) * params.spacing, spawned);
    if (Status there = grid->follow(wanted); !there) return there;
    grid->fill(s);
    return ok();
}

void FluidWorld::Impl::assumeFastest(double speed) {
    figures->maxSpeed = speed;
    std::vector<StatsRow> rows(STATS_THREADS);
    rows[0].speed2Max = static_cast<float>(speed * speed);
    device->writeAll<StatsRow>(statsRows, rows);
}

}  // namespace rivulet
