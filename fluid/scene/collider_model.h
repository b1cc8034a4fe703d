// ColliderModel: a collider's model in a scene. Its parts are nodes with the hierarchy and the materials of the file. All parts together
// are the mesh that water collides with. A clip of the file moves both.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/compute/device.h"
#include "engine/scene/animation.h"
#include "engine/scene/scene.h"
#include "fluid/scene/scene_file.h"
#include "fluid/sim/world/pose.h"

namespace rivulet {

class ColliderModel {
  public:
    // Of a kind with triangles (collider_kinds.h). Adds its nodes to `nodes`, as they are at t = 0. `device` deforms parts with bones or
    // morph targets and must outlive the nodes. Error (badInput): the file is missing or unusable; no such clip (the sentence lists those
    // that exist).
    static Result<ColliderModel> create(const ColliderParams& params, const std::string& folder, Device& device, Scene& nodes);

    // All parts at t = 0, m: in the world, or, of a collider that moves, in the frame that pose() places.
    const Mesh& mesh() const { return mesh_; }
    size_t node() const { return group_; }  // the parent of all others
    // Sets the nodes' materials: those of the file, or that of the scene.
    void dress(const ColliderParams& params, Scene& nodes) const;
    bool dressed() const;  // whether the file has materials

    bool plays() const { return clip_.has_value(); }
    bool rigid() const { return rigid_; }  // the clip moves it as a whole
    // Of a rigid clip, at a time (s): mesh() -> the world.
    Pose pose(double time) const;
    // Of any other clip: the vertices of mesh(), in their order, always within reach().
    void shape(double time, std::vector<vec3>& positions);
    const Bounds& reach() const { return reach_; }  // m, world
    // Places the nodes of a clip that is not rigid.
    void place(double time, Scene& nodes);

    const Model& model() const { return model_; }  // its parts' meshes are with the nodes
    // A node of the file -> the world, at t = 0.
    mat4 toWorld(int node) const { return start_ * atStart_[static_cast<size_t>(node)]; }

  private:
    struct Part {
        size_t node = 0;  // of the scene
        std::shared_ptr<const Mesh> mesh;
        std::shared_ptr<Deformer> deformer;  // null: rigid
    };

    ColliderModel() = default;
    Status choose(const ColliderAnimation& animation);
    Status addParts(Device& device);
    void fit(const ColliderParams& params);
    void addNodes(const std::string& name, Scene& nodes);
    double clipTime(double time) const;
    std::vector<mat4> locals(double time) const;
    void stand(double time);
    void gather(const mat4& toWorld, std::vector<vec3>& positions) const;
    Mesh merged(const mat4& toWorld) const;
    void findMotion();
    mat4 wayTo(double clipTime) const;

    ColliderAnimation animation_;
    Model model_;
    std::optional<Clip> clip_;
    std::vector<Part> parts_;      // of each of model_.parts
    std::vector<size_t> nodesOf_;  // of the scene, one of each of the model's; empty: the group is the only part
    size_t group_ = 0;
    mat4 start_{1.0F};           // the file -> the world, at t = 0
    mat4 place_{1.0F};           // the file -> mesh()'s frame
    std::vector<mat4> atStart_;  // model_.nodes -> the file, at t = 0
    std::vector<mat4> world_;    // the same, now
    Mesh mesh_;
    bool rigid_ = false;  // see rigid()
    vec3 pivot_{0.0F};    // m, world: the origin of a rigid clip's frame
    Bounds reach_;
};

// Sets the scene's camera and light where camera.from and light.from name one of these files', as they are at t = 0. The camera's target is
// the point on its axis nearest to the centre of the fluid's box. Error (badInput): no such name (the sentence lists those that exist).
Status setViewsFromFiles(std::span<const ColliderModel> models, SceneFile& scene);

}  // namespace rivulet
