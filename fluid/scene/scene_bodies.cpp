#include "fluid/scene/scene_bodies.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "engine/scene/import_model.h"
#include "engine/scene/transform.h"
#include "fluid/sim/solids/body_shapes.h"

namespace rivulet {

namespace {

Mesh boxMesh(const vec3& size) {
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0F, 1.0F}) {
            vec3 n(0.0F), u(0.0F);
            n[axis] = side;
            u[(axis + 1) % 3] = 1;
            const vec3 v = glm::cross(n, u);
            const auto first = static_cast<uint32_t>(mesh.positions.size());
            for (const vec2 c : {vec2(-1, -1), vec2(1, -1), vec2(1, 1), vec2(-1, 1)}) {
                mesh.positions.push_back(0.5F * size * (n + u * c.x + v * c.y));
                mesh.normals.push_back(n);
            }
            for (const uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) mesh.indices.push_back(first + k);
        }
    return mesh;
}

Mesh sphereMesh(float radius) {
    constexpr int kRings = 20, kSides = 32;
    Mesh mesh;
    for (int r = 0; r <= kRings; ++r)
        for (int s = 0; s <= kSides; ++s) {
            const float theta = kPi * static_cast<float>(r) / kRings, phi = 2 * kPi * static_cast<float>(s) / kSides;
            const vec3 n(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
            mesh.positions.push_back(radius * n);
            mesh.normals.push_back(n);
        }
    for (uint32_t r = 0; r < kRings; ++r)
        for (uint32_t s = 0; s < kSides; ++s) {
            const uint32_t a = r * (kSides + 1) + s, b = a + kSides + 1;
            for (const uint32_t k : {a, b, a + 1, a + 1, b, b + 1}) mesh.indices.push_back(k);
        }
    return mesh;
}

void toOwn(Mesh& mesh, const Pose& pose) {
    for (vec3& p : mesh.positions) p = pose.toOwn(p);
    for (vec3& n : mesh.normals) n = glm::conjugate(pose.rotation) * n;
}

// Moves the centre of mass, and with it the own frame's origin, by `way` (m, own frame). The inertia about it is taken to stay.
void weighDown(SceneBody& b, const vec3& way) {
    for (vec3& p : b.body.shape.samples) p -= way;
    b.body.shape.distance = [before = b.body.shape.distance, way](const vec3& p) { return before(p + way); };
    for (vec3& p : b.mesh.positions) p -= way;
    for (Mesh& part : b.parts)
        for (vec3& p : part.positions) p -= way;
    for (vec3& p : b.form.points) p -= way;
    for (auto& [centre, size] : b.form.cells) centre -= way;
    b.form.centre -= way;
}

// Mesh files, each of which is read once: ten ducks are one file.
class MeshFiles {
  public:
    explicit MeshFiles(const std::string& folder) : folder_(folder) {}
    Result<const Mesh*> find(const std::string& name) {
        Result<std::string> path = findAsset(name, folder_);
        if (!path) return path.error();
        if (const auto found = read_.find(*path); found != read_.end()) return &found->second;
        Result<Mesh> mesh = importMesh(*path);
        if (!mesh) return mesh.error();
        return &read_.emplace(std::move(*path), std::move(*mesh)).first->second;
    }

  private:
    std::string folder_;
    std::map<std::string, Mesh> read_;
};

Result<SceneBody> bodyOf(const BodyParams& params, MeshFiles& files, float spacing) {
    SceneBody made;
    BodyState& state = made.body.state;
    BodyShape& shape = made.body.shape;
    const double density = params.density;
    const Transform placed{params.position, params.rotation, 1.0F};
    if (params.shape == "box" || params.shape == "sphere") {
        const bool box = params.shape == "box";
        // As many as a mesh may have (body_shapes.cpp): more would take all the memory there is.
        constexpr double kMostSamples = 1.0e6;
        const dvec3 along = dvec3(params.size) / double{spacing} + 1.0;
        const double round = double{params.radius} / double{spacing};
        const double samples = box ? 2 * (along.x * along.y + along.y * along.z + along.z * along.x) : 4 * double{kPi} * round * round;
        if (samples > kMostSamples)
            return badInput(
                fmt::format("its surface would need {:.3g} samples at a spacing of {} m, there may be {:.0f}: make it smaller, or "
                            "fluid.spacing larger",
                            samples, spacing, kMostSamples));
        shape = box ? boxShape(params.size, density, spacing) : sphereShape(params.radius, density, spacing);
        made.form.kind = box ? BodyForm::Kind::box : BodyForm::Kind::sphere;
        made.form.size = params.size;
        made.form.radius = params.radius;
        made.mesh = box ? boxMesh(params.size) : sphereMesh(params.radius);
        state.pose.position = params.position;
        state.pose.rotation = glm::normalize(glm::quat_cast(mat3(placed.matrix())));
    } else {
        const Result<const Mesh*> mesh = files.find(params.mesh);
        if (!mesh) return mesh.error();
        const mat4 place = params.fitSize > 0 ? Transform::fitted((*mesh)->bounds(), params.fitSize, params.position, params.rotation)
                                              : Transform{params.position, params.rotation, params.scale}.matrix();
        made.mesh = transformed(**mesh, place);
        const bool hull = params.shape == "hull";
        HullMesh around;
        if (hull) around = convexHull(made.mesh.positions);
        Result<MeshBody> solid = meshShape(hull ? MeshView{around.positions, around.indices, {}, {}} : made.mesh.view(), density, spacing);
        if (!solid) return solid.error();
        shape = std::move(solid->shape);
        state.pose = solid->frame;
        toOwn(made.mesh, state.pose);
        for (const BodyPartParams& part : params.parts) {
            const Result<const Mesh*> drawn = files.find(part.mesh);
            if (!drawn) return drawn.error();
            made.parts.push_back(transformed(**drawn, place));
            toOwn(made.parts.back(), state.pose);
        }
        made.form.kind = hull ? BodyForm::Kind::hull : BodyForm::Kind::cells;
        for (const vec3& p : around.positions) made.form.points.push_back(state.pose.toOwn(p));
        constexpr int kCells = 12;  // along the longest side: contact need not be finer than it looks
        if (!hull) made.form.cells = cellsOf(shape, made.mesh.bounds(), kCells);
        if (!hull && made.form.cells.empty()) return badInput("the mesh is too thin to touch anything with: make it a hull or a box");
    }
    if (params.ballast != vec3(0.0F)) {
        const vec3 world = mat3(placed.matrix()) * params.ballast;
        weighDown(made, glm::conjugate(state.pose.rotation) * world);
        state.pose.position += world;
    }
    state.velocity = params.velocity;
    state.spin = params.spin * (kPi / 180.0F);
    shape.sticks = params.sticks ? 1.0F : 0.0F;
    made.form.friction = params.friction;
    made.form.restitution = params.restitution;
    const float factor = params.fixed ? 0.0F : params.mass > 0 ? params.mass / shape.mass : 1.0F;
    shape.mass *= factor;
    shape.inertia *= factor;
    return made;
}

}  // namespace

Result<std::vector<SceneBody>> sceneBodies(const SceneFile& scene) {
    std::vector<SceneBody> all;
    MeshFiles files(scene.folder);
    for (size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyParams& params = scene.bodies[i];
        Result<SceneBody> made = bodyOf(params, files, scene.fluid.spacing);
        if (!made)
            return Error{fmt::format("bodies[{}]{}: {}", i, params.mesh.empty() ? "" : " (" + params.mesh + ")", made.error().message),
                         made.error().fault};
        made->form.layers = params.layers;
        made->body.meetsWater = scene.fluid.collision.layers.meet(params.layers);
        all.push_back(std::move(*made));
    }
    return all;
}

}  // namespace rivulet
