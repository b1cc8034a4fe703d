// SurfaceFlow: drops that walk over a mesh's triangles, merge, are held and leave. UVs are not used.
// Drop: Furmidge 1962 (what holds it), Cox 1986, Voinov 1976, Le Grand, Daerr and Limat 2005 (what slows it). Drops that overlap and are
// too large for one drop are a film: Nusselt 1916, its height by a sum over neighbours.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/compute/device.h"
#include "engine/core/params.h"
#include "fluid/flow/flow_mesh.h"
#include "fluid/flow/pendant_drop.h"
#include "fluid/flow/thesis_tables.h"
#include "shaders/fluid/world/step_params.h"

namespace rivulet {

// The liquid and how it clings. The defaults are tears.
struct SurfaceFlowParams {
    float surfaceTension = 0.0436F;  // N/m
    float viscosity = 1.73e-3F;      // Pa s
    float density = 1005.0F;         // kg/m^3
    float advancing = 60.0F;         // deg, contact angle at the front of a drop
    float receding = 40.0F;          // deg, at the back
    float hold = 1.0F;               // k of the force that holds a drop: k w gamma (cos receding - cos advancing)
    float unevenness = 0.0F;         // of that force, over the skin: standard deviation over the mean, in spots of 3 and 9 mm
    float drag = 60.0F;              // beta of its viscous drag: beta w eta |v|
    float wallFriction = 0.0F;       // Pa s/m, of the liquid on the skin: with it beta follows from the contact angles, see dragOf()
    float adhesion = 1.0F;           // factor on the largest volume that hangs under a skin (PendantDrop)
    float airDrag = 1.0F;            // drag coefficient of a drop in the wind
    float largestDrop = 30.0F;       // microlitres: larger sums stay several drops, except where they hang
    float touch = 0.8F;              // of the sum of two drops' radii: at this distance they merge
    float footprint = 2.5e-3F;       // m, over which a drop's weight is spread
    float trail = 1.0e-5F;           // m, thickness of the film that a drop leaves
    float trailWidth = 0.7F;         // of the drop's width
    float slip = 0.85F;              // share of the holding force that a wet trail removes
    float steer = 0.5F;              // of the holding force: how strongly a trail beside the drop attracts it
    float evaporation = 2.0e-8F;     // m/s, of the film
    float filmCell = 7.0e-4F;        // m, largest edge of the film's cells
    float filmReach = 5.0e-3F;       // m, support radius of the sum for a film's height
    bool pearls = true;              // a drop that is too fast for its back sheds small drops
    bool contact = true;             // drops move to skin that faces them
    float brimHolds = 8.0F;          // microlitres in a full brim
    float brimStarts = 1.2F;         // microlitres, in a brim at the start
    float brimWidth = 6.0e-4F;       // m, radius of the liquid in a brim
    float tear = 4.5F;               // microlitres, of a drop that spills over it
    int capacity = 4096;             // drops at most
    void visit(ParamVisitor& v);
};

// beta: `drag`, or with a wallFriction kappa by Cox and Voinov. A moving contact line has the angles theta^3 = theta_s^3 +- 9 Ca ln(b / a),
// so the force k w gamma (cos receding - cos advancing) grows by 3 k ln(b / a) (sin r / r^2 + sin a / a^2) w eta |v|. b is 1 mm, a the slip
// length eta / kappa (Navier); kappa is the same for silicone oils of all viscosities (Henot et al. 2018). Measured: 10 to 1040 cP, 45 to
// 58 deg.
double dragOf(const SurfaceFlowParams& p);
// m/s: a drop that runs faster has a corner behind: its contact line recedes with half the receding angle, by the same law. Le Grand, Daerr
// and Limat 2005 saw corners at 21, 23 and 26 degrees of 45.5, 42.7 and 46.8, with 104 cP at Ca 0.005, which gives ln(b / a) = 8.4.
double cornerSpeed(const SurfaceFlowParams& p);

struct SurfaceFlowInputs {
    vec3 gravity{0.0F, -9.81F, 0.0F};  // m/s^2, in the world
    vec3 wind{0.0F};                   // m/s, of the air, in the world
    dmat4 toWorld{1.0};                // the skin's frame -> the world: turned and moved, not scaled
    // m, in the skin's frame: the mesh's positions if the skin deforms, all of them. Its motion acts on the drops, from the second step on:
    // the first positions are where the skin is.
    std::span<const vec3> positions = {};
    const Buffer* moved = nullptr;  // the same on the device (vec4, w unused), instead. A place that is not finite stays where it was
};

// A row of places along an edge, for example a lower lid, that fills before it spills.
struct SkinBrim {
    std::vector<SkinPoint> places;
    std::vector<SkinPoint> spills;  // of each place: where spilled liquid begins to run
    uint32_t picolitres = 1200000;  // in it at the start, from end to end
};

struct SkinDrop {
    uint32_t id = 0;
    SkinPoint at;
    vec3 position{0.0F}, velocity{0.0F};  // m, m/s
    double volume = 0;                    // m^3
    double way = 0;                       // m, walked since it appeared
    double film = 0;                      // 0 a drop, 1 part of a film
};

// A drop that hangs from the skin: one that is too small to sag is none of them.
struct HangingDrop {
    uint32_t id = 0;
    vec3 position{0.0F};  // m, of the middle of its foot, in the skin's frame as all vectors
    vec3 up{0.0F};        // unit, the skin's mean normal
    vec3 pull{0.0F};      // m/s^2: gravity, wind and inertia
    float curvature = 0;  // 1/m, of the skin
    float share = 0;      // of the largest volume that hangs there
    uint32_t picolitres = 0;
};

// A drop that fell off the skin, or ran over an open edge.
struct LeftDrop {
    vec3 position{0.0F}, velocity{0.0F};  // m, m/s, in the skin's frame; the velocity is the world's
    uint32_t picolitres = 0;
    uint32_t triangle = 0;
    std::optional<HangingDrop> hung;  // as it hung before, with what stays on the skin
};

// A flow's memory on its device between two steps, for drawing.
struct FlowView {
    Device* device = nullptr;
    const Buffer *skin, *point, *basis, *film, *painted;  // as in the kernels of shaders/flow
    const Buffer *cellStart, *position, *velocity, *id;   // drops as last sorted: position.w radius, m; velocity.w volume, m^3
    const Buffer* motion;                                 // 3 by id: see flow/law, flow/steer
    StepParams grid{};                                    // the grid's part of it
    uint32_t slots = 0;                                   // of drops
    float largestRadius = 0;                              // m, of a drop's foot; wider ones only where several merged at once
    uint64_t moved = 0;                                   // how often the skin's shape has changed; 0: before the first step
    uint32_t steps = 0;                                   // so far
    bool onLayout = false;                                // thesis mode: drops are sorted by their UV
};

class SurfaceFlow {
  public:
    // `device` must outlive it. Error (badInput): a value out of range, a skin too large for its film or over 1e5 m; (failed): no memory.
    static Result<SurfaceFlow> create(Device& device, FlowMesh mesh, const SurfaceFlowParams& params, std::span<const SkinBrim> brims = {});
    // Thesis mode: the same walk on the layout of `uvs` (3 a triangle), with the forces of the thesis. Drops do not merge and leave no
    // trail. drops() are in space as ever; FlowMaps refuses such a flow, thesisPicture() draws it. Error: as create; (badInput): another
    // number of UVs, or UVs without area.
    static Result<SurfaceFlow> createThesis(Device& device, FlowMesh mesh, std::span<const vec2> uvs, const SurfaceFlowParams& params,
                                            const ThesisParams& thesis);
    SurfaceFlow(SurfaceFlow&&) noexcept;
    SurfaceFlow& operator=(SurfaceFlow&&) noexcept;
    ~SurfaceFlow();

    const FlowMesh& mesh() const;
    const SurfaceFlowParams& params() const;
    // Error (badInput): a value out of its range; nothing changes then.
    Status setParams(const SurfaceFlowParams& params);  // those that are `fixed` stay: tables are sized for them
    Status setThesis(const ThesisParams& params);       // in thesis mode; reach stays

    // Adds a drop, which appears with the next step; without a free slot it is counted as refused.
    // `film`: other drops do not absorb it; it is part of a film as long as there is one.
    void add(const SkinPoint& at, uint32_t picolitres, const vec3& velocity = vec3(0.0F), bool film = false);
    void addToBrim(uint32_t place, uint32_t picolitres);  // places count through all brims in their order
    void setGrip(std::span<const float> grip);            // of each of mesh()'s places: factor of the holding force, 1 by default. Waits
    // Error (badInput): fewer positions than the mesh's, not finite or over 1e5 m from zero, inputs not finite or over 1000; (failed): no
    // memory for the sort. Nothing moves then. If the device was interrupted (Device::stopOn), the drops are valid no more.
    Status step(const SurfaceFlowInputs& inputs, double seconds);

    // Waits for the device.
    std::vector<SkinDrop> drops() const;
    uint64_t refused() const;  // picolitres that found no slot, as last known; does not wait
    // Drop slots that are free for sure, less the drops added since the last step. Does not wait: on a GPU the slots in use are known some
    // steps late, and counted with what may have been spawned since.
    uint32_t room() const;
    // Where mesh()'s places are, m, in the skin's frame; w unused. Exact, but for a skin that deforms on a GPU (SurfaceFlowInputs::moved):
    // there as reported two or three steps ago, moved on with the velocity of then. Off by its acceleration since: 1.7 mm at
    // 1 m/s^2 three steps late. Of such a skin it waits in the two or three steps after the first call, until the first report, and where
    // a GPU is 0.1 s behind. Valid until the next step.
    struct Shape {
        uint64_t number = 0, from = 0;  // other numbers, other places
        std::span<const vec4> places = {};
    };
    Shape shape() const;
    std::vector<LeftDrop> takeLeft();  // since the last call, in the order of ids within each step
    uint64_t leaving() const;          // picolitres that takeLeft() would return; does not wait
    FlowView view() const;
    // Those of a step that is as late as takeLeft()'s: at most MOST_HANGING of them, in no order. Does not wait.
    const std::vector<HangingDrop>& hanging() const;
    const PendantDrop* pendant() const;  // null in thesis mode
    // The film's thickness, m, of every cell of a triangle's lattice; waits.
    std::vector<float> film(uint32_t triangle) const;
    // Picolitres since the start. added = drops + film + left + evaporated + refused.
    struct Ledger {
        uint64_t added = 0, drops = 0, film = 0, left = 0, evaporated = 0, refused = 0;
        uint64_t merges = 0;
        uint64_t handed = 0;  // of left: already returned by takeLeft()
    };
    Ledger ledger() const;  // waits
    // The same without waiting: `then` is called once, on the cpu before this returns, on a GPU in a later step; it may outlive the flow.
    void ledgerLater(std::function<void(const Ledger&)> then) const;
    // Picolitres in each brim, in their order, to `then` as ledgerLater.
    void brimsLater(std::function<void(std::span<const uint64_t>)> then) const;

    // All that the next step depends on, in host memory.
    struct Snapshot;
    std::shared_ptr<const Snapshot> save() const;  // waits
    // Continues from a snapshot of a flow with the same mesh and params, on any device. Error (failed): no memory for the sort.
    Status restore(const Snapshot& snapshot);

  private:
    struct Impl;
    explicit SurfaceFlow(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
