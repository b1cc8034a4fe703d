// Sleeping water (Goswami and Pajarola 2011): particles of calm cells are not stepped. They stay neighbours of the others at full accuracy,
// with the pressure that they had, and wake when the water around them moves.
//
// A cell of the neighbour grid is disturbed when the rms way of its particles since they were last noted, or the way of one of them, or of
// a sample on a body, exceeds a bound, when its pressures are off their mean, and when a moving wall, a body that has crept on, an emitter,
// a sink or a host touches it. A cell sleeps if neither it nor a neighbour was disturbed for a time. A disturbed cell wakes its neighbours
// in the same step; so what moves is a support radius or more away from what sleeps, but for the one step in which a fast particle arrives.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/math.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/world/fluid_params.h"
#include "fluid/sim/world/particles.h"
#include "fluid/sim/world/pose.h"
#include "fluid/sim/world/world_state.h"
#include "shaders/fluid/sleep/sleep_params.h"

namespace rivulet {

class SleepPasses {
  public:
    // `step`: as NeighborGrid::fill leaves it; `count`: slots of the world; `values`: those of its method. Error (failed): out of memory.
    static Result<SleepPasses> create(Device& device, const StepParams& step, uint32_t count, const AsleepValues& values);

    // Before the steps of a frame: cells that this box (m) touches are disturbed at `now` (s).
    void disturb(const StepParams& step, const Bounds& box, double now);
    // Of the bodies when each last disturbed cells: the world's, from where it measures how far they have crept. Part of a saved state.
    std::vector<Pose>& bodyPoses() { return poses_; }
    // All cells are: gravity, a parameter or something else that acts everywhere has changed.
    void disturbAll(double now);
    // The same for a world that starts or continues at `now`, from particles that were not noted.
    void reset(double now);

    // At the end of a step, `now`: finds which particles fall asleep and which wake; the next sort carries it out. `fluid`: the bounds;
    // `gravity` m/s^2; `pressure`: the method's.
    void run(const FluidParams& fluid, const StepParams& step, float gravity, NeighborGrid& grid, Particles& particles, double now,
             const AsleepPressure& pressure);
    // The next sort changes slots of sleeping particles, although no cell falls asleep or wakes: a host has removed some.
    void slotsChange() { device_->fill(changed_, 1); }
    // After a sort of sleeping particles: puts back what neighbours read of them.
    void recall(const StepParams& step, const NeighborGrid& grid, const Particles& particles, const AsleepPressure& pressure);

    // At the end of a frame: the ellipsoids of sleeping particles, which are not found anew, follow them to their slots. Where they were
    // never found, because nothing was drawn when the water fell asleep, it wakes at `now` (s). prepareEllipsoids() comes first: nothing
    // the second time. Error (noMemory).
    Status prepareEllipsoids();
    void keepEllipsoids(const StepParams& step, const NeighborGrid& grid, const Particles& particles,
                        const std::array<const Buffer*, 3>& ellipsoids, double now);

    // All data that a step depends on, as part of a saved state. Error: as WorldState::take.
    struct Saved {
        double since = -1;
        std::vector<std::vector<float>> values;
        std::vector<std::vector<vec4>> ellipsoids;  // none: they were not drawn
        std::vector<Pose> poses;
    };
    void save(WorldState& state);
    Result<Saved> take(WorldState& state, size_t bodies);
    void restore(const Saved& saved);

  private:
    struct Kept {
        AsleepValue value;
        Buffer byId;
    };
    SleepStep block(const StepParams& step, double now) const;
    std::vector<std::pair<std::string, Buffer*>> remembered();

    Device* device_ = nullptr;
    Kernel watch_, note_, disturb_, turn_, apply_, keep_, recall_, recallPressure_, recallZero_, drawn_;
    Buffer disturbed_, asleep_, changed_, noted_;
    std::vector<Kept> kept_;
    std::array<Buffer, 3> ellipsoids_;  // by id
    bool holdsEllipsoids_ = false;      // of this water
    bool resorted_ = true;              // cpu: sleeping particles were, since keepEllipsoids
    uint32_t cells_ = 0, count_ = 0;
    std::vector<Pose> poses_;  // see bodyPoses()
    double since_ = -1;        // s, when ways were last noted; negative: never
};

}  // namespace rivulet
