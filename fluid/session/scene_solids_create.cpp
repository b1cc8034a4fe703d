// How the solids of a scene are made: meshes read, voxels baked, bodies placed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/compute/device_cpu.h"
#include "fluid/scene/collider_kinds.h"
#include "fluid/scene/collider_motion.h"
#include "fluid/scene/scene_bodies.h"
#include "fluid/session/scene_solids.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/voxel/voxel_cache.h"

namespace rivulet {

namespace {

float longest(const Bounds& bounds) {
    vec3 size = bounds.size();
    return std::max({size.x, size.y, size.z});
}

// One surface per collider while there are enough, so that each can be edited; otherwise equal colliders share one.
std::vector<Surface> surfacesOf(const SceneFile& scene, std::vector<uint8_t>& surfaceOf) {
    std::vector<Surface> table;
    surfaceOf.clear();
    for (const ColliderParams& collider : scene.colliders) {
        size_t at = table.size();
        if (scene.colliders.size() > kMostSurfaces) {
            const auto same = std::find_if(table.begin(), table.end(), [&](const Surface& s) {
                return s.friction == collider.friction && s.restitution == collider.restitution;
            });
            at = static_cast<size_t>(same - table.begin());
        }
        if (at == table.size()) table.push_back({collider.friction, collider.restitution});
        surfaceOf.push_back(static_cast<uint8_t>(at));
    }
    return table;
}

// The baker's error, with the collider that it concerns.
Error about(const Error& error, size_t collider, const ColliderParams& params) {
    return {fmt::format("colliders[{}] ({}): {}", collider, labelOf(params), error.message), error.fault};
}

// True if the scene sets a material that the file's own hides; the log reports it once.
bool setsMaterial(const ColliderParams& c) {
    const ColliderParams none;
    return c.colour != none.colour || c.roughness != none.roughness || c.metallic != none.metallic || c.opacity != none.opacity ||
           c.grain != none.grain;
}

VoxelFieldOptions fieldOptions(const SceneFile& scene, const Bounds& bounds, float edge) {
    VoxelFieldOptions options;
    options.resolution = static_cast<int>(std::clamp(std::ceil(longest(bounds) / edge - 0.001F), 2.0F, 1.0e6F));
    // A particle must enter the band before it touches: two spacings cover the motion of a substep and the contact distance. Friction and
    // the walls' share of the density act within the support radius.
    options.band = std::max(2.0F, scene.fluid.supportSpacings) * scene.fluid.spacing;
    options.padding = options.band;
    return options;
}

// m: as the collider's resolution demands; without one, a quarter of the spacing, or the finest that fits in memory.
float voxelEdge(const SceneFile& scene, const ColliderParams& collider, const Bounds& bounds, const Log& log) {
    const float side = longest(bounds);
    if (!(side > 0)) return 0.25F * scene.fluid.spacing;
    if (collider.resolution > 0) return side / static_cast<float>(collider.resolution);
    constexpr float kMostVoxels = 2047;  // along a side: what a field takes
    const float wanted = 0.25F * scene.fluid.spacing;
    float edge = std::min(wanted, 0.5F * side);
    const VoxelFieldOptions options = fieldOptions(scene, bounds, edge);
    const auto bytes = [&] {
        const dvec3 voxels = (dvec3(bounds.size()) + 2.0 * std::max(options.band, kBandVoxels * edge)) / static_cast<double>(edge) + 2.0;
        return voxels.x * voxels.y * voxels.z * (sizeof(float) + sizeof(uint32_t) + 0.125);
    };
    while (bytes() > 0.9 * static_cast<double>(options.memoryLimit)) edge *= 1.05F;
    edge = std::max(edge, side / kMostVoxels);
    if (edge > 1.01F * wanted)
        log.notice(
            fmt::format("{} is too large for voxels of a quarter of the spacing: they are {:.3g} m instead of {:.3g} m, and water "
                        "rests {:.3g} m off it; a resolution would say otherwise",
                        labelOf(collider), edge, wanted, std::max(0.5F * scene.fluid.spacing, kContactVoxels * edge)));
    return edge;
}

Result<VoxelField> bakeMeshes(const SceneFile& scene, std::span<const MeshView> views, std::span<const uint8_t> surfaces, float edge,
                              const Log& log) {
    Bounds all;
    for (const MeshView& view : views)
        for (const vec3& p : view.positions) all.add(p);
    VoxelFieldOptions options = fieldOptions(scene, all, edge);
    options.surfaces = surfaces;
    return cachedVoxelField(views, options, log);
}

bool meetsWater(const SceneFile& scene, const ColliderParams& collider) { return scene.fluid.collision.layers.meet(collider.layers); }

}  // namespace

Status SceneSolids::create(SceneFile& scene, const Log& log, OpeningProgress& progress) {
    if (Status imported = importColliders(scene, log, progress); !imported) return imported;
    solids_.surfaces = surfacesOf(scene, surfaceOf_);
    if (Status baked = bake(scene, log, progress); !baked) return baked;
    if (!still_.empty()) solids_.field = &still_;
    std::vector<SolidRef>& refs = solids_.colliders;
    refs.assign(scene.colliders.size(), {});
    for (size_t i = 0; i < scene.colliders.size(); ++i) {
        const ColliderKind& kind = kindOf(scene.colliders[i]);
        if (kind.hasTriangles() || !meetsWater(scene, scene.colliders[i])) continue;
        refs[i] = {ProbeOn::plane, static_cast<uint32_t>(solids_.planes.size())};
        kind.addTo(scene.colliders[i], surfaceOf_[i], solids_);
    }
    for (size_t m = 0; m < models_.size(); ++m)
        if (roleOf(scene, m) == Role::still) refs[colliderOf_[m]] = {ProbeOn::still, surfaceOf_[colliderOf_[m]]};
    for (const Rigid& r : rigid_) {
        refs[colliderOf_[r.model]] = {ProbeOn::rigid, static_cast<uint32_t>(solids_.rigid.size())};
        solids_.rigid.push_back({r.field.get(), poseOf(scene, r.model, 0, 0)});
    }
    for (const Deforming& d : deforming_) {
        refs[colliderOf_[d.model]] = {ProbeOn::deforming, static_cast<uint32_t>(solids_.deforming.size())};
        solids_.deforming.push_back(d.field.get());
    }
    if (scene.bodies.empty()) return ok();
    if (Status on = progress.next("bodies"); !on) return on;
    return addBodies(scene);
}

Status SceneSolids::importColliders(SceneFile& scene, const Log& log, OpeningProgress& progress) {
    for (size_t i = 0; i < scene.colliders.size(); ++i) {
        const ColliderParams& collider = scene.colliders[i];
        if (!kindOf(collider).hasTriangles()) continue;
        if (Status on = progress.next("reading " + labelOf(collider)); !on) return on;
        if (!bender_) bender_ = makeCpuDevice(cpuKernels());
        Result<ColliderModel> model = ColliderModel::create(collider, scene.folder, *bender_, nodes_);
        if (!model) return about(model.error(), i, collider);
        if (model->dressed() && collider.materials == "file" && setsMaterial(collider))
            log.notice(
                fmt::format("colliders[{}] ({}) is drawn with the materials of its file; set materials to scene to use the colour set here",
                            i, labelOf(collider)));
        models_.push_back(std::move(*model));
        colliderOf_.push_back(i);
    }
    return setViewsFromFiles(models_, scene);
}

SceneSolids::Role SceneSolids::roleOf(const SceneFile& scene, size_t model) const {
    const ColliderParams& collider = paramsOf(scene, model);
    if (!collider.solid) return Role::drawn;
    if (!meetsWater(scene, collider)) return Role::dry;
    if (collider.motion.moves() || models_[model].rigid()) return Role::rigid;
    return collider.wave.amplitude > 0 || models_[model].plays() ? Role::deforming : Role::still;
}

Status SceneSolids::bake(const SceneFile& scene, const Log& log, OpeningProgress& progress) {
    // All static meshes become one field, with the finest voxels that any of them demands.
    float edge = std::numeric_limits<float>::max();
    std::vector<MeshView> still;
    std::vector<uint8_t> stillSurfaces;
    size_t one = 0;  // of the static ones
    for (size_t m = 0; m < models_.size(); ++m) {
        const size_t c = colliderOf_[m];
        const ColliderParams& collider = scene.colliders[c];
        if (Status on = progress.next("voxels of " + labelOf(collider)); !on) return on;
        const uint8_t surface = surfaceOf_[c];
        const ColliderModel& model = models_[m];
        const Bounds bounds = model.mesh().bounds();
        const MeshView view = model.mesh().view();
        switch (roleOf(scene, m)) {
            case Role::dry:
                if (collider.wave.amplitude > 0)
                    return badInput(
                        fmt::format("colliders[{}] has a wave, and the water does not meet it: change its layers, or remove the wave", c));
                [[fallthrough]];
            case Role::drawn:
                if (collider.motion.moves() || model.rigid()) shown_.push_back(m);
                break;
            case Role::rigid: {
                const float own = voxelEdge(scene, collider, bounds, log);
                Result<VoxelField> field = bakeMeshes(scene, std::span(&view, 1), std::span(&surface, 1), own, log);
                if (!field) return about(field.error(), c, collider);
                rigid_.push_back({m, std::make_unique<VoxelField>(std::move(*field)), 0.0});
                break;
            }
            case Role::deforming: {
                const Bounds reach = model.plays() ? model.reach() : waveReach(collider.wave, bounds);
                VoxelFieldOptions options = fieldOptions(scene, reach, voxelEdge(scene, collider, reach, log));
                options.surfaces = std::span(&surface, 1);
                Result<DeformingField> field = DeformingField::create(std::span(&view, 1), reach, options);
                if (!field) return about(field.error(), c, collider);
                deforming_.push_back({m, std::make_unique<DeformingField>(std::move(*field)), model.mesh().positions, {}});
                break;
            }
            case Role::still:
                if (longest(bounds) > 0) edge = std::min(edge, voxelEdge(scene, collider, bounds, log));
                still.push_back(view);
                one = c;
                stillSurfaces.push_back(surface);
                break;
        }
    }
    if (Status on = progress.next("voxels of what stands still"); !on) return on;
    if (still.empty()) return ok();
    Result<VoxelField> field = bakeMeshes(scene, still, stillSurfaces, edge, log);
    if (!field) return still.size() == 1 ? about(field.error(), one, scene.colliders[one]) : field.error();
    still_ = std::move(*field);
    return ok();
}

// The index of the body's node; nodes of its parts are below it.
size_t SceneSolids::addBodyNodes(const BodyParams& params, const Pose& pose, Mesh mesh, std::vector<Mesh> parts) {
    Node node;
    node.name = params.mesh.empty() ? params.shape : params.mesh;
    node.local = matrixOf(pose);
    node.mesh = std::make_shared<const Mesh>(std::move(mesh));
    node.material.baseColour = params.colour;
    node.material.roughness = params.roughness;
    node.material.porosity = params.porosity;
    node.visible = params.visible;
    node.body = static_cast<int>(bodyNodes_.size());
    const int main = nodes_.add(std::move(node));
    for (size_t p = 0; p < parts.size(); ++p) {
        Node part;
        part.name = params.parts[p].mesh;
        part.parent = main;
        part.mesh = std::make_shared<const Mesh>(std::move(parts[p]));
        part.material.baseColour = params.parts[p].colour;
        part.material.roughness = params.parts[p].roughness;
        nodes_.add(std::move(part));
    }
    return static_cast<size_t>(main);
}

Status SceneSolids::addBodies(const SceneFile& scene) {
    if (!deforming_.empty())
        return badInput(
            fmt::format("colliders[{}] bends, and bodies would pass through it: give it a motion instead, or leave the bodies out",
                        colliderOf_[deforming_[0].model]));
    Result<std::vector<SceneBody>> made = sceneBodies(scene);
    if (!made) return made.error();
    std::vector<BodyForm> forms;
    for (size_t i = 0; i < made->size(); ++i) {
        SceneBody& b = (*made)[i];
        bodyNodes_.push_back(addBodyNodes(scene.bodies[i], b.body.state.pose, std::move(b.mesh), std::move(b.parts)));
        forms.push_back(std::move(b.form));
        solids_.bodies.push_back(std::move(b.body));
    }
    Solids planes;
    std::vector<LayersParams> planeLayers, stillLayers, movingLayers;
    for (const ColliderParams& collider : scene.colliders) {
        const ColliderKind& kind = kindOf(collider);
        if (kind.hasTriangles()) continue;
        kind.addTo(collider, 0, planes);
        planeLayers.push_back(collider.layers);
    }
    std::vector<MeshView> still, moving;
    std::vector<Pose> poses;
    const auto addMoving = [&](size_t m) {
        moving.push_back(models_[m].mesh().view());
        movingLayers.push_back(paramsOf(scene, m).layers);
        poses.push_back(poseOf(scene, m, 0, 0));
    };
    for (const Rigid& r : rigid_) addMoving(r.model);
    for (size_t m = 0; m < models_.size(); ++m) {
        const Role role = roleOf(scene, m);
        const bool moves = paramsOf(scene, m).motion.moves() || models_[m].rigid();
        if (role != Role::still && role != Role::dry) continue;
        if (role == Role::dry && models_[m].plays() && !models_[m].rigid())
            return badInput(fmt::format(
                "colliders[{}] bends, and bodies would pass through it: set solid to false, or leave the bodies out", colliderOf_[m]));
        if (moves) {
            addMoving(m);
            dry_.push_back(m);
            dryStart_.push_back(poses.back());
        } else {
            still.push_back(models_[m].mesh().view());
            stillLayers.push_back(paramsOf(scene, m).layers);
        }
    }
    contacts_ = std::make_unique<BulletSolids>(BulletSolids::Scene{.box = scene.fluid.box,
                                                                   .planes = planes.planes,
                                                                   .still = still,
                                                                   .moving = moving,
                                                                   .poses = poses,
                                                                   .planeLayers = planeLayers,
                                                                   .stillLayers = stillLayers,
                                                                   .movingLayers = movingLayers},
                                               solids_.bodies, forms);
    solids_.bodyHost = contacts_->host();
    return ok();
}

std::vector<Surface> SceneSolids::surfaces(const SceneFile& scene) {
    std::vector<uint8_t> surfaceOf;
    return surfacesOf(scene, surfaceOf);
}

bool SceneSolids::needsNew(const SceneFile& before, const SceneFile& scene) const {
    if (scene.colliders.size() != before.colliders.size() || scene.bodies.size() != before.bodies.size()) return true;
    for (size_t i = 0; i < scene.colliders.size(); ++i) {
        const ColliderParams &a = before.colliders[i], &b = scene.colliders[i];
        if (a.layers != b.layers) return true;
        if (a.motion.moves() != b.motion.moves() || (a.wave.amplitude > 0) != (b.wave.amplitude > 0)) return true;
    }
    for (size_t i = 0; i < scene.bodies.size(); ++i)
        if (scene.bodies[i].layers != before.bodies[i].layers) return true;
    if (scene.fluid.collision.layers != before.fluid.collision.layers) return true;
    std::vector<uint8_t> surfaceOf;
    (void)surfacesOf(scene, surfaceOf);
    return surfaceOf != surfaceOf_;
}

}  // namespace rivulet
