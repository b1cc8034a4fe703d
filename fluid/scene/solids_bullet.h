// Contact of floating bodies with the scene and each other, by Bullet: one filling of BodyHost.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/mesh_view.h"
#include "fluid/sim/solids/solids.h"

namespace rivulet {

// What a body touches with, in its own frame.
struct BodyForm {
    enum class Kind { box, sphere, hull, cells };
    Kind kind = Kind::box;
    vec3 size{0.0F};           // m, box
    float radius = 0;          // m, sphere
    vec3 centre{0.0F};         // m, of a box or sphere
    std::vector<vec3> points;  // m, hull
    // Boxes that fill a mesh: centres and sizes, m.
    std::vector<std::pair<vec3, vec3>> cells;
    float friction = 0.5F, restitution = 0.1F;
};

// Boxes that fill what `distance` is negative in, `across` of them along the longest side.
std::vector<std::pair<vec3, vec3>> cellsOf(const BodyShape& shape, const Bounds& bounds, int across);

// The convex hull of some points as a mesh, counter-clockwise from outside. Empty where they lie in a plane.
struct HullMesh {
    std::vector<vec3> positions;
    std::vector<uint32_t> indices;
};
HullMesh convexHull(std::span<const vec3> points);

class BulletSolids {
  public:
    // Walls of `box` where it is not periodic, `planes`, meshes that stand still (in the world) and that move (in their own frames, at
    // `poses`).
    struct Scene {
        BoxParams box;
        std::span<const PlaneSolid> planes;
        std::span<const MeshView> still, moving;
        std::span<const Pose> poses;
    };
    // One form a body. Copies what it needs.
    BulletSolids(const Scene& scene, std::span<const Body> bodies, std::span<const BodyForm> forms);
    ~BulletSolids();
    BodyHost host();  // the BulletSolids must outlive its use
    // Where the moving meshes are to be when `seconds` have gone by; 0: they are there now.
    void moveTo(std::span<const Pose> poses, double seconds);
    // A hand that holds a body, at `at` (m, the body's own frame), and draws that to `to` (m, world) until it lets go: by a spring that is
    // damped critically, carries the body's weight, and never pulls harder than 20 times that.
    struct Hold {
        size_t body = 0;
        vec3 at{0.0F}, to{0.0F};
    };
    void hold(const std::optional<Hold>& hand);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
