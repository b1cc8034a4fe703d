// ColliderModel: a collider's file in a scene. Its parts are nodes that hang together as in the file, with the file's materials, and all of
// them at once are the mesh that water meets. A clip of the file moves both.
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
    // Of a kind with triangles (collider_kinds.h). Reads the file and adds its nodes to `nodes`, as they are at t = 0. `device` bends parts
    // with bones or morphs; it must outlive the nodes. Error (badInput): no such file, or nothing in it that can be used; no such clip, and
    // which there are.
    static Result<ColliderModel> create(const ColliderParams& params, const std::string& folder, Device& device, Scene& nodes);

    // All parts at t = 0, m: in the world, or of what moves in the frame that pose() places.
    const Mesh& mesh() const { return mesh_; }
    size_t node() const { return group_; }  // that all others hang from
    // The file's materials, or what the scene says of them.
    void dress(const ColliderParams& params, Scene& nodes) const;
    bool dressed() const;  // whether the file has materials

    bool plays() const { return clip_.has_value(); }
    bool rigid() const { return rigid_; }  // the clip moves it as a whole
    // Of a rigid clip, at a time (s): mesh() -> the world.
    Pose pose(double time) const;
    // Of any other: mesh()'s vertices, in their order, within reach() at all times.
    void shape(double time, std::vector<vec3>& positions);
    const Bounds& reach() const { return reach_; }  // m, world
    // Puts the nodes where a clip that is not rigid has them.
    void place(double time, Scene& nodes);

    const Model& model() const { return model_; }  // its parts' meshes are with the nodes
    // A node of the file -> the world, at t = 0.
    mat4 toWorld(int node) const { return start_ * atStart_[static_cast<size_t>(node)]; }

  private:
    struct Part {
        size_t node = 0;  // of the scene
        std::shared_ptr<const Mesh> mesh;
        std::shared_ptr<Deformer> deformer;  // null: it keeps its shape
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
    std::vector<mat4> world_;    // the same, as it stands
    Mesh mesh_;
    bool rigid_ = false;  // see rigid()
    vec3 pivot_{0.0F};    // m, world: the origin of a rigid clip's frame
    Bounds reach_;
};

// The scene's camera and light, where they come from one of these files, as they are at t = 0. The camera's target is then the point of
// its axis nearest to the middle of the fluid's box. Error (badInput): none has one of that name, and which there are.
Status takeViews(std::span<const ColliderModel> models, SceneFile& scene);

}  // namespace rivulet
