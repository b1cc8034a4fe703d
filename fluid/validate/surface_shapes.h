// Shapes with an analytic surface, filled with particles, on which a drawn surface is measured without a simulation.
#pragma once

#include <vector>

#include "engine/render/frame_view.h"
#include "fluid/sim/surface/ellipsoids.h"
#include "fluid/validate/surface_metrics.h"

namespace rivulet {

// Particles to draw, without a world.
struct SplatSet {
    std::vector<vec4> at;  // m; w: density ratio
    float spacing = 0;     // m
    Bounds box;            // m, clips the water; empty: no clipping
    HostEllipsoids ellipsoids = {};
    float viscosity = 0;  // m^2/s
};

struct SurfaceShape {
    const char* name;
    SplatSet splats;
    FrameView view;
    SurfaceMap reference;
    bool whole;   // its whole silhouette is visible
    bool judged;  // its particles are arranged as in simulated water
};

// Spheres and a plane; size in pixels. The judged sphere is a settled drop: a sphere cut from a lattice has terraces, and even its
// ray-marched surface differs from the normals of the sphere by 5.7 degrees.
std::vector<SurfaceShape> surfaceShapes(int width, int height);

}  // namespace rivulet
