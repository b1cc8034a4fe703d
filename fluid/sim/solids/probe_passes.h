// The passes that measure loads for fluid.probes. They read what the step leaves behind and change nothing of it.
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/solids/probes.h"
#include "fluid/sim/world/fluid_params.h"
#include "fluid/sim/world/particles.h"
#include "fluid/sim/world/step_context.h"
#include "shaders/fluid/solids/probe_row.h"
#include "shaders/fluid/world/step_params.h"

namespace rivulet {

class BodyPasses;
class SolidPasses;
struct Solids;

// What there is to measure, for create.
struct ProbeTargets {
    size_t planes = 0, rigid = 0, deforming = 0;
    std::vector<uint32_t> bodies = {};  // ids
    bool field = false;
    std::vector<SolidRef> colliders;
    static ProbeTargets of(const Solids& solids);
};

class ProbePasses final : public WallLoads {
  public:
    static constexpr size_t kMost = 32;
    static constexpr size_t kMostFrames = 64;  // that take() can return

    // The parts of a world that probes read; they must outlive the passes.
    struct World {
        const SolidPasses& solids;
        const BodyPasses& bodies;
        const Particles& particles;
        const NeighborGrid& grid;
        const PairTraits& traits;
    };
    // Error (badInput): too many probes, a name twice or empty, something that this world does not have; (failed): out of memory.
    static Result<ProbePasses> create(Device& device, const FluidParams& params, const ProbeTargets& targets, const World& world);

    // A frame: begin, its substeps, end. The readings arrive in `into` (late on a GPU). `time`: at the frame's end, s; `seconds`: stepped.
    void begin();
    void end(const std::shared_ptr<ProbeFrame>& into, double time, double seconds);
    // The frames that have arrived since the last call, the oldest first; the last kMostFrames at most.
    std::vector<ProbeFrame> take();
    void reset();  // impulses are counted from 0

    // ---- In a substep, each beside the kernel whose effect it measures ----
    void pressure(const StepParams& step, const Buffer& home, const Buffer& start, const Buffer& position, const Buffer& multiplier,
                  float scale) override;
    void solved(const StepParams& step, const Buffer& solve) override;
    void friction(const StepParams& step, const Buffer& friction, const Buffer& velocity) override;
    void response(const StepParams& step, const Buffer& position, const Buffer& velocity, const Buffer& acceleration, float share) override;
    void responseFromPositions(const StepParams& step, const Buffer& start, const Buffer& corrected) override;
    void predicted(const StepParams& step) override;
    void adhesion(const StepParams& step);  // step.force.w: see fluid/forces/wall_adhesion
    void arrived(const StepParams& step);   // as walls.kernel, before it
    // Contact with solid number `index`: remember() before the collision, contact() after it. `distance`, `normal`, `block`: of its field.
    void remember(ProbeOn on);
    void contact(const StepParams& step, ProbeOn on, uint32_t index, const Buffer& distance, const Buffer& normal, const Buffer& block);
    void bodies(const StepParams& step);  // before BodyPasses::advance

  private:
    struct Spec {
        std::string name;
        double area = 0;  // m^2; 0: none
    };
    struct Totals {
        std::vector<dvec3> impulse, angular;
        std::deque<ProbeFrame> arrived;
    };
    explicit ProbePasses(const World& world) : world_(world) {}
    bool wants(ProbeOn on) const { return wanted_[static_cast<size_t>(on)]; }
    bool wantsStill() const { return wants(ProbeOn::box) || wants(ProbeOn::plane) || wants(ProbeOn::still); }
    bool wantsDistance() const;  // any wall that acts at a distance
    bool wantsWalls() const { return wants(ProbeOn::box) || wants(ProbeOn::plane); }
    Status findKernels();
    // Which of probe_walls: its form without MOVING, and those for moving solids. Only friction depends on the velocity of a wall, so only
    // its form for deforming solids reads their displacement.
    struct AtDistance {
        Kernel still, rigid, deforming;
        bool readsDisplacement = false;
    };
    void atDistance(const AtDistance& kernels, const StepParams& step, const Buffer& position, bool movingToo);
    // What probe_walls and probe_contact need of each particle, put together in `into`.
    void carry(const Kernel& kernel, const StepParams& step, const Buffer& into, std::initializer_list<const Buffer*> from, bool matter);
    void respond(const Kernel& kernel, const StepParams& step, const Buffer& position, const Buffer& velocity, const Buffer& last,
                 const Buffer* matter);

    World world_;
    Device* device_ = nullptr;
    std::array<bool, 7> wanted_{};
    bool walled_ = true, field_ = false, cubic_ = false;
    std::shared_ptr<const std::vector<Spec>> specs_;
    std::shared_ptr<Totals> totals_;
    Buffer probes_, rows_, carried_, before_;  // carried_, before_: see fluid/solids/probe_carry
    PairKernel load_, loadHeld_;
    AtDistance pressure_, friction_, adhesion_;
    Kernel carryPressure_, carryFriction_, carryAdhesion_, carryContact_;
    Kernel integrated_, finished_, predicted_, arrived_, contact_, contactMoving_, body_;
};

}  // namespace rivulet
