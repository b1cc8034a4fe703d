#include "fluid/session/scene_sources.h"

#include "engine/scene/import_model.h"
#include "engine/scene/transform.h"
#include "fluid/scene/skin_flows.h"

namespace rivulet {

namespace {

// The triangles of a mesh that an emitter or a block names, placed in the world (m): three corners each.
template <class Placed>
Result<std::vector<vec3>> trianglesOf(const Placed& params, const std::string& folder) {
    Result<std::string> path = findAsset(params.mesh, folder);
    if (!path) return path.error();
    Result<Mesh> mesh = importMesh(*path);
    if (!mesh) return mesh.error();
    const mat4 place = params.fitSize > 0 ? Transform::fitted(mesh->bounds(), params.fitSize, params.position, params.rotation)
                                          : Transform{params.position, params.rotation, 1.0F}.matrix();
    const Mesh placed = transformed(*mesh, place);
    std::vector<vec3> corners;
    for (const uint32_t i : placed.indices) corners.push_back(placed.positions[i]);
    return corners;
}

}  // namespace

Status SceneSources::create(const SceneFile& scene) {
    start_ = {.sinks = scene.sinks, .dry = scene.dry, .seconds = static_cast<double>(scene.duration), .least = scene.room};
    start_.expectedDeposit = SkinFlows::expectedDeposit(scene, start_.seconds);
    for (const EmitterParams& params : scene.emitters) {
        Emitter emitter{params, {}};
        if (params.shape == "mesh") {
            Result<std::vector<vec3>> triangles = trianglesOf(params, scene.folder);
            if (!triangles) return triangles.error();
            emitter.triangles = std::move(*triangles);
        }
        start_.emitters.push_back(std::move(emitter));
    }
    start_.blockTriangles.resize(scene.fluid.blocks.size());
    for (size_t k = 0; k < scene.fluid.blocks.size(); ++k) {
        if (scene.fluid.blocks[k].shape != "mesh") continue;
        Result<std::vector<vec3>> triangles = trianglesOf(scene.fluid.blocks[k], scene.folder);
        if (!triangles) return triangles.error();
        start_.blockTriangles[k] = std::move(*triangles);
    }
    if (scene.pour.litres > 0) {
        start_.emitters.push_back({pouring(scene.pour, scene.fluid, std::nullopt), {}});
        start_.more = 1.0e-3 * double{scene.pour.litres};
    }
    return ok();
}

Sources SceneSources::now(const SceneFile& scene) const {
    Sources sources{.sinks = scene.sinks, .dry = scene.dry};
    for (const EmitterParams& params : scene.emitters) sources.emitters.push_back({params, {}});
    if (scene.pour.litres > 0) sources.emitters.push_back({pouring(scene.pour, scene.fluid, target_), {}});
    return sources;
}

bool SceneSources::needsNew(const SceneFile& before, const SceneFile& scene) {
    return scene.emitters.size() != before.emitters.size() || scene.sinks.size() != before.sinks.size() ||
           (scene.pour.litres > 0) != (before.pour.litres > 0);
}

bool SceneSources::pourOnto(const SceneFile& scene, const std::optional<vec3>& place) {
    if (scene.pour.litres <= 0 || place == target_) return false;
    target_ = place;
    return true;
}

}  // namespace rivulet
