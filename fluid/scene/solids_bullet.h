// Contact of floating bodies with the scene and each other, by Bullet: one filling of BodyHost.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/core/mesh_view.h"
#include "fluid/sim/solids/layers.h"
#include "fluid/sim/solids/solids.h"

namespace rivulet {

// The contact shape of a body, in its own frame.
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
    LayersParams layers;
};

// Boxes that fill the inside of a shape (negative distance), `across` of them along the longest side.
std::vector<std::pair<vec3, vec3>> cellsOf(const BodyShape& shape, const Bounds& bounds, int across);

// The convex hull of points as a mesh, counter-clockwise from outside. Empty where they lie in a plane.
struct HullMesh {
    std::vector<vec3> positions;
    std::vector<uint32_t> indices;
};
HullMesh convexHull(std::span<const vec3> points);

class BulletSolids {
  public:
    // The walls of `box` along axes that are not periodic, `planes`, static meshes (in the world) and moving ones (in their own frames,
    // at `poses`).
    struct Scene {
        BoxParams box;
        std::span<const PlaneSolid> planes;
        std::span<const MeshView> still, moving;
        std::span<const Pose> poses;
        // Of each of them; empty: as by default. The walls of the box meet all bodies.
        std::span<const LayersParams> planeLayers = {}, stillLayers = {}, movingLayers = {};
    };
    // One form per body. Copies its arguments.
    BulletSolids(const Scene& scene, std::span<const Body> bodies, std::span<const BodyForm> forms);
    ~BulletSolids();
    BodyHost host();  // the BulletSolids must outlive its use
    // The poses of the moving meshes in `seconds`; 0: they are moved there now.
    void moveTo(std::span<const Pose> poses, double seconds);
    // Pulls at a body from now on; a fixed one does not move. Nothing: ends.
    void hold(const std::optional<BodyPull>& hand);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace rivulet
