// The statistics of a run that --stats writes: times, density, the water's place, and errors. Figures of particles are computed on the host
// from their positions, not from the world's own sums: they depend neither on late GPU figures nor on the collision code.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/compute/device.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/fluid_world.h"
#include "fluid/sim/world/host_particles.h"

namespace rivulet {

// ms, over all frames.
struct Spread {
    double min = 0, median = 0, p95 = 0, max = 0;
    size_t count = 0;
};
Spread spreadOf(std::vector<double> values);

// The values of a run of any length. Memory is bounded: up to 2^16 values all are kept, of more every 2nd, 4th, 8th... `count`, `min` and
// `max` are of all values, `median` and `p95` of those that are kept.
class Samples {
  public:
    void add(double value);
    Spread spread() const;
    uint64_t count() const { return all_.count; }

  private:
    static constexpr size_t kMost = size_t{1} << 16U;
    std::vector<double> kept_;
    uint64_t every_ = 1;
    Spread all_;  // count, min and max
};

// The bulk front along +x, m: where the covered share of the floor, in slabs of 2 spacings, last crosses 25 %, interpolated between the
// slabs' centres. A particle less than 2 spacings above the floor covers a square of one spacing. Nothing where no slab is covered that
// much.
std::optional<double> bulkFront(std::span<const vec4> positions, const BoxParams& box, float spacing);

// Whether a point lies in a set voxel, from the bits alone. NaN and points outside the grid: no.
bool inSetVoxel(const VoxelGrid& surface, const vec4& p);

// How the CPU and the GPU shared the work.
struct CooperationStats {
    std::string plan = "off";  // a row of plans()
    double aheadMs = 0;        // per frame, mean: work beside drawing (finding cells, or stepping)
    double overlapMs = 0;      // per frame, mean: time in which it and drawing overlapped
    struct Tried {
        std::string plan;  // "gl, thesis"
        double frameMs = 0;
        std::map<std::string, double> passes;  // ms per frame
    };
    std::vector<Tried> tried = {};  // by --cooperate auto, the fastest first
};

// How particles were transferred for drawing.
struct TransferStats {
    std::string way = "none";  // as TransferFacts; "none": nothing was drawn
    std::string why;           // of the ring: half a sentence, why buffers are not shared
    Spread ms;                 // per frame
    double bytes = 0;          // per frame, mean, through the host
    uint64_t waits = 0;        // frames in which it had to wait for the GPU
};

struct RunStats {
    std::string scene, machine, device, backend, method;
    CooperationStats cooperation;
    TransferStats transfer;
    uint32_t particles = 0;  // at the end, lost ones included
    uint64_t frames = 0;
    double seconds = 0, wallSeconds = 0;  // simulated; wall time of all frames
    Spread simulateMs, renderMs, frameMs;
    std::map<std::string, Spread> passes;           // ms per frame
    double avgCompression = 0, maxCompression = 0;  // fractions; mean over particles and time, largest ever
    double kinetic = 0, potential = 0;              // J
    std::optional<dvec3> centreOfMass;              // m; nothing without particles
    std::optional<double> front;                    // m
    double volume = 0;                              // m^3, of all particles at rest density
    uint32_t lost = 0, penetrations = 0, nan = 0;
    uint64_t voxelsRewritten = 0;  // of deforming solids
    std::optional<double>
        standOff;  // m, beyond half a spacing: distance of particles at rest from a mesh, the largest of all fields; nothing without a mesh
    uint64_t substeps = 0;
    double iterations = 0;           // of the pressure solver, mean over substeps
    uint32_t asleep = 0;             // particles, at the end: fluid.sleep
    double awakeShare = 1;           // particles that do not sleep, over all, mean over substeps: those that are stepped
    std::optional<double> residual;  // mean compression after the last iteration, as the solver predicts it; nothing: it has no prediction
    dvec3 origin{0.0};               // m: positions above are relative to it
    double dropped = 0;              // s requested but not simulated
    double dtMin = 0, dtMax = 0;     // s
    std::vector<std::string> limited;
    std::vector<ProbeFrame> loads;  // of fluid.probes, a row for each frame that stepped
    // m^3. emitted: blocks, emitters and sources. pending (key `debt`): the part of inWorld that came from skins and is not yet a particle.
    // error: the imbalance over emitted.
    struct Ledger {
        double emitted = 0, onSurface = 0, inAir = 0, inWorld = 0, pending = 0, evaporated = 0, drained = 0, error = 0;
    } ledger;
};
// The balance of volumes. `late`: of the world; `inWorld`: m^3, of its particles, of `one` m^3 each; `skins`: null where there are none.
RunStats::Ledger ledgerOf(const FluidStats& late, double inWorld, double one, const SkinFlows::Ledger* skins);
std::string writeRunStats(const RunStats& stats);  // one JSON object, ends in a newline

// Gathers a run frame by frame.
class RunRecorder {
  public:
    // `readBack`: reads the particles after each frame, for compression and penetrations; its time is not counted as simulation. `flows`:
    // the scene's skins; null: none.
    RunRecorder(FluidWorld& world, SolidFields fields, bool readBack, const SkinFlows* flows = nullptr);
    // Two calls per frame: after its step, before the next one; and after drawing. renderMs 0: it was not drawn.
    void stepped(double simulateMs, std::span<const PassTime> passes);
    void drawn(double renderMs, double frameMs, std::span<const PassTime> passes);
    void transferred(const TransferFacts& facts);  // of a frame that is drawn
    // From now on the same particles are in another world, which continues the first.
    void follow(FluidWorld& world) { world_ = &world; }
    // Reads the particles once more, for the figures at the end. After an interrupted step (FluidWorld::interrupted) they are those of the
    // last whole frame.
    RunStats finish(std::string scene);

  private:
    // The figures of the particles at one time.
    struct End {
        size_t particles = 0, within = 0;  // within: the box
        double kinetic = 0, potential = 0;
        std::optional<dvec3> centreOfMass = {};
        std::optional<double> front = {};
    };
    static End endOf(const HostParticles& now, const FluidWorld& world);
    bool inSolid(const vec4& p) const;
    void takeLoads();

    FluidWorld* world_;
    const SkinFlows* flows_;
    SolidFields fields_;
    bool readBack_;
    Samples simulate_, render_, frame_, transfer_;
    TransferStats transferStats_;
    std::map<std::string, Samples> passes_;
    double compressionSum_ = 0, maxCompression_ = 0, wallMs_ = 0;
    uint64_t compressionFrames_ = 0, substeps_ = 0;
    double iterations_ = 0;           // of all substeps
    double awake_ = 0, present_ = 0;  // particles times substeps
    std::vector<ProbeFrame> loads_;
    std::vector<bool> penetrated_;  // by id
    End last_;                      // after the last frame; only with readBack_
};

// The processor, its threads and the system: "Intel(R) Xeon(R) ... , 2 threads, Debian GNU/Linux 12 (bookworm)".
std::string machineName();

}  // namespace rivulet
