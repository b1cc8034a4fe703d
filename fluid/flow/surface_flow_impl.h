// The members of SurfaceFlow, for fluid/flow/surface_flow*.cpp.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "fluid/flow/pendant_drop.h"
#include "fluid/flow/surface_flow.h"
#include "fluid/flow/thesis_tables.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/world/step_context.h"
#include "shaders/flow/flow_step.h"

namespace rivulet {

inline constexpr double kRadian = 3.14159265358979323846 / 180;
inline constexpr double kMicrolitre = 1.0e-9;  // m^3
// Of the support radius of the film's kernel: radius of the paraboloid with the same spread of volume.
inline constexpr double kFilmRadius = 0.6455;
inline constexpr float kJump = 50.0F;        // m/s: a faster skin counts as moved by the user, without drift
inline constexpr double kThinnest = 0.06;    // of the film's reach: the edge of a thinner film is not resolved
inline constexpr double kFilmStep = 0.0045;  // s, longest step with a film
inline constexpr double kCalming = 0.02;     // s, in which parts of a film take the velocity of those around
inline constexpr double kSettling = 0.2;     // s, in which the liquid in a brim comes to rest

// Radius of the foot of a cap over the cube root of its volume.
inline double contactRadius(double degrees) {
    const double c = std::cos(degrees * kRadian), s = std::sin(degrees * kRadian);
    return std::cbrt(3 * s * s * s / (3.14159265358979323846 * (2 - 3 * c + c * c * c)));
}

inline double meanAngle(const SurfaceFlowParams& p) { return 0.5 * double{p.advancing + p.receding}; }

// State that changes from step to step on the host.
struct FlowCourse {
    uint32_t phase = 0;                // of the triangles that dry in this step
    double sinceTurn[DRY_EVERY] = {};  // s
    std::vector<FlowBirth> births;
    uint64_t added = 0;     // picolitres
    bool moved = true;      // the basis must be computed again
    bool stirring = false;  // the skin has a velocity
    dmat4 pose{1.0};        // the skin's frame -> the world, as of the last step
    bool posed = false;
    uint64_t moves = 0;  // how often the basis was computed
    uint32_t steps = 0;
    double time = 0, movedAt = 0;          // s, simulated: now, and when the skin last deformed
    bool deforms = false;                  // the skin has deformed
    std::vector<uint32_t> bornSince = {};  // births of each step after Reports::sortedIn
    uint32_t largestBirth = 0;             // picolitres
};

struct SurfaceFlow::Impl : FlowCourse {
    Device* device = nullptr;
    FlowMesh mesh;
    SurfaceFlowParams params;
    std::unique_ptr<NeighborGrid> grid;
    Particles drops;  // as the grid sorts them: position.w radius, velocity.w volume
    Kernel take, rest, mark, facing, goOver, basis, stand, drive, born, brim, pearl, place, name, merge, law, steer, walk, paint, dry,
        leave;
    PairKernel meet, gather, spread, press;
    Buffer skin, given, hostMoved, point, frames, driven, wanted, painted, begin, footprint, weight;  // of the mesh
    Buffer drop, motion;                                                                              // by id
    Buffer names, sortedOf, side, into, merged, shift, faces, reached;                                // sorted
    Buffer chain, spill;                                                                              // of brims
    Buffer film;                                                                                      // picolitres, of each cell
    Buffer birth, counter, left, hangs;
    std::vector<float> uneven;        // of each place: factor of the holding force
    std::vector<uint32_t> firstCell;  // of each triangle's lattice, and the end
    // Counters that the device reports: shared with reads that are still pending.
    struct Reports {
        uint64_t refused = 0, left = 0, evaporated = 0;  // picolitres
        uint64_t merges = 0;
        uint32_t leaving = 0;  // in the step that is being reported
        bool film = false;     // a film exists
        std::vector<LeftDrop> gone;
        std::vector<HangingDrop> hanging;  // in that step
        // In use at the last sort of step `sortedIn`: later spawns take slots that were free then.
        uint32_t inUse = 0, sortedIn = 0;
        // Where the skin's places were at a time, s, and before: of a skin that deforms on a GPU. Empty: not reported yet.
        std::vector<vec4> places, placesBefore;
        double placesAt = 0, beforeAt = 0;
        uint64_t placesOf = 0;  // FlowCourse::moves
    };
    std::shared_ptr<Reports> reports = std::make_shared<Reports>();
    Bounds corners;  // m, of the skin at rest
    uint32_t brims = 0, brimPlaces = 0;
    std::vector<uint32_t> placesOf;  // of each brim: how many
    std::vector<vec4> shown;         // the places of shape()
    uint64_t shownAs = UINT64_MAX, shownFrom = 0;
    bool asked = false;                  // shape() has been called: from then on a GPU reports the places of each step
    std::optional<ThesisTables> thesis;  // of thesis mode
    std::optional<PendantDrop> pendant;  // of the others
    // Buffers that change from step to step, besides those that are sorted.
    auto remembered() { return std::array{&drop, &motion, &film, &painted, &point, &driven}; }

    uint32_t count() const { return drops.count; }
    Status prepare(Device& on, std::span<const SkinBrim> along);
    Status fillBrims(std::span<const SkinBrim> along);
    Status layLattice();
    static Status checkPlace(uint32_t k, const vec3& position);
    Status checkPositions(std::span<const vec3> positions) const;
    void spawn(const FlowBirth& one);
    void moveSkin(const SurfaceFlowInputs& inputs, const FlowStep& f);
    void setStep(FlowStep& f, StepParams& s, double seconds) const;
    void touchOthers(const FlowStep& f, const StepParams& s);
    Status moveDrops(const FlowStep& f, const StepParams& s);
    Status moveThesis(const FlowStep& f, const StepParams& s);
    ThesisTables::Of forThesis() { return {skin, frames, driven, drop, motion, merged, drops, *grid}; }
    void turnFrame(const dmat4& toWorld, double seconds, FlowStep& f);
    FlowStep stepOf(const SurfaceFlowInputs& inputs, const StepParams& s, double seconds) const;
    void takeCounters(size_t freeAt);
    void takePlaces(const SurfaceFlowInputs& inputs);
};

}  // namespace rivulet
