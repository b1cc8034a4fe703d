// FluidWorld: the one object a host owns. Particles, neighbour grid, method, boundaries; stepped once a frame.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "engine/compute/device.h"
#include "engine/core/log.h"
#include "engine/core/result.h"
#include "fluid/sim/forces/force.h"
#include "fluid/sim/query/volumes.h"
#include "fluid/sim/query/water_query.h"
#include "fluid/sim/solids/solids.h"
#include "fluid/sim/sources/emitter.h"
#include "fluid/sim/world/fluid_params.h"
#include "fluid/sim/world/stats.h"
#include "fluid/sim/world/world_particle.h"
#include "fluid/sim/world/world_state.h"

namespace rivulet {

// Where the particles are on the Device. Valid until the next step(), reset() or destruction. Order changes every step; ids do not.
// Among the slots are `count` particles; where the position's w is negative there is none (a free slot, or a sample on a body).
struct ParticleView {
    const Buffer* position = nullptr;  // vec4: xyz m, w = density / rest density; negative: no particle
    const Buffer* velocity = nullptr;  // vec4: xyz m/s, w unused
    const Buffer* id = nullptr;        // uint
    const Buffer* normal = nullptr;    // vec4: of the surface, w its length; null unless fluid.forces.normals asks for them
    uint32_t count = 0;                // slots of the fluid; one with position.w < 0 is free, or a sample on a body: nothing to draw
    uint32_t slots = 0;                // of the arrays, samples with them
    // vec4: xyz 1/m that red, green and blue fade in its liquid and dye; w 1: and as much as in the world's own liquid, 0: instead of that.
    // Null where all particles are alike.
    const Buffer* absorption = nullptr;
    const Buffer* matterOf = nullptr;  // by id, as Particles::matterOf; null where all particles are alike
    float spacing = 0;                 // m
    float mass = 0;                    // kg, of one of the world's own liquid
    // Positions at the time that has been asked for: with fluid.fixedStep between the last two steps, one step late; else `position`.
    const Buffer* drawn = nullptr;  // vec4: as position
    // The ellipsoids about them: Ellipsoids::buffers(). Null unless fluid.ellipsoids asks for them, and before the first step.
    std::array<const Buffer*, 3> ellipsoids = {};
    // Spray, foam and bubbles, a vec4 each: xyz m, w what is left of its life, s (0: none is there); and xyz m/s, w size (0.5 to 1) + 1
    // spray, 2 foam, 3 bubble. Null unless fluid.foam.most asks for them.
    const Buffer* foam = nullptr;
    const Buffer* foamDrawn = nullptr;  // vec4: as foam, at the time that `drawn` is of
    const Buffer* foamVelocity = nullptr;
    uint32_t foamSlots = 0;
};

// What the scene says to the fluid each frame.
struct FluidInputs {
    std::optional<vec3> gravity = {};  // m/s^2; absent: params().gravity
    // Where solids are when the frame's time has gone by; on the way there they move evenly. Empty: they stay.
    std::span<const Pose> poses = {};                    // of Solids::rigid
    std::span<const std::span<const vec3>> shapes = {};  // m, the vertices of Solids::deforming
    // Of a GPU, for fluid.frameBudget: what the passes of a frame took, some frames ago (Device::takeTimes), ms; 0: not known.
    double deviceMs = 0;
};

class FluidWorld {
  public:
    // Error (badInput): a value out of its range (docs/parameters.md) or that makes no sense together with another; (failed): out of
    // memory. `device` must outlive the world, `forces` are the host's.
    static Result<std::unique_ptr<FluidWorld>> create(Device& device, const FluidParams& params, const Solids& solids, Log log,
                                                      const Sources& sources = {}, std::span<const HostForce> forces = {});
    ~FluidWorld();
    FluidWorld(const FluidWorld&) = delete;
    FluidWorld& operator=(const FluidWorld&) = delete;

    // Advances by `seconds` (a frame) in as many substeps as the CFL, viscous and acoustic limits ask. 0 or less: nothing happens.
    // A frame longer than fluid.longestFrame, maxSubsteps or frameBudget allow advances less, and stats().limited says so: simulated time
    // slows, steps do not grow. time() + pending() + dropped() is all that was asked for.
    void step(const FluidInputs& inputs, double seconds);
    // What step would simulate of a frame, s: what is beyond fluid.longestFrame is dropped, and said. For hosts that cut frames.
    double acceptedSeconds(double seconds);
    // The next step's first work is to find each particle's cell. Who does that elsewhere while this device does something else (the
    // thesis's cooperation, 2.3) runs the kernel fluid/grid/cell_of with this, and gives what it found before the next step. Nothing:
    // before the first step, and where no step's cells are known before it: on the cpu, with bodies, periodic axes, linked lists, or a
    // method that moves particles before it sorts them.
    struct CellWork {
        StepParams step;
        const Buffer *position, *id;  // vec4, uint: as they lie until the next step; step.count of them
    };
    bool knowsCells() const;  // whether there is such work at all
    std::optional<CellWork> cellWork();
    void giveCells(std::span<const uint32_t> cells);  // void where the world has been changed since cellWork()
    void reset();                                     // back to t = 0
    // Takes what can change between steps; `fixed` values wait for a new world. Error (badInput): a value out of its range; nothing
    // changed.
    Status setParams(const FluidParams&);
    Status setSurfaces(std::span<const Surface> surfaces);  // in place of Solids::surfaces. Error: as create
    void visitForces(ParamVisitor& v);                      // the Params of the host's own forces, a group each
    // As many emitters and sinks as there are; shapes and meshes stay as they were. Error (badInput): as setParams.
    Status setSources(const Sources& sources);

    // Water that others hold too, as skins do: Sources::expectedDeposit says there are such, else these must not be called. Places m,
    // velocities m/s. pour: `volume` m^3 has come down there. It is a debt, and whenever that is as much as a particle, one is born above
    // the place. Volume is what is kept: poured water is of the world's own liquid.
    void deposit(const vec3& place, const vec3& velocity, double volume);
    // The particles in a box now that are faster (m/s) or of a lower density ratio than that, 16,384 at most; and those of them that go to
    // others, spacing^3 m^3 each. Wait.
    std::vector<WorldParticle> within(const Bounds& box, float faster = 0, float looser = 1.0e9F);
    void withdraw(std::span<const uint32_t> slots);

    // What the water is at places, and where rays meet it (water_query.h), as of now: at t = 0, and after each step. What a step's end gave
    // birth to is known from the next on. Nothing of the world changes. They wait. Error (failed): out of memory.
    Result<std::vector<FluidSample>> sample(std::span<const vec3> places);
    Result<std::vector<FluidHit>> cast(std::span<const FluidRay> rays);
    // y (m) of the highest surface over (or under) each x, z, looking down from above the box; NaN where there is no water.
    Result<std::vector<float>> heights(std::span<const vec2> places);
    // As sample(), without waiting: `then` hears of it once, 2 to 3 frames later on a GPU (within Device::poll(), which step() calls), on
    // the cpu before this returns; it may outlive the world. Error: as sample(); then nothing is heard.
    Status sampleLater(std::span<const vec3> places, std::function<void(std::span<const FluidSample>)> then);

    // Volumes to watch (volumes.h), 32 at most, whose counts each step brings up to date; late on a GPU. They are saved and restored, and
    // reset() empties them. Errors as VolumePasses::set.
    Status setVolumes(std::span<const Volume> volumes);
    std::vector<VolumeCount> volumes() const;
    // What has entered and left each since the last call, where something has.
    std::vector<VolumeCount> takeVolumeEvents();

    const FluidParams& params() const;
    ParticleView particles() const;
    const FluidStats& stats() const;  // late on a GPU
    float fastestFall() const;        // m/s, what its water reaches by falling, with what it starts with
    double time() const;              // s simulated
    double pending() const;           // s asked for that wait for a whole fluid.fixedStep
    double dropped() const;           // s asked for that were not and will not be simulated
    int lastSubsteps() const;         // of the last step(), not late
    // The pressures of the last substep, Pa, slot by slot as particles(); of pbf, what its corrections would take. They are what pairs
    // press with: on a lattice with a support of 2 spacings 5 % more than they pass on, and one by one 10 to 20 % off. Reads back and
    // waits.
    std::vector<float> pressures() const;
    const std::vector<Pose>& poses() const;  // of the rigid solids, as they are now: where time slows, short of what was asked
    const std::vector<BodyState>& bodies() const;
    const std::vector<BodyLoad>& bodyLoads() const;  // of the last substep
    std::vector<Pose> drawnPoses() const;            // the same, as ParticleView::drawn
    uint64_t voxelsRewritten() const;                // of deforming solids, since the start
    Device& device() const;

    // Everything in a world is float and relative to its origin, a place (m) in the host's world. Moving it moves all there is.
    const dvec3& origin() const;
    void setOrigin(const dvec3& origin);
    dvec3 toHost(const vec3& p) const { return origin() + dvec3(p); }
    vec3 fromHost(const dvec3& p) const { return {p - origin()}; }

    // All that the next step depends on, into sections of `state`; bit for bit what a cpu goes on with. Waits for the device.
    // Error (failed): the host of the bodies remembers something that it cannot save.
    Status savable() const;
    void save(WorldState& state);  // of a savable world
    // Goes on from there, on whichever device. Others who have sections in `state` take theirs before. Error: as WorldState::take and
    // allTaken; the params that are `fixed` or the solids are others. The world is then as it was.
    Status restore(WorldState& state);
    // Goes on where another world is that has the same box and spacing, among solids that stand at `poses` and have `shapes` now (as
    // FluidInputs; all of them): with its time, its particles, but for those that are inside a solid here, and its bodies, if they are
    // the same, and its foam, where as many flecks may be here. What emitters and sinks have done is counted anew. Waits for both. Error
    // (badInput): another box or spacing, liquids that this world does not know, more particles than it has room for.
    Status goOnFrom(FluidWorld& other, std::span<const Pose> poses, std::span<const std::span<const vec3>> shapes);

  private:
    FluidWorld();
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
