// The record of a run: times, density, where the water is, and what went wrong; what --stats writes. Figures of the particles are taken on
// the host from their positions, not from the world's own sums: late figures of a GPU and the code that collides have no say in them.
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

// ms, over the frames.
struct Spread {
    double min = 0, median = 0, p95 = 0, max = 0;
    size_t count = 0;
};
Spread spreadOf(std::vector<double> values);

// The bulk front along +x, m: where the covered share of the floor, in slabs of 2 spacings, last crosses 25 %, interpolated between the
// slabs' centres. A particle less than 2 spacings above the floor covers a square of one spacing. Nothing where no slab is covered that
// far.
std::optional<double> bulkFront(std::span<const vec4> positions, const BoxParams& box, float spacing);

// Whether a point lies in a set voxel, from the bits alone. NaN and points outside the grid: no.
bool inSetVoxel(const VoxelGrid& surface, const vec4& p);

// How the CPU and the GPU shared the work.
struct CooperationStats {
    std::string plan = "off";  // a row of plans()
    double aheadMs = 0;        // mean a frame, of what ran while another drew: finding cells, or stepping
    double overlapMs = 0;      // mean a frame in which it and drawing both worked
    struct Tried {
        std::string plan;  // "gl, thesis"
        double frameMs = 0;
        std::map<std::string, double> passes;  // ms a frame
    };
    std::vector<Tried> tried = {};  // by --cooperate auto, the fastest first
};

// How particles came to be drawn.
struct TransferStats {
    std::string way = "none";  // as TransferFacts; "none": nothing was drawn
    std::string why;           // of the ring: half a sentence, why nothing is shared
    Spread ms;                 // a frame
    double bytes = 0;          // a frame, mean, through the host
    uint64_t waits = 0;        // frames in which it had to wait for the GPU
};

struct RunStats {
    std::string scene, machine, device, backend, method;
    CooperationStats cooperation;
    TransferStats transfer;
    uint32_t particles = 0;  // there at the end, lost ones too
    uint64_t frames = 0;
    double seconds = 0, wallSeconds = 0;  // simulated; on the wall, of all the frames
    Spread simulateMs, renderMs, frameMs;
    std::map<std::string, Spread> passes;           // ms a frame
    double avgCompression = 0, maxCompression = 0;  // fractions; mean over particles and time, largest ever
    double kinetic = 0, potential = 0;              // J
    std::optional<dvec3> centreOfMass;              // m; nothing without particles
    std::optional<double> front;                    // m
    double volume = 0;                              // m^3, of all particles at rest density
    uint32_t lost = 0, penetrations = 0, nan = 0;
    uint64_t voxelsRewritten = 0;  // of solids that change their shape
    std::optional<double>
        standOff;  // m, of centres at rest on a mesh beyond half a spacing, the largest of the fields; nothing without a mesh
    uint64_t substeps = 0;
    double iterations = 0;           // of the pressure solver, mean over substeps
    std::optional<double> residual;  // mean compression that the last one left, as the solver predicts it; nothing: it does not
    dvec3 origin{0.0};               // m: positions above are relative to it
    double dropped = 0;              // s asked for that were not simulated
    double dtMin = 0, dtMax = 0;     // s
    std::vector<std::string> limited;
    // m^3; emitted: blocks, and what emitters and sources let out. debt: of inWorld, what came from skins and is not yet a particle.
    // error: what is not where the rest is, over emitted.
    struct Ledger {
        double emitted = 0, onSurface = 0, inAir = 0, inWorld = 0, debt = 0, evaporated = 0, drained = 0, error = 0;
    } ledger;
};
// What came and what became of it. `late`: of the world; `inWorld`: m^3, of its particles that are there, of `one` m^3 each; `skins`: null
// where there are none.
RunStats::Ledger ledgerOf(const FluidStats& late, double inWorld, double one, const SkinFlows::Ledger* skins);
std::string writeRunStats(const RunStats& stats);  // one JSON object, ends in a newline

// Gathers a run frame by frame.
class RunRecorder {
  public:
    // `readBack`: reads the particles after each frame, for compression and penetrations; costs time that is not counted as simulation.
    // `flows`: what is on the scene's skins; null: nothing.
    RunRecorder(FluidWorld& world, SolidFields fields, bool readBack, const SkinFlows* flows = nullptr);
    // A frame is two calls: when it has been stepped, before anything steps it on; and when it has been drawn. renderMs 0: it was not.
    void stepped(double simulateMs, std::span<const PassTime> passes);
    void drawn(double renderMs, double frameMs, std::span<const PassTime> passes);
    void transferred(const TransferFacts& facts);  // of a frame that is drawn
    // The same particles, from now on in another world: one that goes on for the first.
    void follow(FluidWorld& world) { world_ = &world; }
    // Reads the particles once more for what holds at the end.
    RunStats finish(std::string scene);

  private:
    bool inSolid(const vec4& p) const;

    FluidWorld* world_;
    const SkinFlows* flows_;
    SolidFields fields_;
    bool readBack_;
    std::vector<double> simulate_, render_, frame_, transfer_;
    TransferStats transferStats_;
    std::map<std::string, std::vector<double>> passes_;
    double compressionSum_ = 0, maxCompression_ = 0, wallMs_ = 0;
    uint64_t compressionFrames_ = 0, substeps_ = 0;
    double iterations_ = 0;         // of all substeps
    std::vector<bool> penetrated_;  // by id
};

// The processor, its threads and the system: "Intel(R) Xeon(R) ... , 2 threads, Debian GNU/Linux 12 (bookworm)".
std::string machineName();

}  // namespace rivulet
