#include "fluid/bridge/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "engine/scene/import_assimp.h"
#include "engine/scene/transform.h"
#include "fluid/voxel/voxel_cache.h"

namespace rivulet {

namespace {

float longest(const Bounds& bounds) {
    vec3 size = bounds.size();
    return std::max({size.x, size.y, size.z});
}

}  // namespace

Result<std::unique_ptr<Session>> Session::create(SceneFile scene, Device& device, const Log& log) {
    std::unique_ptr<Session> session(new Session());
    session->scene_ = std::move(scene);
    if (Status imported = session->importColliders(); !imported) return imported.error();
    if (Status baked = session->bake(log); !baked) return baked.error();
    StaticSolids solids;
    if (!session->meshes_.empty()) solids.field = &session->field_;
    for (const ColliderParams& collider : session->scene_.colliders)
        if (collider.shape == "plane") solids.planes.push_back({collider.position, collider.normal});
    auto world = FluidWorld::create(device, session->scene_.fluid, solids, log);
    if (!world) return Error{fmt::format("{}: {}", session->scene_.name, world.error().message), world.error().fault};
    session->world_ = std::move(*world);
    if (session->world_->particles().count == 0)
        log.notice(fmt::format("the scene {} has 0 particles: there is no water to see", session->scene_.name));
    return session;
}

Status Session::importColliders() {
    for (const ColliderParams& collider : scene_.colliders) {
        if (collider.shape != "mesh") continue;
        Result<std::string> path = findAsset(collider.mesh, scene_.folder);
        if (!path) return path.error();
        Result<Mesh> mesh = importMesh(*path);
        if (!mesh) return mesh.error();
        mat4 place = collider.fitSize > 0 ? Transform::fitted(mesh->bounds(), collider.fitSize, collider.position, collider.rotation)
                                          : Transform{collider.position, collider.rotation, collider.scale}.matrix();
        meshes_.push_back(transformed(*mesh, place));
        Node node;
        node.name = collider.mesh;
        node.mesh = std::make_shared<const Mesh>(meshes_.back());
        node.material.baseColour = collider.colour;
        node.material.roughness = collider.roughness;
        node.visible = collider.visible;
        solids_.add(std::move(node));
    }
    return ok();
}

Status Session::bake(const Log& log) {
    if (meshes_.empty()) return ok();
    // Every mesh names the voxels along its own longest side; the one field takes the finest edge that any of them asks for.
    VoxelFieldOptions options;
    Bounds all;
    float edge = std::numeric_limits<float>::max();
    size_t next = 0;
    for (const ColliderParams& collider : scene_.colliders) {
        if (collider.shape != "mesh") continue;
        Bounds bounds = meshes_[next++].bounds();
        if (float side = longest(bounds); side > 0) edge = std::min(edge, side / static_cast<float>(collider.resolution));
        all.add(bounds.min);
        all.add(bounds.max);
    }
    options.resolution = static_cast<int>(std::clamp(std::ceil(longest(all) / edge - 0.001F), 2.0F, 1.0e6F));
    // A particle must find the field before it touches: two spacings hold what a substep can move and the contact distance.
    options.band = 2 * scene_.fluid.spacing;
    options.padding = options.band;
    std::vector<MeshView> views;
    for (const Mesh& mesh : meshes_) views.push_back(mesh.view());
    Result<VoxelField> field = cachedVoxelField(views, options, log);
    if (!field) return field.error();
    field_ = std::move(*field);
    return ok();
}

Bounds Session::bounds() const {
    Bounds all = solids_.bounds();
    all.add(scene_.fluid.box.min);
    all.add(scene_.fluid.box.max);
    return all;
}

void Session::apply(const SceneFile& scene) {
    std::string folder = scene_.folder;
    scene_ = scene;
    scene_.folder = folder;
    world_->setParams(scene_.fluid);
    size_t next = 0;
    for (const ColliderParams& collider : scene_.colliders) {
        if (collider.shape != "mesh" || next >= solids_.nodes().size()) continue;
        Node& node = solids_.nodes()[next++];
        node.material.baseColour = collider.colour;
        node.material.roughness = collider.roughness;
        node.visible = collider.visible;
    }
}

double Session::step(double seconds, bool wait) {
    auto start = std::chrono::steady_clock::now();
    FluidInputs inputs;
    inputs.gravity = scene_.fluid.gravity;
    world_->step(inputs, seconds);
    if (wait) world_->device().finish();
    double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    world_->device().poll();
    return ms;
}

}  // namespace rivulet
