#include "fluid/scene/body_params.h"

#include <fmt/format.h>

namespace rivulet {

void BodyPartParams::visit(ParamVisitor& v) {
    v.value({.name = "mesh", .doc = "mesh file, searched as a collider's; scaled and turned like the body's own", .fixed = kFixed}, mesh);
    v.colour({"colour", "", "linear red, green, blue", 0, 1}, colour);
    v.value({"roughness", "", "0 = mirror, 1 = chalk", 0, 1}, roughness);
}

void BodyParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> shapes = {"box", "sphere", "hull", "mesh"};
    v.choice({.name = "shape", .doc = "a box, a sphere, the convex hull of a mesh, or a closed mesh", .fixed = kFixed}, shape, shapes);
    v.value({.name = "mesh", .doc = "mesh file of a hull or mesh, searched as a collider's", .fixed = kFixed}, mesh);
    v.value({"size", "m", "edge lengths of a box", 1.0e-4, kMaxPosition, kLog, kFixed}, size);
    v.value({"radius", "m", "radius of a sphere", 1.0e-4, kMaxPosition, kLog, kFixed}, radius);
    v.value({"scale", "", "scale factor of a hull or mesh", 1.0e-6, 1.0e6, kLog, kFixed}, scale);
    v.value({"fitSize", "m", "length that a mesh's longest side is scaled to; 0 = use scale", 0, kMaxPosition, kLog, kFixed}, fitSize);
    v.value({"position", "m", "position of the body's centre; hull or mesh: of the mesh's origin (with fitSize: of its centre)",
             -kMaxPosition, kMaxPosition, kLinear, kFixed},
            position);
    v.value({"rotation", "deg", "rotation about x, then y, then z", -360, 360, kLinear, kFixed}, rotation);
    v.value({"velocity", "m/s", "velocity at t = 0", -1000, 1000, kLinear, kFixed}, velocity);
    v.value({"spin", "deg/s", "angular velocity about the centre of mass at t = 0", -36000, 36000, kLinear, kFixed}, spin);
    v.value({"density", "kg/m^3", "mean density of the body; water has about 1000", 0.01, 1.0e5, kLog, kFixed}, density);
    v.value({"mass", "kg", "mass of the body; 0 = density times volume", 0, 1.0e9, kLog, kFixed}, mass);
    v.value({"ballast", "m", "offset of the centre of mass from the centre of volume, before rotation: for example a keel's weight", -1000,
             1000, kLinear, kFixed},
            ballast);
    v.value({"friction", "", "Coulomb friction with walls and other bodies", 0, 10, kLinear, kFixed}, friction);
    v.value({"restitution", "", "share of the normal speed after an impact with walls and other bodies", 0, 1, kLinear, kFixed},
            restitution);
    v.value({.name = "fixed", .doc = "whether it is static: a wall of boundary particles", .fixed = kFixed}, fixed);
    v.value({.name = "sticks", .doc = "boundary condition of the fluid at the body; on: no-slip; off: free slip", .fixed = kFixed}, sticks);
    layers.visit(v);
    v.list({.name = "parts", .doc = "meshes that are drawn with a hull or mesh", .fixed = kFixed}, parts);
    v.colour({"colour", "", "linear red, green, blue", 0, 1}, colour);
    v.value({"roughness", "", "0 = mirror, 1 = chalk", 0, 1}, roughness);
    v.value(
        {"porosity", "",
         "how much darker the surface is when wet (fluid.wetness): 0 = plastic or glaze, 1 = stone or cloth; -1 = by its roughness", -1, 1},
        porosity);
    v.value({.name = "visible", .doc = "whether it is drawn"}, visible);
}

std::string contradiction(const BodyParams& body) {
    const bool ofMesh = body.shape == "mesh" || body.shape == "hull";
    if (ofMesh && body.mesh.empty()) return ".mesh is empty: name a mesh file, or set shape to box or sphere";
    if (!body.parts.empty() && !ofMesh) return fmt::format(" is a {}: only a hull or mesh can have parts", body.shape);
    return "";
}

}  // namespace rivulet
