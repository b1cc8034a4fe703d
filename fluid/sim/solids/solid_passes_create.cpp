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
    s.planeSolids_ = solids.planes;
    for (const PlaneSolid& p : s.planeSolids_) {
        if (!isFinite(p.position) || !isFinite(p.normal)) return badInput("a plane's place or normal is not finite");
        if (!(glm::length(p.normal) > 0.0F)) return badInput("a plane's normal is zero: give it a direction");
        if (p.surface >= kMostSurfaces) return badInput(fmt::format("a plane's surface is {}, must be below {}", p.surface, kMostSurfaces));
    }
    if (Status sound = check(solids.surfaces); !sound) return sound.error();
    s.surfaces_ = solids.surfaces;
    Result<Buffer> planes = device.allocate(std::max<size_t>(s.planeSolids_.size(), 1) * 2 * sizeof(vec4));
    if (!planes) return planes.error();
    s.planes_ = std::move(*planes);

    if (solids.field != nullptr && !solids.field->empty()) {
        if (Status wide = reaches(*solids.field, params.spacing); !wide) return wide.error();
        s.static_.field = solids.field;
        if (Status done = s.static_.upload(device); !done) return done.error();
        Result<Buffer> block = device.allocate(sizeof(FieldParams));
        if (!block) return block.error();
        s.staticBlock_ = std::move(*block);
    }
    for (const RigidSolid& rigid : solids.rigid) {
        if (!isSound(rigid.pose))
            return badInput(fmt::format("the pose of moving solid {} is not finite, farther than {} m, or its rotation has no unit length",
                                        s.rigid_.size(), kMostDistance));
        if (rigid.field != nullptr)
            if (Status wide = reaches(*rigid.field, params.spacing); !wide) return wide.error();
        Moving m;
        m.on.field = rigid.field;
        m.atStart = rigid.pose;
        if (Status done = s.addMoving(std::move(m)); !done) return done.error();
    }
    for (DeformingField* shape : solids.deforming) {
        if (shape == nullptr) return badInput("a deforming solid has no field: bake its mesh first");
        if (Status wide = reaches(shape->field(), params.spacing); !wide) return wide.error();
        Moving m;
        m.shape = shape;
        m.on.field = &shape->field();
        m.shapeAtStart.assign(shape->positions().begin(), shape->positions().end());
        if (Status done = s.addMoving(std::move(m)); !done) return done.error();
    }
    struct Wanted {
        Kernel* kernel;
        const char* path;
        std::vector<Define> defines;
        bool wanted;
    };
    s.walled_ = !glm::all(params.box.periodic()) || s.any();
    s.thesis_ = params.collision.walk == "thesis";
    const bool thesis = s.thesis_, still = s.static_.field != nullptr;
    const auto collide = [&](const char* motion) {
        std::vector<Define> d(threads.begin(), threads.end());
        if (*motion != 0) d.push_back({motion, "1"});
        if (std::string_view(motion) == "DEFORMING") d.push_back({"MOVING", "1"});
        if (thesis) d.push_back({"THESIS", "1"});
        return d;
    };
    for (const Wanted& w :
         {Wanted{&s.nearWalls_, "fluid/solids/near_walls", still ? std::vector<Define>{{"FIELD", "1"}} : std::vector<Define>{}, s.walled_},
          Wanted{&s.followWalls_, "fluid/solids/follow_walls", {}, s.walled_},
          Wanted{&s.friction_, "fluid/forces/wall_friction", still ? std::vector<Define>{{"FIELD", "1"}} : std::vector<Define>{},
                 s.walled_},
          Wanted{&s.adhesion_, "fluid/forces/wall_adhesion", still ? std::vector<Define>{{"FIELD", "1"}} : std::vector<Define>{},
                 s.walled_},
          Wanted{&s.frictionMoving_, "fluid/forces/wall_friction_moving", {}, !s.rigid_.empty()},
          Wanted{&s.frictionDeforming_, "fluid/forces/wall_friction_moving", {{"DEFORMING", "1"}}, !s.deforming_.empty()},
          Wanted{&s.walls_, "fluid/solids/walls", {threads.begin(), threads.end()}, s.walled_},
          Wanted{&s.nearWallsMoving_, "fluid/solids/near_walls_moving", {}, !s.rigid_.empty() || !s.deforming_.empty()},
          Wanted{&s.collide_, "fluid/solids/collide", collide(""), still},
          Wanted{&s.collideRigid_, "fluid/solids/collide", collide("MOVING"), !s.rigid_.empty()},
          Wanted{&s.collideDeforming_, "fluid/solids/collide", collide("DEFORMING"), !s.deforming_.empty()}}) {
        if (!w.wanted) continue;
        Result<Kernel> found = device.kernel(w.path, w.defines);
        if (!found) return found.error();
        *w.kernel = *found;
    }
    if (Status done = s.reset(); !done) return done.error();
    return s;
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
