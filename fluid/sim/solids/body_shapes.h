// Shapes of bodies: samples under their surface, half a spacing deep and about a spacing apart, and what they weigh.
#pragma once

#include "engine/core/mesh_view.h"
#include "engine/core/result.h"
#include "fluid/sim/solids/bodies.h"

namespace rivulet {

// `size`, `radius`, `spacing` m, > 0; `density` kg/m^3, 0: it never moves. Samples of a box lie on a lattice, on its edges too; of a sphere
// on a spiral (Fibonacci lattice).
BodyShape boxShape(const vec3& size, double density, float spacing);
BodyShape sphereShape(float radius, double density, float spacing);

// A closed mesh as a body. Samples: darts thrown evenly over the surface and sunk into it, none nearer to another than 0.8 spacings
// (Poisson disc, Cook 1986); the same for the same mesh. Where it is thinner than a spacing they lie in its middle.
struct MeshBody {
    BodyShape shape;
    Pose frame;  // of the body's own frame in the mesh's
};
// Error (badInput): no triangles, or no volume inside them (open, or inside out).
Result<MeshBody> meshShape(const MeshView& mesh, double density, float spacing);

// BodyShape::shell of a mesh in the body's frame. Degenerate triangles have no points.
std::vector<ShellPoint> meshShell(const MeshView& mesh, float apart);

}  // namespace rivulet
