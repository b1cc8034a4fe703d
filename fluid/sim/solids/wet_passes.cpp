#include "fluid/sim/solids/wet_passes.h"

#include <algorithm>
#include <cmath>

#include "fluid/sim/world/state_check.h"
#include "shaders/fluid/solids/wet_params.h"

namespace rivulet {

namespace {

// Spacings: a particle at rest beside a wall is half a spacing from it, and no point between four of them is further than 0.87; where the
// water moves, hardly any is further than 1.
constexpr float kWetsFully = 1.0F, kWetsUntil = 1.4F;
// m/s, on a vertical wall: a film of 0.14 mm (Nusselt 1916: g h^2 / (3 nu)).
constexpr float kRunSpeed = 0.06F;

}  // namespace

Result<WetPasses> WetPasses::create(Device& device, const Solids& solids, float spacing, bool linked) {
    WetPasses w;
    w.device_ = &device;
    w.surface_ = std::make_shared<const WetSurface>(WetSurface::of(solids, spacing));
    Result<Kernel> found = device.kernel("fluid/solids/wet", linked ? std::vector<Define>{{"LINKED_LIST", "1"}} : std::vector<Define>{});
    if (!found) return found.error();
    w.kernel_ = *found;
    if (Status room = w.allocate(); !room) return room.error();
    w.reset();
    return w;
}

Result<WetPasses> WetPasses::with(std::span<const WetSurface::Part> parts, float spacing) const {
    WetPasses w;
    w.device_ = device_;
    w.kernel_ = kernel_;
    w.surface_ = std::make_shared<const WetSurface>(WetSurface::of(parts, spacing, surface_.get()));
    if (Status room = w.allocate(); !room) return room.error();
    w.restore(w.surface_->valuesFrom(*surface_, device_->readAll<float>(values(), surface_->points.size())));
    return w;
}

// A buffer is never empty, so that a picture may bind it.
Status WetPasses::allocate() {
    const size_t points = std::max<size_t>(surface_->points.size(), 1), cells = std::max<size_t>(surface_->cells.size(), 1);
    for (auto [buffer, bytes] : {std::pair(&points_, points * sizeof(WetSurface::Point)), std::pair(&cells_, cells * sizeof(int32_t)),
                                 std::pair(&wet_[0], points * sizeof(float)), std::pair(&wet_[1], points * sizeof(float))}) {
        Result<Buffer> made = device_->allocate(bytes);
        if (!made) return made.error();
        *buffer = std::move(*made);
    }
    if (!surface_->points.empty()) device_->writeAll<WetSurface::Point>(points_, surface_->points);
    if (!surface_->cells.empty()) device_->writeAll<int32_t>(cells_, surface_->cells);
    return ok();
}

void WetPasses::reset() {
    for (Buffer& b : wet_) device_->fill(b, 0);
}

void WetPasses::run(const WetnessParams& params, const StepParams& step, const NeighborGrid& grid, const Particles& particles,
                    std::span<const Pose> rigid, std::span<const BodyState> bodies, const BodyRows& rows, double seconds) {
    const Buffer &before = wet_[now_], &next = wet_[1 - now_];
    const vec3 gravity(step.gravity);
    const float g = glm::length(gravity);
    for (const WetSolid& solid : surface_->solids) {
        const bool onDevice = solid.solid.on == ProbeOn::body && rows.current;
        const Pose pose = onDevice ? Pose{} : solid.poseAmong(rigid, bodies);
        const mat3 turn = glm::mat3_cast(pose.rotation);
        const auto row = [&](int k) { return vec4(turn[0][k], turn[1][k], turn[2][k], pose.position[k]); };
        WetStep w{};
        w.step = step;
        w.toWorldX = row(0);
        w.toWorldY = row(1);
        w.toWorldZ = row(2);
        w.down = vec4(g > 0 ? glm::transpose(turn) * gravity / g : vec3(0.0F), 0.0F);
        w.corner = vec4(solid.corner, 0.0F);
        w.cell = solid.cell;
        w.sizeX = solid.size.x;
        w.sizeY = solid.size.y;
        w.sizeZ = solid.size.z;
        w.firstCell = solid.firstCell;
        w.firstPoint = solid.firstPoint;
        w.points = solid.points;
        w.kept = static_cast<float>(std::exp(-seconds / double{params.dries}));
        w.wetsFully = kWetsFully * step.spacing;
        w.wetsUntil = kWetsUntil * step.spacing;
        w.run = static_cast<float>(1 - std::exp(-double{kRunSpeed} * seconds / double{solid.cell}));
        w.reach = params.runs;
        w.body = onDevice ? solid.solid.index : NO_BODY;
        device_->run(kernel_, w,
                     {&grid.cellStart(), &particles.positionNext, &points_, &cells_, &before, &next, onDevice ? rows.rows : &points_},
                     solid.points);
    }
    now_ = 1 - now_;
}

void WetPasses::save(WorldState& state) const {
    state.put<float>("wetness.points", device_->readAll<float>(values(), surface_->points.size()));
}

Result<std::vector<float>> WetPasses::take(WorldState& state) const {
    Result<std::vector<float>> saved = state.take<float>("wetness.points", surface_->points.size());
    if (!saved) return saved.error();
    if (Status sound = checkRange("wetness.points", *saved, 0, 1); !sound) return sound.error();
    return saved;
}

void WetPasses::restore(std::span<const float> saved) {
    reset();
    if (!saved.empty()) device_->write(wet_[now_], std::as_bytes(saved));
}

}  // namespace rivulet
