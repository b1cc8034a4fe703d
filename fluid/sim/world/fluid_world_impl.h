// FluidWorld::Impl: the parts of a world, only for fluid_world*.cpp: created in _start, stepped in _step, saved in _state.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fluid/sim/forces/world_forces.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/grid/particle_bounds.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/query/volumes.h"
#include "fluid/sim/query/water_query.h"
#include "fluid/sim/sleep/sleep_passes.h"
#include "fluid/sim/solids/body_passes.h"
#include "fluid/sim/solids/probe_passes.h"
#include "fluid/sim/solids/solid_passes.h"
#include "fluid/sim/solids/wet_passes.h"
#include "fluid/sim/sources/block.h"
#include "fluid/sim/sources/dry_passes.h"
#include "fluid/sim/sources/exchange_passes.h"
#include "fluid/sim/sources/source_passes.h"
#include "fluid/sim/surface/ellipsoids.h"
#include "fluid/sim/surface/foam_passes.h"
#include "fluid/sim/world/drawn_positions.h"
#include "fluid/sim/world/fluid_world.h"
#include "fluid/sim/world/frame_stepper.h"
#include "fluid/sim/world/particles.h"
#include "fluid/sim/world/step_limits.h"

namespace rivulet {

class CpuDevice;

// The time of a world since t = 0, and how it was stepped.
struct WorldClock {
    double time = 0, dropped = 0;  // s
    double frameLength = 0;        // s, of the current frame: the substeps' shares refer to it
    uint64_t frame = 0;
    double dtMin = 0, dtMax = 0;  // s
    int lastSubsteps = 0;         // of the last frame
    int lastPiece = 0;            // substeps of its last piece (FrameStepper)
    double budget = 0;            // ms, of the current frame; 0: none
    double mostMs = 0;            // FluidInputs::mostMs of it
    bool budgetReported = false, costReported = false;
};

struct FluidWorld::Impl {
    std::shared_ptr<const void> revision = std::make_shared<const char>();  // of ParticleView
    void change() { revision = std::make_shared<const char>(); }
    Device* device = nullptr;
    FluidParams params;
    Log log;
    std::unique_ptr<Method> method;
    std::unique_ptr<NeighborGrid> grid;
    std::optional<ParticleBounds> around;  // of the particles, if the grid is a window
    Particles particles;
    std::vector<NewParticle> start;
    std::optional<BlockParams> placed;  // bounds, highest speed and liquid of the particles that the host placed
    uint32_t startCount = 0;            // particles at the start of counting: those of `start`, or of the world that this one continues
    SolidPasses solids;
    Sources sourceSetup;  // emitters and sinks
    SourcePasses sources;
    DryPasses dry;
    std::vector<DryVolume> dryBefore;  // where sleeping water last was disturbed by them
    ExchangePasses exchange;           // for other owners of water
    // Particles removed by them; shared with reads in flight.
    std::shared_ptr<uint64_t> withdrawn = std::make_shared<uint64_t>(0);
    // Particles that emitters and sinks spawned and removed before setSources() replaced them.
    struct {
        uint64_t emitted = 0, drained = 0;
    } before;
    bool hasFree = false;  // free slots may be among the sorted particles
    VolumePasses volumes;
    WaterQuery query;             // created at the first query
    bool sortedForQuery = false;  // as `sorted`, for position and velocity before the first step
    std::optional<FoamPasses> foam;
    std::optional<WetPasses> wet;      // empty: fluid.wetness.on is off
    std::optional<SleepPasses> sleep;  // empty: fluid.sleep.on is off
    vec3 sleptUnder{0.0F};             // gravity of the last frame
    bool sorted = false;               // the grid matches the current order of particles
    uint32_t slots = 0;                // slots of particles: those of the blocks and free ones
    bool coloured = false;             // particles differ in colour
    float mostViscous = 0;             // m^2/s, of the world's liquids
    BodyPasses bodies;
    ProbeTargets probeTargets;
    std::optional<ProbePasses> probes;  // empty: the scene has none
    Buffer statsRows, corner;
    Kernel stats, wrap, wrapFromPositions, gatherMatter, gatherVectors, setAttribute, paintAttribute;
    Buffer attributeIds, attributeValues;  // of setAttribute
    // Painted since the grid's sleepers were sorted: those that ParticleView shows in place of them.
    struct {
        std::shared_ptr<const void> of, shown;
    } painted;
    PairTraits traits;
    WorldForces forces;
    StepLimits limits;
    SolveFigures solve;
    double iterations = 0;  // sum over the substeps of this frame
    double stepped = 0;     // FluidStats::stepped
    FrameStepper stepper;
    DrawnPositions drawn;
    Ellipsoids ellipsoids;
    std::vector<Pose> posesBefore;                                         // the rigid solids', before the last fixed step
    std::shared_ptr<const void> sleepersBefore;                            // NeighborGrid::sleepers(), before it
    std::shared_ptr<FluidStats> figures = std::make_shared<FluidStats>();  // shared with reads in flight
    StepParams step{};
    vec3 gravity{0.0F};
    WorldClock clock;
    bool cellsValid = false;        // since cellWork()
    bool interrupted = false;       // the last step was, or the last return to valid values
    bool stepping = false;          // step() is under way
    bool solidsChanged = false;     // since the world was created
    bool changing = false;          // a change of the values is under way; stays true if it did not complete
    Status last = ok();             // of step() or reset()
    std::optional<Error> shortage;  // memory that this frame, or the start, lacks
    StartProgress progress;         // while it is created
    bool cancelled = false;         // by it
    bool startInterrupted = false;  // while it was corrected

    Status prepare(const Solids& given);
    Status prepareProbes(const FluidParams& next);
    Status replaceSources(const Sources& next);
    void setDry(const std::vector<DryParams>& volumes);                                     // sound ones
    Status removeInside(const std::function<bool(const vec3&)>& inside, const char* what);  // particles
    Status mayLink() const;  // Error: fluid.grid linked_list does not support a feature of the scene
    Status checkPrecision() const;
    Status checkStart() const;
    void fillStart();
    void relaxStart(const Solids& given);
    std::vector<vec4> corrected(CpuDevice& cpu, const FluidParams& p, const Solids& around, std::vector<NewParticle> particles,
                                double until, int rounds, double from, double to);
    std::vector<vec3> relaxedTile(float jitter);
    bool advanced(double share);  // reports the part of the start that is done; false: cancelled
    bool largeStart() const;      // so that blocks are made of tiles
    bool startsClosed() const;
    const BlockParams& blockOf(const NewParticle& particle) const {
        return particle.block == kNoBlock ? *placed : params.blocks[particle.block];
    }
    Status findSlots();
    void findLiquids();
    void writeStart(const std::vector<bool>& leftOut = {});  // `leftOut`: of the particles of `start`
    std::vector<bool> insideAdded();
    Status mayChange() const;  // walls and bodies. Error (failed): a stop is asked; as whole()
    Status mayChangeBodies() const;
    // What else has lists of the bodies: made before these change, so that no memory is needed afterwards.
    struct BodyLists {
        std::vector<uint32_t> forProbes, forDry;  // ids
        std::vector<Pose> starts;
        std::shared_ptr<const void> revision = std::make_shared<const char>();
    };
    BodyLists bodyLists() const;
    void bodiesChanged(BodyLists lists);
    // After a change that stays. Memory that `work` lacks is no error of the change: the log says so. Returns whether there was enough.
    template <class Work>
    bool afterChange(const Work& work);
    std::vector<WetSurface::Part> wetParts(std::vector<WetSurface::Part> ofWalls) const;  // with the bodies
    void writeAttributes();
    void gatherForDrawing();
    void attributesChanged();
    Bounds reachable() const;  // m
    StepLimits::Inputs limitInputs() const;
    float fastestFall() const { return limits.fastestFall(limitInputs()); }
    void assumeFastest(double speed);  // m/s; used before the first measurement
    void warn();
    StepLimit stepLimit(double now, double frameSeconds) const;  // s
    void fillStep();
    double accepted(double seconds);
    Status prepareFrame();
    int stepFrame(const FluidInputs& inputs, double seconds);
    void endFrame(const FrameStepper::Frame& frame, double seconds, double simulated, int substeps);
    double stepPiece(double length, double begin, double span, int& substeps, bool& stop);
    void report(const std::string& sentence);
    Status whole() const;          // Error (failed): the last step was interrupted, or did not end
    void invalidateCells();        // particles are moved between steps
    Status follow(StepParams& s);  // moves a grid that is a window to the particles. Error (noMemory): nothing has changed
    template <class Answer, class Ask>
    Result<std::vector<Answer>> ask(size_t count, const Ask& how);
    Status prepareQuery(StepParams& params);
    Status prepareSleep();
    void disturbSleep();                    // before a frame: where something other than water may move it
    void disturbAround(const Bounds& box);  // m: water in it and a little further
    bool build(bool fromPositions, double from, double to);
    // `last`: of a piece of its frame. false: out of memory (`shortage`); the newest state is as it was. Or interrupted.
    bool substep(double dt, double from, double to, bool last);
    void fillLedger(FluidStats& stats) const;
    void gatherStats(int substeps, double until);
};

}  // namespace rivulet
