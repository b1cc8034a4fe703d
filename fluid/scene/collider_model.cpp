#include "fluid/scene/collider_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>

#include "engine/core/table.h"
#include "engine/scene/transform.h"
#include "fluid/scene/collider_kinds.h"

namespace rivulet {

namespace {

constexpr double kLooksPerSecond = 60;  // of a clip, to see how it moves
constexpr double kMostLooks = 2000;

Material sceneMaterial(const ColliderParams& collider) {
    Material m;
    m.baseColour = collider.colour;
    m.roughness = collider.roughness;
    m.metallic = collider.metallic;
    m.porosity = collider.porosity;
    m.opacity = collider.opacity;
    m.grain = collider.grain;
    m.grainSize = collider.grainSize;
    m.clear = m.blended = collider.opacity < 1;
    return m;
}

// Whether it turns and moves, and does no more: no stretching, no mirroring.
bool turnsOnly(const mat4& m) {
    constexpr float kSame = 1.0e-4F;
    const mat3 turn(m), square = glm::transpose(turn) * turn;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r)
            if (!(std::abs(square[c][r] - (c == r ? 1.0F : 0.0F)) < kSame)) return false;
    return glm::determinant(turn) > 0;
}

bool same(const mat4& a, const mat4& b, float size) {
    constexpr float kSame = 1.0e-4F;
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 3; ++r)
            if (!(std::abs(a[c][r] - b[c][r]) < kSame * (c == 3 ? size : 1.0F))) return false;
    return true;
}

}  // namespace

Result<ColliderModel> ColliderModel::create(const ColliderParams& params, const std::string& folder, Device& device, Scene& nodes) {
    Result<Model> model = kindOf(params).model(params, folder);
    if (!model) return model.error();
    ColliderModel c;
    c.model_ = std::move(*model);
    if (Status chosen = c.choose(params.animation); !chosen) return chosen.error();
    if (Status added = c.addParts(device); !added) return added.error();
    c.stand(0);
    c.atStart_ = c.world_;
    c.fit(params);
    if (c.clip_) c.findMotion();
    // What moves has a frame of its own, whose origin it turns about.
    c.pivot_ = c.rigid_ ? c.pivot_ : params.motion.moves() ? params.position : vec3(0.0F);
    c.place_ = glm::translate(mat4(1.0F), -c.pivot_) * c.start_;
    c.stand(0);
    c.mesh_ = c.merged(c.place_);
    if (params.wave.amplitude > 0) {  // which bends it as one piece
        ModelPart whole;
        whole.name = labelOf(params);
        c.model_ = Model{};
        c.model_.nodes.push_back({labelOf(params), mat4(1.0F), -1});
        c.model_.parts.push_back(std::move(whole));
        c.parts_.assign(1, Part{});
    }
    c.addNodes(labelOf(params), nodes);
    c.dress(params, nodes);
    return c;
}

Status ColliderModel::choose(const ColliderAnimation& animation) {
    animation_ = animation;
    if (!(animation.speed > 0)) return ok();
    if (model_.clips.empty()) return badInput("the file has no animation to play: set animation.speed to 0");
    std::vector<std::string> names;
    for (const Clip& clip : model_.clips) {
        if (!clip_ && (animation.clip.empty() || clip.name == animation.clip)) clip_ = clip;
        names.push_back(clip.name);
    }
    if (clip_) return ok();
    const std::string near = nearestName(animation.clip, names);
    return badInput(fmt::format("the file has no animation `{}`; there {} {}{}", animation.clip, names.size() == 1 ? "is" : "are",
                                fmt::join(names, ", "), near.empty() ? std::string() : fmt::format("; did you mean {}?", near)));
}

Status ColliderModel::addParts(Device& device) {
    for (ModelPart& part : model_.parts) {
        Part made;
        if (!part.grips.empty() || (clip_ && !morphsAt(part, *clip_, 0).empty())) {
            Result<Deformer> deformer = Deformer::create(device, part);
            if (!deformer) return deformer.error();
            made.deformer = std::make_shared<Deformer>(std::move(*deformer));
        }
        made.mesh = std::make_shared<const Mesh>(std::move(part.mesh));
        part.mesh = Mesh{};
        parts_.push_back(std::move(made));
    }
    return ok();
}

void ColliderModel::fit(const ColliderParams& params) {
    start_ = Transform{params.position, params.rotation, params.scale}.matrix();
    if (!(params.fitSize > 0)) return;
    std::vector<vec3> own;
    gather(mat4(1.0F), own);
    Bounds bounds;
    for (const vec3& p : own) bounds.add(p);
    start_ = Transform::fitted(bounds, params.fitSize, params.position, params.rotation);
}

// A file with one part and nothing else is one node, in the world; any other a group with the file's nodes below it.
void ColliderModel::addNodes(const std::string& name, Scene& nodes) {
    Node group;
    group.name = name;
    const bool plain = model_.nodes.size() == 1 && parts_.size() == 1 && !clip_ && !parts_[0].deformer;
    if (plain) group.mesh = parts_[0].mesh = std::make_shared<const Mesh>(mesh_);
    if (rigid_) group.local[3] = vec4(pivot_, 1.0F);
    group_ = static_cast<size_t>(nodes.add(std::move(group)));
    if (plain) {
        parts_[0].node = group_;
        return;
    }
    const std::vector<mat4> local = locals(0);
    for (size_t k = 0; k < model_.nodes.size(); ++k) {
        const ModelNode& from = model_.nodes[k];
        Node node;
        node.name = from.name;
        node.parent = static_cast<int>(from.parent < 0 ? group_ : nodesOf_[static_cast<size_t>(from.parent)]);
        node.local = from.parent < 0 ? place_ * local[k] : local[k];
        nodesOf_.push_back(static_cast<size_t>(nodes.add(std::move(node))));
    }
    for (size_t k = 0; k < parts_.size(); ++k) {
        const size_t at = nodesOf_[static_cast<size_t>(model_.parts[k].node)];
        Node part;
        part.name = model_.parts[k].materialName.empty() ? model_.parts[k].name : model_.parts[k].materialName;
        part.parent = static_cast<int>(at);
        part.mesh = parts_[k].mesh;
        part.deformer = parts_[k].deformer;
        parts_[k].node = static_cast<size_t>(nodes.add(std::move(part)));
    }
}

void ColliderModel::dress(const ColliderParams& params, Scene& nodes) const {
    nodes.nodes()[group_].visible = params.visible;
    for (size_t k = 0; k < parts_.size(); ++k) {
        const bool own = params.materials == "file" && model_.parts[k].hasMaterial;
        nodes.nodes()[parts_[k].node].material = own ? model_.parts[k].material : sceneMaterial(params);
    }
}

bool ColliderModel::dressed() const {
    return std::any_of(model_.parts.begin(), model_.parts.end(), [](const ModelPart& part) { return part.hasMaterial; });
}

double ColliderModel::clipTime(double time) const {
    const double at = time * double{animation_.speed}, seconds = clip_->seconds;
    if (!(seconds > 0)) return 0;
    return animation_.loops ? std::fmod(at, seconds) : std::min(at, seconds);
}

std::vector<mat4> ColliderModel::locals(double time) const {
    if (clip_) return nodesAt(model_, *clip_, clipTime(time));
    std::vector<mat4> own;
    for (const ModelNode& node : model_.nodes) own.push_back(node.local);
    return own;
}

// Nodes and bent parts go where they are at a time.
void ColliderModel::stand(double time) {
    world_ = model_.worldMatrices(locals(time));
    for (size_t k = 0; k < parts_.size(); ++k) {
        if (!parts_[k].deformer) continue;
        const ModelPart& part = model_.parts[k];
        const std::vector<float> weights = clip_ ? morphsAt(part, *clip_, clipTime(time)) : std::vector<float>();
        parts_[k].deformer->run(weights, part.grips.empty() ? std::vector<mat4>() : model_.boneMatrices(part, world_));
    }
}

// All vertices, part after part.
void ColliderModel::gather(const mat4& toWorld, std::vector<vec3>& positions) const {
    positions.clear();
    std::vector<vec4> bent;
    for (size_t k = 0; k < parts_.size(); ++k) {
        const mat4 m = toWorld * world_[static_cast<size_t>(model_.parts[k].node)];
        if (!parts_[k].deformer) {
            for (const vec3& p : parts_[k].mesh->positions) positions.push_back(transformPoint(m, p));
            continue;
        }
        const Deformer& deformer = *parts_[k].deformer;
        bent.resize(deformer.vertices());
        deformer.device().read(deformer.positions(), std::as_writable_bytes(std::span(bent)));
        for (const vec4& p : bent) positions.push_back(transformPoint(m, vec3(p)));
    }
}

Mesh ColliderModel::merged(const mat4& toWorld) const {
    if (parts_.size() == 1 && !parts_[0].deformer)
        return transformed(*parts_[0].mesh, toWorld * world_[static_cast<size_t>(model_.parts[0].node)]);
    Mesh all;
    gather(toWorld, all.positions);
    uint32_t first = 0;
    for (size_t k = 0; k < parts_.size(); ++k) {
        const Mesh& mesh = *parts_[k].mesh;
        const bool mirrored = glm::determinant(mat3(toWorld * world_[static_cast<size_t>(model_.parts[k].node)])) < 0;
        for (size_t t = 0; t + 2 < mesh.indices.size(); t += 3)
            for (const size_t corner : {size_t{0}, size_t{mirrored ? 2U : 1U}, size_t{mirrored ? 1U : 2U}})
                all.indices.push_back(first + mesh.indices[t + corner]);
        first += static_cast<uint32_t>(mesh.positions.size());
    }
    return all;
}

// How the first part has gone since t = 0, in the world.
mat4 ColliderModel::wayTo(double clipTime) const {
    const std::vector<mat4> now = model_.worldMatrices(nodesAt(model_, *clip_, clipTime));
    const auto node = static_cast<size_t>(model_.parts[0].node);
    return start_ * now[node] * glm::inverse(atStart_[node]) * glm::inverse(start_);
}

// Whether the clip moves all parts as one, and if not, how far they go.
void ColliderModel::findMotion() {
    const double seconds = clip_->seconds;
    const auto looks = static_cast<int>(std::clamp(std::ceil(seconds * kLooksPerSecond), 1.0, kMostLooks));
    Bounds bounds;
    std::vector<vec3> positions;
    gather(start_, positions);
    for (const vec3& p : positions) bounds.add(p);
    const float size = glm::length(bounds.size());
    rigid_ = std::none_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.deformer != nullptr; });
    bool moved = false;
    for (int k = 0; k <= looks && rigid_; ++k) {
        const double at = seconds * k / looks;
        const std::vector<mat4> now = model_.worldMatrices(nodesAt(model_, *clip_, at));
        const mat4 way = wayTo(at);
        rigid_ = turnsOnly(way);
        moved = moved || !same(way, mat4(1.0F), size);
        for (const ModelPart& part : model_.parts) {
            const auto node = static_cast<size_t>(part.node);
            rigid_ = rigid_ && same(way, start_ * now[node] * glm::inverse(atStart_[node]) * glm::inverse(start_), size);
        }
    }
    if (rigid_ && !moved) {  // a clip of cameras, or of nodes without parts: it stands as at t = 0
        const std::vector<mat4> local = locals(0);
        for (size_t k = 0; k < local.size(); ++k) model_.nodes[k].local = local[k];
        rigid_ = false;
        clip_.reset();
        return;
    }
    if (rigid_) {  // about a node that the clip turns
        pivot_ = vec3((start_ * atStart_[static_cast<size_t>(clip_->nodes[0].node)])[3]);
        return;
    }
    for (int k = 0; k <= looks; ++k) {
        stand(seconds * k / looks / double{animation_.speed} * (1 - 1.0e-9));
        gather(start_, positions);
        for (const vec3& p : positions) bounds.add(p);
    }
    // Between two looks a part may swing out a little further.
    reach_ = bounds;
    reach_.min -= 0.02F * glm::length(bounds.size());
    reach_.max += 0.02F * glm::length(bounds.size());
}

Pose ColliderModel::pose(double time) const {
    const mat4 way = wayTo(clipTime(time));
    return {vec3(way * vec4(pivot_, 1.0F)), glm::normalize(glm::quat_cast(mat3(way)))};
}

void ColliderModel::shape(double time, std::vector<vec3>& positions) {
    stand(time);
    gather(start_, positions);
    for (vec3& p : positions) p = glm::clamp(p, reach_.min, reach_.max);
}

void ColliderModel::place(double time, Scene& nodes) {
    stand(time);
    const std::vector<mat4> local = locals(time);
    for (size_t k = 0; k < nodesOf_.size(); ++k)
        nodes.nodes()[nodesOf_[k]].local = model_.nodes[k].parent < 0 ? place_ * local[k] : local[k];
}

namespace {

// The one of that name, and the model that has it.
template <class T>
Result<std::pair<const ColliderModel*, const T*>> findNamed(std::span<const ColliderModel> models, std::vector<T> Model::*all,
                                                            const std::string& name, std::string_view what) {
    std::vector<std::string> names;
    for (const ColliderModel& model : models)
        for (const T& one : model.model().*all) {
            if (one.name == name) return std::pair(&model, &one);
            names.push_back(one.name);
        }
    if (names.empty()) return badInput(fmt::format("{}.from is `{}`, but no collider's file has a {}", what, name, what));
    const std::string near = nearestName(name, names);
    return badInput(fmt::format("{}.from is `{}`, which no collider's file has; there {} {}{}", what, name,
                                names.size() == 1 ? "is" : "are", fmt::join(names, ", "),
                                near.empty() ? std::string() : fmt::format("; did you mean {}?", near)));
}

}  // namespace

Status setViewsFromFiles(std::span<const ColliderModel> models, SceneFile& scene) {
    if (!scene.camera.from.empty()) {
        const auto found = findNamed(models, &Model::cameras, scene.camera.from, "camera");
        if (!found) return found.error();
        const ModelCamera& camera = *found->second;
        const mat4 toWorld = found->first->toWorld(camera.node);
        const vec3 eye = transformPoint(toWorld, camera.position), way = glm::normalize(mat3(toWorld) * camera.direction);
        const vec3 middle = 0.5F * (scene.fluid.box.min + scene.fluid.box.max);
        const float away = std::max(glm::dot(middle - eye, way), 0.01F);  // behind it: just ahead
        scene.camera.position = eye;
        scene.camera.target = eye + way * away;
        scene.camera.fieldOfView = std::clamp(camera.fieldOfView, 5.0F, 120.0F);
    }
    if (!scene.light.from.empty()) {
        const auto found = findNamed(models, &Model::lights, scene.light.from, "light");
        if (!found) return found.error();
        const ModelLight& light = *found->second;
        scene.light.direction = -glm::normalize(mat3(found->first->toWorld(light.node)) * light.direction);
        const float most = std::max({light.colour.x, light.colour.y, light.colour.z});
        if (most > 0) scene.light.colour = light.colour / most;
    }
    return ok();
}

}  // namespace rivulet
