// FluidWorld: the object that a host owns. It holds particles, neighbour grid, method and boundaries, and is stepped once a frame.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "engine/core/result.h"
#include "fluid/sim/forces/force.h"
#include "fluid/sim/query/volumes.h"
#include "fluid/sim/query/water_query.h"
#include "fluid/sim/solids/body_states.h"
#include "fluid/sim/solids/wet_surface.h"
#include "fluid/sim/sources/emitter.h"
#include "fluid/sim/world/fluid_params.h"
#include "fluid/sim/world/particle_view.h"
#include "fluid/sim/world/stats.h"
#include "fluid/sim/world/world_particle.h"
#include "fluid/sim/world/world_state.h"

namespace rivulet {

// The inputs of a frame.
struct FluidInputs {
    std::optional<vec3> gravity = {};  // m/s^2; absent: params().gravity
    // The solids at the end of the frame; within the frame they move uniformly. Empty: they do not move.
    std::span<const Pose> poses = {};                    // of Solids::rigid
    std::span<const std::span<const vec3>> shapes = {};  // m, the vertices of Solids::deforming
    // For limits of time on a GPU: time of the passes of an earlier frame (Device::takeTimes), ms; 0: unknown.
    double deviceMs = 0;
    // Limit on the computing time of this frame's steps, ms, besides fluid.frameBudget; 0: none. A window that is to answer has one.
    double mostMs = 0;
};

// Receives the share of a world's start that is done, 0 to 1, some times in a second; false cancels it. On the thread that called create().
using StartProgress = std::function<bool(double share)>;

class FluidWorld {
  public:
    // Error (badInput): a value out of its range (docs/parameters.md) or in conflict with another; (failed): out of memory, interrupted
    // (Device::stopOn), or `progress` cancelled it. `device` must outlive the world, `forces` are the host's.
    static Result<std::unique_ptr<FluidWorld>> create(Device& device, const FluidParams& params, const Solids& solids, Log log,
                                                      Sources sources = {}, std::span<const HostForce> forces = {},
                                                      const StartProgress& progress = {});
    ~FluidWorld();
    FluidWorld(const FluidWorld&) = delete;
    FluidWorld& operator=(const FluidWorld&) = delete;

    // Error (badInput): what step() would not take of these: poses and shapes that do not fit the solids, are not finite or too fast;
    // gravity beyond 1,000 m/s^2; a step that is not finite or longer than an hour. step() reports it, and goes on without that input.
    Status checkInputs(const FluidInputs& inputs, double seconds) const;
    // Advances by `seconds` (a frame) in as many substeps as the CFL, viscous and acoustic limits require. 0 or less: no effect. A frame
    // longer than fluid.longestFrame, maxSubsteps or frameBudget allow advances less, and stats().limited gives the reason: simulated time
    // slows down, steps do not grow. time() + pending() + dropped() is the sum of all `seconds`, but for steps that fail: see lastStep().
    void step(const FluidInputs& inputs, double seconds);
    // Error (failed) of the last step() or reset(): memory ran out. After its first substeps a frame that fails keeps them, as time() says;
    // before them nothing has moved, and the same call later, with memory, has the same results as if this one had never been. Time that
    // was not simulated counts as not requested. Or the state is incomplete, as below, or because memory ran out within a substep, or
    // because a function of the host (BodyHost, HostForce) threw or did not return: then as after an interruption. A stop is no error.
    Status lastStep() const;
    // Whether the last step was interrupted: the flag of Device::stopOn became true within it. It then ran no further passes, on the cpu
    // none of their chunks, and returned. time() and stats() are those before the step, or those after it if only its last passes were
    // skipped, but particles, bodies and counts may be of neither. step() then does nothing but report that, save() and queries return an
    // Error, until reset(), restore() or continueFrom() set valid values; the flag must be false by then. A step that begins while the flag
    // is true does nothing, and the world stays valid. create() returns an Error (failed) if it is interrupted.
    bool interrupted() const;
    // The part of a frame that step() would simulate, s, for hosts that cut frames: time beyond fluid.longestFrame is dropped and reported.
    double acceptedSeconds(double seconds);
    // The first work of the next step is to find each particle's cell. Another device can do it meanwhile (cooperation, thesis 2.3): it
    // runs the kernel fluid/grid/cell_of with this, and the host passes the result to setCells before the next step. Empty: before the
    // first step, on the cpu, with bodies, periodic axes or linked lists, and with a method that moves particles before it sorts them.
    struct CellWork {
        StepParams step;
        const Buffer *position, *id;  // vec4, uint: in their order until the next step; step.count entries
    };
    bool hasCellWork() const;  // true if this world can have such work
    std::optional<CellWork> cellWork();
    void setCells(std::span<const uint32_t> cells);  // ignored if the world has changed since cellWork()
    void reset();                                    // back to t = 0
    // Sets values that can change between steps; `fixed` ones stay. Error (badInput): a value out of its range; nothing has changed then.
    Status setParams(const FluidParams&);
    Status setSurfaces(std::span<const Surface> surfaces);  // in place of Solids::surfaces. Error: as create
    void visitForces(ParamVisitor& v);                      // the Params of the host's own forces, one group per force
    // Sets the emitters, sinks and dry volumes. With as many as before, their shapes and meshes stay; with another number, or none, all
    // emitters begin anew: particles that were due and waited for room are dropped. Added emitters spawn into free slots (see
    // fluid.maxParticles, Sources::more). Another number waits for a GPU. Error (badInput): as setParams; with fluid.grid linked_list, or
    // in a world that exchanges water, another number; an emitter with a liquid of its own, in a world that began with one liquid.
    Status setSources(const Sources& sources);
    const std::vector<DryVolume>& dry() const;  // Sources::dry, where the last step left them; of those that move with bodies, as bodies()
    std::vector<DryVolume> ownDry() const;      // without waiting: those that move with a body in its frame (ownDry of dry.h)

    // Walls that are added, moved at once and removed while the world runs: planes, fields, moving solids and surfaces of `solids` in place
    // of those there are; bodies stay, those of `solids` are not read. `poses`: of solids.rigid now; empty: their own, which are those at
    // t = 0. A field that is in the world already is not read again, and a deforming solid keeps its shape; those that are no longer named
    // may be destroyed when this returns. Nothing else of the world changes: without walls that differ, its steps are the same bit for bit.
    // A wall that is added does not move the water aside. Particles inside it, or behind a plane, are removed if `removeInside`, and
    // FluidStats::drained counts them; where memory for that is short they stay, and the log says so. Else they stay, and collisions push
    // them out through its nearest side or keep them where they are. With fluid.wetness walls that stay keep their values; added ones are
    // dry. reset() leaves out particles of t = 0 that would be inside. Error (badInput): the box is periodic along all axes and the world
    // began without walls, so that its kernels have none; as create. (failed): out of memory; a stop is asked. Nothing has changed then.
    Status mayChangeWalls() const;  // the first of these
    Status setWalls(const Solids& solids, std::span<const Pose> poses = {}, bool removeInside = true);

    // Bodies that are added and removed while the world runs, within fluid.bodies.maxSamples; the others keep their states and loads. Those
    // of Solids::bodies have the ids 0, 1, ..., others `id`, or one above all before. `body.state`: now, and after a reset. Particles
    // inside it are removed as by setWalls; without BodyShape::distance, or without `removeInside`, its samples push them out, hard. A
    // saved state can be restored where the same bodies are. Error (badInput): as create; no room; a sample in a wall; a BodyHost without
    // `added`; no such id, or one twice; a probe measures the body or a dry volume moves with it; called within a step. (failed): out of
    // memory; a stop is asked (Device::stopOn); as lastStep(). Nothing has changed then.
    Result<uint32_t> addBody(const Body& body, bool removeInside = true, std::optional<uint32_t> id = {});
    Status removeBody(uint32_t id);
    const std::vector<uint32_t>& bodyIds() const;  // of bodies() and bodyLoads(), in the order in which they were added

    // Sets fluid.attributes[attribute] of the particles with these ids (ParticleView::id, each once), or of all in a volume now, whose id
    // is not read. Neither waits. Error (badInput): no such attribute or id; values that are not finite; (failed): out of memory, a stop.
    Status setAttribute(size_t attribute, std::span<const uint32_t> ids, std::span<const vec4> values);
    Status paint(size_t attribute, const Volume& inside, const vec4& value);

    // Exchange with other owners of water, such as skins; only if Sources::expectedDeposit is above 0. deposit: adds `volume` m^3 of the
    // world's own liquid; m, m/s. It is pending until it suffices for a particle, which is spawned above the place. Volume is conserved.
    void deposit(const vec3& place, const vec3& velocity, double volume);
    // within: the particles now in a box that are faster (m/s) or of a lower density ratio than given, 16,384 at most. withdraw: removes
    // some of them, spacing^3 m^3 each. Both wait. withinLater and withdrawLater do not wait: they call `then` once, 2 to 3 frames later
    // on a GPU, on the cpu before they return; it may outlive the world. `claims`: in ascending order of ids, each once, 16,384 at most. A
    // particle that has moved away from the claimed place stays. `then` receives, for each claim, 1 if its particle was removed, else 0.
    std::vector<WorldParticle> within(const Bounds& box, float faster = 0, float looser = 1.0e9F);
    void withdraw(std::span<const uint32_t> slots);
    void withinLater(const Bounds& box, float faster, float looser, std::function<void(std::span<const WorldParticle>)> then);
    void withdrawLater(std::span<const ParticleClaim> claims, std::function<void(std::span<const uint32_t>)> then);

    // The water at points, and hits of rays (water_query.h), at the current time; particles spawned at the end of a step count from the
    // next one on. The world does not change. These calls wait. Error (failed): out of memory; the last step was interrupted.
    Result<std::vector<FluidSample>> sample(std::span<const vec3> places);
    Result<std::vector<FluidHit>> cast(std::span<const FluidRay> rays);
    // y (m) of the highest surface over (or under) each x, z, looking down from above the box; NaN where there is no water.
    Result<std::vector<float>> heights(std::span<const vec2> places);
    // As sample(), without waiting: `then` as of withinLater(), in Device::poll(), which step() calls. Error: as sample(); not called then.
    Status sampleLater(std::span<const vec3> places, std::function<void(std::span<const FluidSample>)> then);

    // Volumes to watch (volumes.h), 32 at most; each step updates their counts, late on a GPU. Saved and restored; reset() empties them.
    Status setVolumes(std::span<const Volume> volumes);
    std::vector<VolumeCount> volumes() const;
    // Returns the particles that entered and left since the last call, for each volume with any.
    std::vector<VolumeCount> takeVolumeEvents();

    // The loads that fluid.probes measured in the frames since the last call, the oldest first, 64 frames at most; on a GPU two or three
    // frames late. stats().loads is the last of them. Impulses are summed from 0 after reset(), restore() and a change of the probes.
    std::vector<ProbeFrame> takeLoads();

    const FluidParams& params() const;
    ParticleView particles() const;
    WetnessView wetness() const;              // null if fluid.wetness.on is off
    const FluidStats& stats() const;          // late on a GPU
    float fastestFall() const;                // m/s, speed after the largest possible fall, including the initial speed
    double time() const;                      // s simulated
    double pending() const, dropped() const;  // s passed to step() that wait for a whole fluid.fixedStep; that will not be simulated
    int lastSubsteps() const;                 // of the last step(), not late
    // The pressures of the pair forces in the last substep, Pa, in the order of particles(); pbf: equivalent to its corrections; dfsph:
    // negative under tension. On a lattice with the default support they are 3 % above the transmitted pressure, for a single particle the
    // error is 6 to 10 %. For the load on a wall use fluid.probes. Reads back and waits.
    std::vector<float> pressures() const;
    const std::vector<Pose>& poses() const;          // current poses of the rigid solids; if time slows down, not yet FluidInputs::poses
    const std::vector<BodyState>& bodies() const;    // of the last substep; waits on a GPU that moves bodies (BodyHost::contacts)
    const std::vector<BodyLoad>& bodyLoads() const;  // as bodies()
    // Without waiting: where bodies are expected now (exact where the host moves them); where they were at an earlier time(), if known.
    const std::vector<BodyState>& expectedBodies() const;
    std::optional<std::vector<BodyState>> bodiesAt(double time) const;
    BodyRows bodyRows() const;
    std::vector<Pose> drawnPoses() const;  // the same, as ParticleView::drawn
    uint64_t voxelsRewritten() const;      // of deforming solids, since the start
    Device& device() const;

    // All in a world, inputs included, is float and relative to its origin, a place (m) in the host's world, which costs nothing to move. A
    // host that moves its own origin by `by` calls setOrigin(origin() - by): all stays where it is in space, and its poses stay the same.
    const dvec3& origin() const;
    void setOrigin(const dvec3& origin);
    dvec3 toHost(const vec3& p) const { return origin() + dvec3(p); }
    vec3 fromHost(const dvec3& p) const { return {p - origin()}; }

    // Writes all that the next step depends on into sections of `state`; a cpu continues from it bit for bit. Waits. Error (failed): the
    // host of the bodies has a state that it cannot save; the last step was interrupted.
    Status savable() const;
    void save(WorldState& state);  // of a savable world
    // Continues from a saved state, on any device, after other owners of sections took theirs. Error: as WorldState::take and allTaken;
    // other `fixed` params or solids. The world is then as it was.
    Status restore(WorldState& state);
    // Continues from another world, with solids at `poses` and with all `shapes` (as FluidInputs). It takes over the time, the particles
    // outside solids here, the bodies if they are the same, and the foam if this world has as many slots. The counts of emitters and sinks
    // begin at 0. Waits for both. Error (badInput): another box or spacing, liquids that are not here, too few slots for particles.
    Status continueFrom(FluidWorld& other, std::span<const Pose> poses, std::span<const std::span<const vec3>> shapes);

  private:
    FluidWorld();
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
