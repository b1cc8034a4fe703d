// What a ray meets of the solids, what they take up, and what a hand holds.
#include "engine/scene/pick.h"
#include "fluid/session/scene_solids.h"

namespace rivulet {

SceneThing SceneSolids::thingOf(size_t node) const {
    const auto within = [&](size_t group) {
        for (auto n = static_cast<int>(node); n >= 0; n = nodes_.nodes()[static_cast<size_t>(n)].parent)
            if (static_cast<size_t>(n) == group) return true;
        return false;
    };
    for (size_t m = 0; m < models_.size(); ++m)
        if (within(models_[m].node())) return {SceneThing::Kind::collider, colliderOf_[m]};
    for (size_t k = 0; k < bodyNodes_.size(); ++k)
        if (within(bodyNodes_[k])) return {SceneThing::Kind::body, k};
    return {};
}

std::optional<MetThing> SceneSolids::meet(const vec3& origin, const vec3& direction) const {
    const std::optional<Picked> nearest = pick(nodes_, origin, direction);
    if (!nearest) return std::nullopt;
    return MetThing{thingOf(nearest->node), nearest->place, nearest->normal};
}

Bounds SceneSolids::boundsOf(const SceneFile& scene, const SceneThing& thing) const {
    Bounds all;
    if (thing.kind == SceneThing::Kind::emitter && thing.index < scene.emitters.size()) {
        const EmitterParams& e = scene.emitters[thing.index];
        const vec3 half = e.shape == "box" ? 0.5F * e.size : vec3(e.shape == "mesh" ? 0.5F * e.fitSize : e.radius);
        all.add(e.position - half);
        all.add(e.position + half);
    } else if (thing.kind == SceneThing::Kind::sink && thing.index < scene.sinks.size()) {
        const SinkParams& s = scene.sinks[thing.index];
        const vec3 half = s.shape == "box" ? 0.5F * s.size : vec3(s.radius);
        all.add(s.position - half);
        all.add(s.position + half);
    }
    int group = -1;
    for (size_t m = 0; m < models_.size(); ++m)
        if (thing == SceneThing{SceneThing::Kind::collider, colliderOf_[m]}) group = static_cast<int>(models_[m].node());
    if (thing.kind == SceneThing::Kind::body && thing.index < bodyNodes_.size()) group = static_cast<int>(bodyNodes_[thing.index]);
    if (group < 0) return all;
    const std::vector<mat4> world = nodes_.worldMatrices();
    for (size_t n = 0; n < world.size(); ++n) {
        int node = static_cast<int>(n);
        while (node >= 0 && node != group) node = nodes_.nodes()[static_cast<size_t>(node)].parent;
        if (node < 0 || !nodes_.nodes()[n].mesh) continue;
        const Bounds own = nodes_.nodes()[n].mesh->bounds();
        for (int k = 0; k < 8 && !own.empty(); ++k)
            all.add(vec3(world[n] * vec4(k & 1 ? own.max.x : own.min.x, k & 2 ? own.max.y : own.min.y, k & 4 ? own.max.z : own.min.z, 1)));
    }
    return all;
}

void SceneSolids::hold(const std::optional<BodyPull>& hand) {
    if (contacts_) contacts_->hold(hand);
}

}  // namespace rivulet
