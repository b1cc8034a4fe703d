// How the solids of a world come to its Device.
#include <fmt/format.h>

#include <algorithm>

#include "fluid/sim/solids/solid_passes.h"
#include "fluid/voxel/labels.h"

namespace rivulet {

namespace {

template <class T>
Status hold(Device& device, Buffer& buffer, std::span<const T> items, size_t extra = 0) {
    Result<Buffer> made = device.allocate(items.size_bytes() + extra);
    if (!made) return made.error();
    buffer = std::move(*made);
    device.write(buffer, std::as_bytes(items));
    return ok();
}

// Kernels that use the field need its parameters first: fieldParams.
Status reaches(const VoxelField& field, float spacing) {
    if (0.5F * spacing < field.band) return ok();
    return badInput(
        fmt::format("a solid's voxel field has a band of {:.3g} m, which must be wider than half a spacing of {:.3g} m: bake it with a "
                    "band of at least "
                    "{:.3g} m",
                    field.band, spacing, 2 * spacing));
}

}  // namespace

Status SolidPasses::Field::upload(Device& device) {
    // Where a mesh is not closed no side of it is known to be inside: what cannot be reached from the border counts as that.
    if (!field->closed) outside = reachableFromBorder(field->surface);
    if (Status s = hold<uint8_t>(device, bits, field->surface.bits); !s) return s;
    if (Status s = hold<float>(device, distance, field->distance); !s) return s;
    return hold<uint32_t>(device, normal, field->normal, 2 * kMostSurfaces * sizeof(uint32_t));
}

Result<SolidPasses> SolidPasses::create(Device& device, const Solids& solids, const FluidParams& params, std::span<const Define> threads) {
    SolidPasses s;
    s.device_ = &device;
    std::vector<Pose> starts;
    starts.reserve(solids.rigid.size());
    for (const RigidSolid& rigid : solids.rigid) starts.push_back(rigid.pose);
    if (Status done = s.replace(solids, starts, params, threads); !done) return done.error();
    return s;
}

// The first of `all` with this field, whose place in `taken` is still free. Null: none.
SolidPasses::Moving* SolidPasses::keep(std::vector<Moving>& all, const VoxelField* field, std::vector<const Moving*>& taken) {
    for (Moving& m : all)
        if (m.on.field == field && field != nullptr && std::find(taken.begin(), taken.end(), &m) == taken.end()) {
            taken.push_back(&m);
            return &m;
        }
    return nullptr;
}

Status SolidPasses::replace(const Solids& solids, std::span<const Pose> poses, const FluidParams& params, std::span<const Define> threads) {
    SolidPasses next;  // all that may fail comes before anything changes
    next.device_ = device_;
    next.planeSolids_ = solids.planes;
    for (const PlaneSolid& p : next.planeSolids_) {
        if (!isFinite(p.position) || !isFinite(p.normal)) return badInput("a plane's place or normal is not finite");
        if (!(glm::length(p.normal) > 0.0F)) return badInput("a plane's normal is zero: give it a direction");
        if (p.surface >= kMostSurfaces) return badInput(fmt::format("a plane's surface is {}, must be below {}", p.surface, kMostSurfaces));
    }
    if (Status sound = check(solids.surfaces); !sound) return sound;
    next.surfaces_ = solids.surfaces;
    if (poses.size() != solids.rigid.size())
        return badInput(fmt::format("{} poses were given for {} moving solids: give one for each", poses.size(), solids.rigid.size()));
    Result<Buffer> planes = device_->allocate(std::max<size_t>(next.planeSolids_.size(), 1) * 2 * sizeof(vec4));
    if (!planes) return planes.error();
    next.planes_ = std::move(*planes);

    const bool still = solids.field != nullptr && !solids.field->empty(), keepsStill = still && static_.field == solids.field;
    if (still) {
        if (Status wide = reaches(*solids.field, params.spacing); !wide) return wide;
        next.static_.field = solids.field;
        if (!keepsStill)
            if (Status done = next.static_.upload(*device_); !done) return done;
        Result<Buffer> block = device_->allocate((1 + next.planeSolids_.size()) * sizeof(FieldParams));
        if (!block) return block.error();
        next.staticBlock_ = std::move(*block);
    }
    std::vector<Moving*> rigid, deforming;  // those that stay; null: new
    std::vector<const Moving*> taken;
    for (size_t k = 0; k < solids.rigid.size(); ++k) {
        const RigidSolid& one = solids.rigid[k];
        if (!isSound(one.pose) || !isSound(poses[k]))
            return badInput(fmt::format("the pose of moving solid {} is not finite, farther than {} m, or its rotation has no unit length",
                                        k, kMostDistance));
        if (one.field != nullptr)
            if (Status wide = reaches(*one.field, params.spacing); !wide) return wide;
        Moving m;
        m.on.field = one.field;
        m.atStart = one.pose;
        m.from = m.target = poses[k];
        rigid.push_back(keep(rigid_, one.field, taken));
        if (rigid.back() != nullptr)
            next.rigid_.push_back(std::move(m));
        else if (Status done = next.addMoving(std::move(m)); !done)
            return done;
    }
    next.poses_.assign(poses.begin(), poses.end());
    for (DeformingField* shape : solids.deforming) {
        if (shape == nullptr) return badInput("a deforming solid has no field: bake its mesh first");
        if (Status wide = reaches(shape->field(), params.spacing); !wide) return wide;
        Moving m;
        m.shape = shape;
        m.on.field = &shape->field();
        m.shapeAtStart.assign(shape->positions().begin(), shape->positions().end());
        deforming.push_back(keep(deforming_, m.on.field, taken));
        if (deforming.back() != nullptr) {
            next.deforming_.push_back(std::move(m));
            continue;
        }
        if (Status done = next.addMoving(std::move(m)); !done) return done;
        Moving& made = next.deforming_.back();
        if (Status done = next.settle(made, made.shapeAtStart); !done) return done;
    }
    next.walled_ = !glm::all(params.box.periodic()) || next.any();
    next.thesis_ = params.collision.walk == "thesis";
    const bool thesis = next.thesis_;
    struct Wanted {
        Kernel* kernel;
        const char* path;
        std::vector<Define> defines;
        bool wanted;
    };
    const auto collide = [&](const char* motion) {
        std::vector<Define> d(threads.begin(), threads.end());
        if (*motion != 0) d.push_back({motion, "1"});
        if (std::string_view(motion) == "DEFORMING") d.push_back({"MOVING", "1"});
        if (thesis) d.push_back({"THESIS", "1"});
        return d;
    };
    for (const Wanted& w :
         {Wanted{&next.nearWalls_, "fluid/solids/near_walls", still ? std::vector<Define>{{"FIELD", "1"}} : std::vector<Define>{},
                 next.walled_},
          Wanted{&next.followWalls_, "fluid/solids/follow_walls", {}, next.walled_},
          Wanted{&next.friction_, "fluid/forces/wall_friction", still ? std::vector<Define>{{"FIELD", "1"}} : std::vector<Define>{},
                 next.walled_},
          Wanted{&next.adhesion_, "fluid/forces/wall_adhesion", still ? std::vector<Define>{{"FIELD", "1"}} : std::vector<Define>{},
                 next.walled_},
          Wanted{&next.frictionMoving_, "fluid/forces/wall_friction_moving", {}, !next.rigid_.empty()},
          Wanted{&next.frictionDeforming_, "fluid/forces/wall_friction_moving", {{"DEFORMING", "1"}}, !next.deforming_.empty()},
          Wanted{&next.walls_, "fluid/solids/walls", {threads.begin(), threads.end()}, next.walled_},
          Wanted{&next.nearWallsMoving_, "fluid/solids/near_walls_moving", {}, !next.rigid_.empty() || !next.deforming_.empty()},
          Wanted{&next.collide_, "fluid/solids/collide", collide(""), still},
          Wanted{&next.collideRigid_, "fluid/solids/collide", collide("MOVING"), !next.rigid_.empty()},
          Wanted{&next.collideDeforming_, "fluid/solids/collide", collide("DEFORMING"), !next.deforming_.empty()}}) {
        if (!w.wanted) continue;
        Result<Kernel> found = device_->kernel(w.path, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    next.staticAdded_ = still && !keepsStill;
    if (keepsStill) next.static_ = std::move(static_);
    for (size_t k = 0; k < rigid.size(); ++k) {
        if (rigid[k] == nullptr) continue;
        const Pose start = next.rigid_[k].atStart;
        next.rigid_[k] = std::move(*rigid[k]);
        next.rigid_[k].atStart = start;
        next.rigid_[k].added = false;
        next.rigid_[k].from = next.rigid_[k].target = poses[k];
    }
    for (size_t k = 0; k < deforming.size(); ++k)
        if (deforming[k] != nullptr) {
            next.deforming_[k] = std::move(*deforming[k]);
            next.deforming_[k].added = false;
        }
    next.voxelsRewritten_ = voxelsRewritten_;
    next.otherwise_ = otherwise_;
    const bool first = !planes_;
    *this = std::move(next);
    if (!first) writePlanes();  // a method may move particles before the next advance()
    return ok();
}

Status SolidPasses::addMoving(Moving m) {
    if (m.on.field == nullptr || m.on.field->empty()) return badInput("a moving solid has no voxels: bake its mesh first");
    if (Status done = m.on.upload(*device_); !done) return done;
    Result<Buffer> block = device_->allocate(sizeof(MotionParams));
    if (!block) return block.error();
    m.block = std::move(*block);
    const VoxelGrid& grid = m.on.field->surface;
    for (int k = 0; k < 8; ++k) {
        const vec3 corner = grid.origin + grid.voxel * vec3(grid.size) * vec3(k & 1, (k >> 1) & 1, k >> 2);
        m.radius = std::max(m.radius, glm::length(corner));
    }
    if (m.shape != nullptr) {
        Result<Buffer> displacement = device_->allocate(m.on.field->distance.size() * sizeof(vec4));
        if (!displacement) return displacement.error();
        m.displacement = std::move(*displacement);
    }
    (m.shape != nullptr ? deforming_ : rigid_).push_back(std::move(m));
    return ok();
}

}  // namespace rivulet
