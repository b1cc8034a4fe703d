#include "fluid/capi/walls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "fluid/capi/convert.h"
#include "fluid/capi/versioned.h"

namespace rivulet::capi {

Result<Pose> soundPose(const rivulet_pose& given, const std::string& name) {
    Pose pose = poseOf(given);
    if (!isWithin(pose.position, kMostDistance) || !(std::abs(glm::length(pose.rotation) - 1) < 0.01F))
        return badInput(fmt::format("{} is not finite, farther than {} m, or its rotation is not of unit length", name, kMostDistance));
    pose.rotation = glm::normalize(pose.rotation);  // a host's own arithmetic loses precision
    return pose;
}

VoxelFieldOptions voxelOptions(const Bounds& bounds, int resolution, float spacing, size_t memoryLimit) {
    const vec3 size = bounds.size();
    const float side = std::max({size.x, size.y, size.z});
    VoxelFieldOptions options;
    options.resolution = resolution > 0 ? resolution : std::clamp(static_cast<int>(std::ceil(4 * side / spacing)), 2, 512);
    options.band = options.padding = 2 * spacing;  // a particle finds the field before it touches the wall
    if (memoryLimit > 0) options.memoryLimit = memoryLimit;
    return options;
}

Result<LayersParams> layersOf(uint32_t layers, uint32_t meets, const std::string& name) {
    constexpr auto kAll = static_cast<uint32_t>(LayersParams::kAll);
    if (layers > kAll || meets > kAll)
        return badInput(fmt::format("{}: layers is {:#x} and meets {:#x}; there are 16 layers, bits 0 to 15", name, layers, meets));
    LayersParams read;
    if (layers != 0) read.layers = static_cast<int>(layers);
    if (meets != 0) read.meets = static_cast<int>(meets);
    return read;
}

VoxelFieldOptions Walls::optionsFor(std::span<const BakedMesh> meshes, int resolution) const {
    Bounds bounds;
    for (const BakedMesh& mesh : meshes)
        for (const vec3& p : mesh.positions) bounds.add(p);
    return voxelOptions(bounds, resolution, spacing_, memoryLimit_);
}

// `own`: not shared with another wall, so that probes measure each, while there are enough numbers.
std::optional<uint8_t> Walls::surfaceFor(const Surface& surface, bool own) {
    const auto same = std::find_if(surfaces_.begin(), surfaces_.end(), [&](const Surface& s) {
        return s.friction == surface.friction && s.restitution == surface.restitution;
    });
    const auto number = [&](auto at) { return static_cast<uint8_t>(at - surfaces_.begin()); };
    if (!own && same != surfaces_.end()) return number(same);
    // That of a wall which is gone.
    for (auto at = surfaces_.begin(); at != surfaces_.end(); ++at)
        if (std::none_of(all_.begin(), all_.end(), [&](const Wall& w) { return w.surface == number(at); })) {
            *at = surface;
            return number(at);
        }
    if (surfaces_.size() == kMostSurfaces) return same == surfaces_.end() ? std::optional<uint8_t>() : number(same);
    surfaces_.push_back(surface);
    return static_cast<uint8_t>(surfaces_.size() - 1);
}

Result<Walls::Wall> Walls::read(const rivulet_mesh& wall, const std::string& name, bool ownSurface) {
    Result<HostMesh> mesh = meshOf(wall, name);
    if (!mesh) return mesh.error();
    Wall made;
    if (wall.moves > 2) return badInput(fmt::format("{}.moves is {}: use 0, 1 or 2", name, wall.moves));
    made.moves = wall.moves == 1;
    made.deforms = wall.moves == 2;
    const Result<LayersParams> layers = layersOf(wall.layers, wall.meets, name);
    if (!layers) return layers.error();
    made.meets = water_.meet(*layers);
    made.resolution = wall.resolution;
    if (made.moves) {
        const Result<Pose> pose = soundPose(wall.pose, name + ".pose");
        if (!pose) return pose.error();
        made.start = made.now = *pose;
    }
    if (!std::isfinite(wall.friction) || !std::isfinite(wall.restitution) || wall.restitution > 1)
        return badInput(
            fmt::format("{}: friction is {} and restitution {}; give a friction of 0 or more and a restitution of 0 to 1, or "
                        "negative numbers for those of fluid.collision",
                        name, wall.friction, wall.restitution));
    const std::optional<uint8_t> surface = surfaceFor({wall.friction, wall.restitution}, ownSurface);
    if (!surface)
        return badInput(
            fmt::format("walls have more than {} different pairs of friction and restitution: let some share a pair", kMostSurfaces));
    made.surface = *surface;
    made.id = next_++;
    made.mesh = {std::move(mesh->positions), std::move(mesh->indices), *surface};
    return made;
}

// Those that are baked together, and stay.
std::vector<BakedMesh> Walls::standing(int& finest) const {
    std::vector<BakedMesh> meshes;
    for (const Wall& w : all_) {
        if (!w.together || w.leaves) continue;
        meshes.push_back(w.mesh);
        finest = std::max(finest, w.resolution);
    }
    return meshes;
}

Result<std::function<Result<DeformingField>()>> Walls::deformingOf(const Wall& wall, const rivulet_mesh& given) const {
    Bounds reach{vectorOf(given.reach_low), vectorOf(given.reach_high)};
    if (!isSet(given.reach_low) && !isSet(given.reach_high)) {
        reach = {};
        for (const vec3& p : wall.mesh.positions) reach.add(p);
        const vec3 size = reach.size();
        const vec3 more(0.5F * std::max({size.x, size.y, size.z}));
        reach = {reach.min - more, reach.max + more};
    }
    if (!isWithin(reach.min, kMostDistance) || !isWithin(reach.max, kMostDistance) || !glm::all(glm::lessThan(reach.min, reach.max)))
        return badInput(fmt::format("reach_low and reach_high are no box of finite corners, at most {} m from 0", kMostDistance));
    std::vector<BakedMesh> box(1);
    box[0].positions = {reach.min, reach.max};
    return std::function<Result<DeformingField>()>([mesh = wall.mesh, reach, wanted = optionsFor(box, given.resolution)] {
        VoxelFieldOptions options = wanted;
        options.surfaces = std::span(&mesh.surface, 1);
        const MeshView view{.positions = mesh.positions, .indices = mesh.indices, .normals = {}, .uvs = {}};
        return DeformingField::create(std::span(&view, 1), reach, options);
    });
}

bool Walls::takeShape(Wall& wall) {
    Result<DeformingField> field = wall.bakeShape->take();
    wall.bakeShape.reset();
    const auto fails = [&wall](const Error& error) {
        wall.failure = error.message;
        return false;
    };
    if (!field) return fails(field.error());
    // It may have been bent while it was baked.
    if (const Result<DeformingField::Change> bent = field->update(wall.shape); !bent) return fails(bent.error());
    wall.deforming = std::make_unique<DeformingField>(std::move(*field));
    return true;
}

Status Walls::begin(const rivulet_world_options& o, const FluidParams& fluid, size_t memoryLimit, const Jobs& jobs) {
    spacing_ = fluid.spacing;
    water_ = fluid.collision.layers;
    memoryLimit_ = memoryLimit;
    jobs_ = jobs;
    if (o.walls_count > 0 && o.walls == nullptr) return badInput("walls is NULL, and walls_count is not 0");
    const auto bakeNow = [&](std::span<const BakedMesh> meshes, int resolution) -> Result<std::unique_ptr<VoxelField>> {
        std::vector<MeshView> views;
        std::vector<uint8_t> surfaces;
        for (const BakedMesh& mesh : meshes) {
            views.push_back({.positions = mesh.positions, .indices = mesh.indices, .normals = {}, .uvs = {}});
            surfaces.push_back(mesh.surface);
        }
        VoxelFieldOptions options = optionsFor(meshes, resolution);
        options.surfaces = surfaces;
        Result<VoxelField> field = bakeVoxelField(views, options);
        if (!field) return field.error();
        return std::make_unique<VoxelField>(std::move(*field));
    };
    const auto* at = reinterpret_cast<const std::byte*>(o.walls);
    for (size_t k = 0; k < o.walls_count; ++k) {
        const std::string name = fmt::format("walls[{}]", k);
        const Result<rivulet_mesh> input = readStruct(reinterpret_cast<const rivulet_mesh*>(at), "rivulet_mesh", name);
        if (!input) return input.error();
        at += input->size;
        Result<Wall> wall = read(*input, name, o.walls_count <= kMostSurfaces);
        if (!wall) return wall.error();
        wall->together = input->moves == 0 && wall->meets;
        if (wall->deforms) {
            wall->shape = wall->mesh.positions;
            if (wall->meets) {
                const auto bake = deformingOf(*wall, *input);
                if (!bake) return Error{fmt::format("{}: {}", name, bake.error().message), bake.error().fault};
                Result<DeformingField> field = (*bake)();
                if (!field) return Error{fmt::format("{}: {}", name, field.error().message), field.error().fault};
                wall->deforming = std::make_unique<DeformingField>(std::move(*field));
            }
            wall->mesh = {};
        }
        if (wall->moves && wall->meets) {
            auto field = bakeNow(std::span(&wall->mesh, 1), wall->resolution);
            if (!field) return Error{fmt::format("{}: {}", name, field.error().message), field.error().fault};
            wall->field = std::move(*field);
            wall->mesh = {};
        }
        all_.push_back(std::move(*wall));
    }
    int finest = 0;
    const std::vector<BakedMesh> still = standing(finest);
    if (!still.empty()) {
        auto field = bakeNow(still, finest);
        if (!field) return Error{"walls: " + field.error().message, field.error().fault};
        standing_ = std::move(*field);
    }
    for (const Wall& w : all_)
        if (w.acts()) acting_.push_back(w.id);
    return ok();
}

Solids Walls::solids() const {
    Solids solids;
    solids.field = standing_.get();
    solids.surfaces = surfaces_;
    solids.colliders.resize(next_);
    for (const Wall& w : all_) {
        if (w.together && standing_ != nullptr) solids.colliders[w.id] = {ProbeOn::still, w.surface};
        if (w.deforming) {
            solids.colliders[w.id] = {ProbeOn::deforming, static_cast<uint32_t>(solids.deforming.size())};
            solids.deforming.push_back(w.deforming.get());
        }
        if (!w.acts()) continue;
        solids.colliders[w.id] = {ProbeOn::rigid, static_cast<uint32_t>(solids.rigid.size())};
        solids.rigid.push_back({w.field.get(), w.start});
    }
    return solids;
}

Result<uint32_t> Walls::add(const rivulet_mesh& given) {
    const Result<rivulet_mesh> input = readStruct(&given, "rivulet_mesh", "wall");
    if (!input) return input.error();
    Result<Wall> wall = read(*input, "wall", false);
    if (!wall) return wall.error();
    if (!wall->meets) {
        if (wall->deforms) wall->shape = std::move(wall->mesh.positions);
        wall->mesh = {};
        all_.push_back(std::move(*wall));
        return all_.back().id;
    }
    if (wall->deforms) {
        auto bake = deformingOf(*wall, *input);
        if (!bake) return bake.error();
        wall->shape = std::move(wall->mesh.positions);
        wall->mesh = {};
        wall->bakeShape = std::make_unique<Background<DeformingField>>(std::move(*bake), jobs_);
        all_.push_back(std::move(*wall));
        return all_.back().id;
    }
    std::vector<BakedMesh> mesh;
    mesh.push_back(std::move(wall->mesh));
    const VoxelFieldOptions options = optionsFor(mesh, wall->resolution);
    const MeshView view{.positions = mesh[0].positions, .indices = mesh[0].indices, .normals = {}, .uvs = {}};
    if (Status sound = checkVoxelField(std::span(&view, 1), options); !sound) return sound.error();
    wall->bake = std::make_unique<FieldBake>(std::move(mesh), options, jobs_);
    all_.push_back(std::move(*wall));
    return all_.back().id;
}

// The walls as they are now.
Status Walls::apply(FluidWorld& world) {
    const std::vector<Pose>& before = world.poses();
    std::vector<Pose> poses;
    std::vector<uint32_t> acting;
    for (const Wall& w : all_) {
        if (!w.acts()) continue;
        const auto was = std::find(acting_.begin(), acting_.end(), w.id);
        poses.push_back(was == acting_.end() ? w.now : before[static_cast<size_t>(was - acting_.begin())]);
        acting.push_back(w.id);
    }
    if (Status set = world.setWalls(solids(), poses); !set) return set;
    acting_ = std::move(acting);
    return ok();
}

Status Walls::remove(FluidWorld& world, uint32_t id) {
    const auto at = std::find_if(all_.begin(), all_.end(), [id](const Wall& w) { return w.id == id && !w.leaves; });
    if (at == all_.end()) return badInput(fmt::format("there is no wall {}", id));
    if (!at->together) {
        const bool acted = at->acts() || at->deforming != nullptr;
        Wall gone = std::move(*at);  // its field is in use until the world has others
        const auto place = all_.erase(at);
        if (!acted) return ok();
        Status set = apply(world);
        if (!set) all_.insert(place, std::move(gone));
        return set;
    }
    int finest = 0;
    at->leaves = true;
    std::unique_ptr<FieldBake> bake;
    try {
        std::vector<BakedMesh> rest = standing(finest);
        if (!rest.empty()) {
            const VoxelFieldOptions options = optionsFor(rest, finest);
            bake = std::make_unique<FieldBake>(std::move(rest), options, jobs_);
        }
    } catch (...) {
        at->leaves = false;
        throw;
    }
    if (bake != nullptr) {
        standingBake_ = std::move(bake);
        return ok();
    }
    std::unique_ptr<VoxelField> before = std::move(standing_);
    if (Status set = apply(world); !set) {
        standing_ = std::move(before);
        at->leaves = false;
        return set;
    }
    standingBake_.reset();
    std::erase_if(all_, [](const Wall& w) { return w.leaves; });
    return ok();
}

std::vector<std::string> Walls::arrive(FluidWorld& world) {
    std::vector<std::string> wrong;
    bool changed = false;
    const auto stay = [this] {
        for (Wall& w : all_) w.leaves = false;
    };
    for (Wall& w : all_) {
        if (w.bakeShape != nullptr && w.bakeShape->done()) {
            if (takeShape(w))
                changed = w.arrives = true;
            else
                wrong.push_back(fmt::format("wall {}: {}", w.id, w.failure));
        }
        if (w.bake == nullptr || !w.bake->done()) continue;
        Result<VoxelField> field = w.bake->take();
        w.bake.reset();
        if (field) {
            w.field = std::make_unique<VoxelField>(std::move(*field));
            changed = true;
        } else {
            w.failure = field.error().message;
            wrong.push_back(fmt::format("wall {}: {}", w.id, w.failure));
        }
    }
    std::unique_ptr<VoxelField> before;
    if (standingBake_ != nullptr && standingBake_->done()) {
        Result<VoxelField> field = standingBake_->take();
        standingBake_.reset();
        if (field) {
            before = std::exchange(standing_, std::make_unique<VoxelField>(std::move(*field)));
            changed = true;
        } else {
            wrong.push_back("the walls that stand still: " + field.error().message);
            stay();
        }
    }
    if (!changed) return wrong;
    if (Status set = apply(world); !set) {
        // As before: the world still has the old fields.
        wrong.push_back(set.error().message);
        if (before) standing_ = std::move(before);
        stay();
        for (Wall& w : all_)
            if (w.acts() && std::find(acting_.begin(), acting_.end(), w.id) == acting_.end()) {
                w.failure = set.error().message;
                w.field.reset();
            }
        for (Wall& w : all_)
            if (std::exchange(w.arrives, false)) {
                w.failure = set.error().message;
                w.deforming.reset();
            }
        return wrong;
    }
    for (Wall& w : all_) w.arrives = false;
    if (before) std::erase_if(all_, [](const Wall& w) { return w.leaves; });
    return wrong;
}

const Walls::Wall* Walls::find(uint32_t id) const {
    const auto at = std::find_if(all_.begin(), all_.end(), [id](const Wall& w) { return w.id == id; });
    return at == all_.end() ? nullptr : &*at;
}

Result<rivulet_wall_state> Walls::stateOf(uint32_t id) const {
    const Wall* w = find(id);
    if (w == nullptr) return badInput(fmt::format("there is no wall {}", id));
    if (!w->failure.empty()) return failed(fmt::format("wall {}: {}", id, w->failure));
    if (w->leaves) return RIVULET_WALL_LEAVES;
    return w->bakes() ? RIVULET_WALL_BAKES : RIVULET_WALL_ACTS;
}

size_t Walls::moving() const {
    return static_cast<size_t>(std::count_if(all_.begin(), all_.end(), [](const Wall& w) { return w.moves; }));
}

void Walls::move(std::span<const Pose> poses) {
    size_t k = 0;
    for (Wall& w : all_)
        if (w.moves) w.now = poses[k++];
}

Walls::Targets Walls::targets() const {
    Targets targets;
    for (const Wall& w : all_) {
        if (w.acts()) targets.poses.push_back(w.now);
        if (w.moves) targets.moving.push_back(w.now);
        if (w.deforming) targets.shapes.push_back(w.shape);
        if (w.deforms) targets.deforming.push_back(w.shape);
    }
    return targets;
}

std::vector<std::pair<size_t, Pose>> Walls::placesOfMoving(const FluidWorld& world) const {
    std::vector<std::pair<size_t, Pose>> places;
    size_t rigid = 0, moving = 0;
    for (const Wall& w : all_) {
        if (w.acts() && std::find(acting_.begin(), acting_.end(), w.id) != acting_.end()) {
            const Pose& pose = world.poses()[rigid++];
            if (w.moves) places.emplace_back(moving, pose);
        }
        moving += w.moves ? 1 : 0;
    }
    return places;
}

size_t Walls::deforming() const {
    return static_cast<size_t>(std::count_if(all_.begin(), all_.end(), [](const Wall& w) { return w.deforms; }));
}

void Walls::deform(size_t which, const float* positions) {
    for (Wall& w : all_) {
        if (!w.deforms || which-- > 0) continue;
        for (size_t k = 0; k < w.shape.size(); ++k) w.shape[k] = vectorOf(positions + 3 * k);
        return;
    }
}

void Walls::moveBack(const Targets& before) {
    move(before.moving);
    size_t k = 0;
    for (Wall& w : all_)
        if (w.deforms) w.shape = before.deforming[k++];
}

void Walls::follow(const std::vector<Pose>& poses) {
    size_t k = 0;
    for (Wall& w : all_)
        if (w.acts()) w.now = poses[k++];
    for (Wall& w : all_)
        if (w.deforming) w.shape.assign(w.deforming->positions().begin(), w.deforming->positions().end());
}

}  // namespace rivulet::capi
