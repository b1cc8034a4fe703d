#include "fluid/sim/solids/solid_passes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <tuple>

#include "fluid/sim/solids/probe_passes.h"
#include "fluid/sim/world/state_check.h"
#include "fluid/voxel/packed_array.h"

namespace rivulet {

namespace {

// World -> own frame, as rows.
std::array<vec4, 3> rows(const Pose& p) {
    const mat3 turn = glm::mat3_cast(p.rotation);  // own -> world: its columns are the rows of the way back
    std::array<vec4, 3> r{};
    for (int k = 0; k < 3; ++k) r[static_cast<size_t>(k)] = vec4(turn[k], -glm::dot(turn[k], p.position));
    return r;
}

// The turn from `a` to `b` as an axis times an angle (rad), the short way round.
vec3 turnBetween(const quat& a, const quat& b) {
    quat q = b * glm::conjugate(a);
    if (q.w < 0) q = -q;
    const vec3 axis(q.x, q.y, q.z);
    const float size = glm::length(axis);
    return size > 0 ? axis * (2.0F * std::atan2(size, q.w) / size) : vec3(0.0F);
}

}  // namespace

std::array<uint32_t, 2 * kMostSurfaces> surfaceWords(std::span<const Surface> surfaces, const Surface& otherwise) {
    std::array<uint32_t, 2 * kMostSurfaces> words{};
    for (size_t k = 0; k < kMostSurfaces; ++k) {
        const Surface s = k < surfaces.size() ? surfaces[k] : Surface{};
        const float values[2] = {s.friction >= 0 ? s.friction : otherwise.friction,
                                 s.restitution >= 0 ? s.restitution : otherwise.restitution};
        std::memcpy(&words[2 * k], values, sizeof values);
    }
    return words;
}

namespace {
// A little less than the rest distance, so that rounding removes no particle of a lattice that is flush with a wall.
constexpr float kRounded = 0.998F;

// Whether `p` is in a voxel that the mesh touches, or within rounding of one: a particle that starts there never moves (collide.kernel).
bool inWall(const VoxelGrid& grid, const vec3& p) {
    for (int k = 0; k < 8; ++k) {
        const vec3 away = 0.01F * grid.voxel * (2.0F * vec3(k & 1, (k >> 1) & 1, k >> 2) - 1.0F);
        if (grid.test(grid.cellOf(p + away))) return true;
    }
    return false;
}
}  // namespace

bool SolidPasses::Field::maySpawn(const vec3& p, float spacing, float near) const {
    const float contact = fieldParams(*field, FieldContact{.spacing = spacing}).contact;
    if ((near > 0 && field->clearance(p) < kRounded * near * contact) || field->inside(p)) return false;
    const ivec3 voxel = field->surface.cellOf(p);
    return field->closed || !field->surface.contains(voxel) || outside[field->surface.index(voxel)] != 0;
}

bool SolidPasses::maySpawn(const vec3& p, float spacing, float near) const {
    for (const PlaneSolid& plane : planeSolids_)
        if (glm::dot(glm::normalize(plane.normal), p - plane.position) < kRounded * 0.5F * near * spacing) return false;
    for (size_t k = 0; k < rigid_.size(); ++k)
        if (!rigid_[k].on.maySpawn(poses_[k].toOwn(p), spacing, near)) return false;
    for (const Moving& m : deforming_)
        if (!m.on.maySpawn(p, spacing, near)) return false;
    return static_.field == nullptr || (static_.maySpawn(p, spacing, near) && !inWall(static_.field->surface, p));
}

Status SolidPasses::check(std::span<const Surface> surfaces) {
    if (surfaces.size() > kMostSurfaces)
        return badInput(
            fmt::format("{} kinds of wall are more than the {} there may be: give some colliders the same friction and restitution",
                        surfaces.size(), kMostSurfaces));
    for (size_t k = 0; k < surfaces.size(); ++k) {
        if (!std::isfinite(surfaces[k].friction))
            return badInput(fmt::format("the friction of surface {} is {}, must be 0 or more, or below 0 for fluid.collision's", k,
                                        surfaces[k].friction));
        if (!(surfaces[k].restitution <= 1) || !std::isfinite(surfaces[k].restitution))
            return badInput(fmt::format("the restitution of surface {} is {}, must be between 0 and 1, or below 0 for fluid.collision's", k,
                                        surfaces[k].restitution));
    }
    return ok();
}

bool SolidPasses::insideAdded(const vec3& p, float spacing) const {
    for (const PlaneSolid& plane : planeSolids_)
        if (glm::dot(plane.normal, p - plane.position) < 0) return true;
    for (size_t k = 0; k < rigid_.size(); ++k)
        if (rigid_[k].added && !rigid_[k].on.maySpawn(poses_[k].toOwn(p), spacing, 0)) return true;
    for (const Moving& m : deforming_)
        if (m.added && !m.on.maySpawn(p, spacing, 0)) return true;
    return staticAdded_ && static_.field != nullptr && (!static_.maySpawn(p, spacing, 0) || inWall(static_.field->surface, p));
}

bool SolidPasses::anyAdded() const {
    const auto added = [](const Moving& m) { return m.added; };
    return !planeSolids_.empty() || std::ranges::any_of(rigid_, added) || std::ranges::any_of(deforming_, added) ||
           (staticAdded_ && static_.field != nullptr);
}

std::vector<WetSurface::Part> SolidPasses::wetParts() const {
    Solids solids;
    solids.field = static_.field;
    for (const Moving& m : rigid_) solids.rigid.push_back({m.on.field, {}});
    return WetSurface::partsOf(solids);
}

bool SolidPasses::hasSurfaces(std::span<const Surface> surfaces) const {
    return std::ranges::equal(
        surfaces, surfaces_, [](const Surface& a, const Surface& b) { return a.friction == b.friction && a.restitution == b.restitution; });
}

Status SolidPasses::setSurfaces(std::span<const Surface> surfaces) {
    if (Status sound = check(surfaces); !sound) return sound;
    surfaces_.assign(surfaces.begin(), surfaces.end());
    surfacesChanged_ = true;
    return ok();
}

Status SolidPasses::reset() {
    Places start;
    for (const Moving& m : rigid_) start.poses.push_back(m.atStart);
    for (const Moving& m : deforming_) start.shapes.push_back(m.shapeAtStart);
    return restore(start);
}

Status SolidPasses::restore(const Places& places) {
    if (places.poses.size() != rigid_.size() || places.shapes.size() != deforming_.size())
        return badInput(fmt::format("the state has {} poses and {} shapes, but the scene has {} rigid and {} deforming solids",
                                    places.poses.size(), places.shapes.size(), rigid_.size(), deforming_.size()));
    poses_ = places.poses;
    for (size_t k = 0; k < rigid_.size(); ++k) rigid_[k].from = rigid_[k].target = poses_[k];
    for (size_t k = 0; k < deforming_.size(); ++k)
        if (Status done = settle(deforming_[k], places.shapes[k]); !done) return done;
    fastestWall_ = 0;
    voxelsRewritten_ = places.voxelsRewritten;
    return ok();
}

Status SolidPasses::settle(Moving& m, const std::vector<vec3>& shape) {
    m.shapeFrom = m.shapeTarget = m.shapeNow = shape;
    m.updates = 1;
    // Twice: the second time nothing has moved, and the wall's velocity is nought again.
    for (int twice = 0; twice < 2; ++twice) {
        m.updated = 0;
        if (Status done = deform(m, 1.0, 1.0); !done) return done;
    }
    return ok();
}

uint64_t SolidPasses::voxelsHash() const {
    uint64_t hash = 0;
    const auto add = [&hash](const Field& f) {
        if (f.field == nullptr) return;
        const VoxelGrid& grid = f.field->surface;
        hash = checksum(std::as_bytes(std::span(&grid.size, 1)), hash);
        hash = checksum(std::as_bytes(std::span(&grid.origin, 1)), hash);
        hash = checksum(std::as_bytes(std::span(&grid.voxel, 1)), hash);
        hash = checksum(std::as_bytes(std::span(grid.bits)), hash);
    };
    add(static_);
    for (const Moving& m : rigid_) add(m.on);
    return hash;
}

void SolidPasses::save(WorldState& state) const {
    const uint64_t numbers[] = {voxelsHash(), rigid_.size(), deforming_.size(), voxelsRewritten_};
    state.put<uint64_t>("solids.numbers", numbers);
    state.put<Pose>("solids.poses", poses_);
    for (size_t k = 0; k < deforming_.size(); ++k) state.put<vec3>(fmt::format("solids.shape.{}", k), deforming_[k].shapeNow);
}

Result<SolidPasses::Places> SolidPasses::take(WorldState& state) const {
    Result<std::vector<uint64_t>> numbers = state.take<uint64_t>("solids.numbers", 4);
    if (!numbers) return numbers.error();
    const std::vector<uint64_t>& n = *numbers;
    if (n[1] != rigid_.size() || n[2] != deforming_.size())
        return badInput(fmt::format("the state was saved with {} moving and {} deforming solids, this scene has {} and {}", n[1], n[2],
                                    rigid_.size(), deforming_.size()));
    if (n[3] > uint64_t{1} << 62U) return outOfRange("solids.numbers", 3, static_cast<double>(n[3]), 0, 0x1p62);
    if (n[0] != voxelsHash())
        return badInput("the state was saved among other voxels: a mesh, its place or its resolution is not what it was");
    Result<std::vector<Pose>> poses = state.take<Pose>("solids.poses", rigid_.size());
    if (!poses) return poses.error();
    Places places{std::move(*poses), {}, n[3]};
    for (size_t k = 0; k < places.poses.size(); ++k)
        if (!isSound(places.poses[k]))
            return badInput(
                fmt::format("section solids.poses of the saved state has an invalid pose of moving solid {}: save it again", k));
    for (size_t k = 0; k < deforming_.size(); ++k) {
        const std::string name = fmt::format("solids.shape.{}", k);
        Result<std::vector<vec3>> shape = state.take<vec3>(name, deforming_[k].shapeAtStart.size());
        if (!shape) return shape.error();
        if (Status fits = deforming_[k].shape->checkPlaces(*shape); !fits) return fits.error();
        places.shapes.push_back(std::move(*shape));
    }
    return places;
}

Status SolidPasses::checkFrame(std::span<const Pose> poses, std::span<const std::span<const vec3>> shapes, double seconds) const {
    if (!poses.empty() && poses.size() != rigid_.size())
        return badInput(fmt::format("{} poses were given for {} moving solids: give one for each", poses.size(), rigid_.size()));
    if (!shapes.empty() && shapes.size() != deforming_.size())
        return badInput(fmt::format("{} shapes were given for {} deforming solids: give one for each", shapes.size(), deforming_.size()));
    for (size_t k = 0; k < poses.size(); ++k)
        if (!isSound(poses[k]))
            return badInput(fmt::format("the pose of moving solid {} is not finite, farther than {} m, or its rotation has no unit length",
                                        k, kMostDistance));
    for (size_t k = 0; k < shapes.size(); ++k)
        if (shapes[k].size() != deforming_[k].shapeAtStart.size())
            return badInput(fmt::format("{} vertices were given for deforming solid {}, which has {}", shapes[k].size(), k,
                                        deforming_[k].shapeAtStart.size()));
    for (size_t k = 0; k < shapes.size(); ++k)
        if (Status fits = deforming_[k].shape->checkPlaces(shapes[k]); !fits) return fits;
    for (size_t k = 0; k < poses.size() && seconds > 0; ++k)
        if (const double speed = glm::distance(dvec3(poses[k].position), dvec3(poses_[k].position)) / seconds; speed > double{kMostSpeed})
            return badInput(
                fmt::format("moving solid {} would move at {:.3g} m/s, more than {:.3g}: give it a nearer pose or a longer step", k, speed,
                            kMostSpeed));
    return ok();
}

Status SolidPasses::beginFrame(std::span<const Pose> poses, std::span<const std::span<const vec3>> shapes, double seconds) {
    // Refused or not: nothing moves but to where this frame asks.
    frameSeconds_ = seconds;
    fastestWall_ = 0;
    for (size_t k = 0; k < rigid_.size(); ++k) rigid_[k].from = rigid_[k].target = poses_[k];
    for (Moving& m : deforming_) {
        m.shapeFrom = m.shapeTarget = m.shapeNow;
        m.updates = 1;
        m.updated = 0;
    }
    if (Status asked = checkFrame(poses, shapes, seconds); !asked) return asked;
    for (size_t k = 0; k < rigid_.size(); ++k) {
        Moving& m = rigid_[k];
        if (!poses.empty()) m.target = poses[k];
        const float moved =
            glm::length(m.target.position - m.from.position) + m.radius * glm::length(turnBetween(m.from.rotation, m.target.rotation));
        fastestWall_ = std::max(fastestWall_, static_cast<float>(moved / seconds));
    }
    for (size_t k = 0; k < deforming_.size(); ++k) {
        Moving& m = deforming_[k];
        if (!shapes.empty()) m.shapeTarget.assign(shapes[k].begin(), shapes[k].end());
        float moved2 = 0;
        for (size_t i = 0; i < m.shapeTarget.size(); ++i) {
            const vec3 way = m.shapeTarget[i] - m.shapeFrom[i];
            moved2 = std::max(moved2, glm::dot(way, way));
        }
        const float moved = std::sqrt(moved2);
        fastestWall_ = std::max(fastestWall_, static_cast<float>(moved / seconds));
        // The way of a particle starts where the wall carries it: exact where the wall moves evenly. Some voxels at a time keep it so.
        constexpr float kMostVoxels = 4.0F;
        m.updates = std::max(1, static_cast<int>(std::ceil(std::min(moved / (kMostVoxels * m.on.field->surface.voxel), 64.0F))));
    }
    return ok();
}

Status SolidPasses::deform(Moving& m, double share, double seconds) {
    ++m.updated;
    m.motion.perSecond = seconds > 0 ? static_cast<float>(m.updates / seconds) : 0.0F;
    std::vector<vec3> next(m.shapeNow.size());
    for (size_t i = 0; i < next.size(); ++i) next[i] = glm::mix(m.shapeFrom[i], m.shapeTarget[i], static_cast<float>(share));
    Result<DeformingField::Change> changed = m.shape->update(next);
    if (!changed) return changed.error();
    m.shapeNow = std::move(next);
    voxelsRewritten_ += changed->voxels;
    const VoxelGrid& grid = m.on.field->surface;
    const size_t layer = (static_cast<size_t>(grid.size.x) + 1) * (static_cast<size_t>(grid.size.y) + 1);
    const size_t first = layer * static_cast<size_t>(changed->firstLayer), end = layer * static_cast<size_t>(changed->endLayer);
    if (first >= end) return ok();
    const auto send = [&]<class T>(Buffer& to, std::span<const T> all, size_t from, size_t until) {
        device_->write(to, std::as_bytes(all.subspan(from, until - from)), from * sizeof(T));
    };
    send(m.on.distance, std::span<const float>(m.on.field->distance), first, end);
    send(m.on.normal, std::span<const uint32_t>(m.on.field->normal), first, end);
    send(m.displacement, m.shape->displacement(), first, end);
    // The bits of layers of voxels [firstLayer - 1, endLayer), in whole words.
    const size_t voxels = static_cast<size_t>(grid.size.x) * static_cast<size_t>(grid.size.y);
    const size_t firstBit = voxels * static_cast<size_t>(std::max(changed->firstLayer - 1, 0));
    const size_t endBit = voxels * static_cast<size_t>(std::min(changed->endLayer, grid.size.z));
    send(m.on.bits, std::span<const uint8_t>(grid.bits), firstBit / 32 * 4, std::min(grid.bits.size(), (endBit + 31) / 32 * 4));
    return ok();
}

void SolidPasses::setMotion(MotionParams& m, const Pose& start, const Pose& end, float dt) {
    const std::array<vec4, 3> a = rows(start), b = rows(end);
    m.startX = a[0];
    m.startY = a[1];
    m.startZ = a[2];
    m.endX = b[0];
    m.endY = b[1];
    m.endZ = b[2];
    m.velocity = vec4((end.position - start.position) / dt, 0.0F);
    m.spin = vec4(turnBetween(start.rotation, end.rotation) / dt, 0.0F);
    m.origin = vec4(end.position, 0.0F);
}

void SolidPasses::writePlanes() {
    const auto words = surfaceWords(surfaces_, otherwise_);
    std::vector<vec4> list;
    for (const PlaneSolid& p : planeSolids_) {
        const vec3 n = glm::normalize(p.normal);
        list.emplace_back(n, -glm::dot(n, p.position));
        float values[2];
        std::memcpy(values, &words[2 * p.surface], sizeof values);
        list.emplace_back(values[0], values[1], 0.0F, 0.0F);
    }
    device_->writeAll<vec4>(planes_, list);
    if (static_.field == nullptr || list.empty()) return;
    std::vector<FieldParams> behind(planeSolids_.size());
    for (size_t k = 0; k < behind.size(); ++k) behind[k].origin = list[2 * k];
    device_->write(staticBlock_, std::as_bytes(std::span(behind)), sizeof(FieldParams));
}

Status SolidPasses::advance(const FluidParams& params, const StepParams& step, float gravity, double from, double to) {
    const Surface otherwise{params.collision.friction, params.collision.restitution};
    if (surfacesChanged_ || otherwise.friction != otherwise_.friction || otherwise.restitution != otherwise_.restitution) {
        otherwise_ = otherwise;
        surfacesChanged_ = false;
        const auto words = surfaceWords(surfaces_, otherwise_);
        const auto tell = [&](Field& f) {
            device_->write(f.normal, std::as_bytes(std::span(words)), f.field->normal.size() * sizeof(uint32_t));
        };
        if (static_.field != nullptr) tell(static_);
        for (Moving& m : rigid_) tell(m.on);
        for (Moving& m : deforming_) tell(m.on);
        writePlanes();
    }
    const FieldContact contact{.spacing = params.spacing, .restSpeed = 2.0F * gravity * step.dt, .countIndex = step.cellCount};
    if (static_.field != nullptr) {
        block_ = fieldParams(*static_.field, contact);
        if (blockDt_ != step.dt) device_->write(staticBlock_, std::as_bytes(std::span(&block_, 1)));
        blockDt_ = step.dt;
    }
    Status deformed = ok();
    for (Moving& m : deforming_) {
        m.motion.carried = 0.0F;
        // A substep can take one update: where they are fewer, each goes further, and the wall is in time.
        if (m.updated == 0) m.updates = std::clamp(static_cast<int>(std::lround(1.0 / std::max(to - from, 1.0e-6))), 1, m.updates);
        m.motion.field = fieldParams(*m.on.field, contact);
        if (m.updated < m.updates && from * m.updates >= m.updated - 1.0e-6) {
            m.motion.carried = 1.0F;
            const Status done = deform(m, static_cast<double>(m.updated + 1) / m.updates, frameSeconds_);
            if (!done && done.error().memory) return done;
            if (!done) deformed = done;
        }
        setMotion(m.motion, {}, {}, step.dt);
        device_->write(m.block, std::as_bytes(std::span(&m.motion, 1)));
    }
    for (size_t k = 0; k < rigid_.size(); ++k) {
        Moving& m = rigid_[k];
        const Pose start = poses_[k];
        poses_[k] = between(m.from, m.target, to);
        m.motion.field = fieldParams(*m.on.field, contact);
        setMotion(m.motion, start, poses_[k], step.dt);
        device_->write(m.block, std::as_bytes(std::span(&m.motion, 1)));
    }
    return deformed;
}

std::vector<Bounds> SolidPasses::moved() const {
    std::vector<Bounds> boxes;
    for (const Moving& m : rigid_) {
        if (m.from.position == m.target.position && m.from.rotation == m.target.rotation) continue;
        Bounds box;
        for (const Pose& pose : {m.from, m.target})
            for (const float way : {-m.radius, m.radius}) box.add(pose.position + vec3(way));
        boxes.push_back(box);
    }
    for (const Moving& m : deforming_) {
        if (m.shapeFrom == m.shapeTarget) continue;
        Bounds box;
        for (const std::vector<vec3>* shape : {&m.shapeFrom, &m.shapeTarget})
            for (const vec3& p : *shape) box.add(p);
        boxes.push_back(box);
    }
    return boxes;
}

void SolidPasses::nearWalls(const StepParams& step, const NeighborGrid& grid, const Buffer& position, Buffer& into) {
    if (!walled_) return;
    const uint32_t n = step.awakeSlots;
    const Buffer& start = grid.cellStart();
    if (static_.field != nullptr)
        device_->run(nearWalls_, step, {&start, &position, &planes_, &into, &staticBlock_, &static_.distance}, n);
    else
        device_->run(nearWalls_, step, {&start, &position, &planes_, &into}, n);
    for (std::vector<Moving>* list : {&rigid_, &deforming_})
        for (const Moving& m : *list) device_->run(nearWallsMoving_, step, {&start, &position, &into, &m.block, &m.on.distance}, n);
}

void SolidPasses::followWalls(const StepParams& step, const NeighborGrid& grid, const Buffer& from, const Buffer& to, Buffer& walls) {
    if (walled_) device_->run(followWalls_, step, {&grid.cellStart(), &from, &to, &walls}, step.awakeSlots);
}

void SolidPasses::friction(const StepParams& step, const NeighborGrid& grid, const Buffer& position, Buffer& friction) {
    if (!walled_) return;
    const uint32_t n = step.awakeSlots;
    const Buffer& start = grid.cellStart();
    if (static_.field != nullptr)
        device_->run(friction_, step, {&start, &position, &planes_, &friction, &staticBlock_, &static_.distance}, n);
    else
        device_->run(friction_, step, {&start, &position, &planes_, &friction}, n);
    for (const Moving& m : rigid_) device_->run(frictionMoving_, step, {&start, &position, &friction, &m.block, &m.on.distance}, n);
    for (const Moving& m : deforming_)
        device_->run(frictionDeforming_, step, {&start, &position, &friction, &m.block, &m.on.distance, &m.displacement}, n);
}

void SolidPasses::adhesion(const StepParams& step, const NeighborGrid& grid, Particles& p) {
    if (!walled_) return;
    const Buffer& start = grid.cellStart();
    if (static_.field != nullptr)
        device_->run(adhesion_, step, {&start, &p.position, &planes_, &p.acceleration, &staticBlock_, &static_.distance}, step.awakeSlots);
    else
        device_->run(adhesion_, step, {&start, &p.position, &planes_, &p.acceleration}, step.awakeSlots);
}

std::vector<SolidPasses::FieldView> SolidPasses::movingFields() const {
    std::vector<FieldView> views;
    for (size_t k = 0; k < deforming_.size(); ++k) {
        const Moving& m = deforming_[k];
        views.push_back({ProbeOn::deforming, static_cast<uint32_t>(k), &m.block, &m.on.distance, &m.on.normal, &m.displacement});
    }
    for (size_t k = 0; k < rigid_.size(); ++k) {
        const Moving& m = rigid_[k];
        views.push_back({ProbeOn::rigid, static_cast<uint32_t>(k), &m.block, &m.on.distance, &m.on.normal, nullptr});
    }
    return views;
}

void SolidPasses::collide(const StepParams& step, const NeighborGrid& grid, Particles& particles, ProbePasses* probes) {
    collide(step,
            {&particles.position, &particles.positionNext, &particles.velocityNext, &grid.cellStart(), step.cellCount, step.awakeSlots},
            moving(), std::nullopt, probes);
}

void SolidPasses::keepOut(const StepParams& step, const Movers& movers, double seconds) { collide(step, movers, true, seconds, nullptr); }

void SolidPasses::collide(const StepParams& step, const Movers& m, bool planes, std::optional<double> seconds, ProbePasses* probes) {
    const bool still = seconds && !(*seconds > 0);
    StepParams walls = step;
    walls.cellCount = m.index;
    const auto measured = [&](ProbeOn on, size_t index, const Field& f, const Buffer& block, const auto& dispatch) {
        if (probes != nullptr) probes->remember(on);
        dispatch();
        if (probes != nullptr) probes->contact(step, on, static_cast<uint32_t>(index), f.distance, f.normal, block);
    };
    const auto withinWalls = [&] {
        if (probes != nullptr) probes->arrived(step);
        device_->run(walls_, walls, {m.counts, &planes_, m.to, m.velocity}, m.slots);
    };
    for (size_t k = 0; k < deforming_.size(); ++k) {
        const Moving& solid = deforming_[k];
        MotionParams motion = solid.motion;
        motion.field.countIndex = m.index;
        if (still) motion.carried = 0.0F;
        measured(ProbeOn::deforming, k, solid.on, solid.block, [&] {
            device_->run(collideDeforming_, motion,
                         {m.from, m.to, m.velocity, m.counts, &solid.on.bits, &solid.on.distance, &solid.on.normal, &solid.displacement},
                         m.slots);
        });
    }
    for (size_t k = 0; k < rigid_.size(); ++k) {
        const Moving& solid = rigid_[k];
        MotionParams motion = solid.motion;
        motion.field.countIndex = m.index;
        if (still) {
            motion.startX = motion.endX;
            motion.startY = motion.endY;
            motion.startZ = motion.endZ;
        } else if (seconds) {
            setMotion(motion, solid.from, poses_[k], static_cast<float>(*seconds));
        }
        measured(ProbeOn::rigid, k, solid.on, solid.block, [&] {
            device_->run(collideRigid_, motion, {m.from, m.to, m.velocity, m.counts, &solid.on.bits, &solid.on.distance, &solid.on.normal},
                         m.slots);
        });
    }
    if (planes && walled_) withinWalls();
    // Last: what stands still is never entered, whatever squeezes.
    if (static_.field == nullptr) return;
    FieldParams block = block_;
    block.countIndex = m.index;
    measured(ProbeOn::still, 0, static_, staticBlock_, [&] {
        device_->run(collide_, block, {m.from, m.to, m.velocity, m.counts, &static_.bits, &static_.distance, &static_.normal}, m.slots);
    });
    // The thesis's way back by a voxel asks nothing of the box: a mesh beside a wall would put particles beyond it, and they would be lost.
    if (thesis_) withinWalls();
}

}  // namespace rivulet
