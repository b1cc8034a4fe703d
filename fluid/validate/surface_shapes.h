// Shapes whose surface a formula knows, filled with particles: what a drawn surface is measured on without a simulation.
#pragma once

#include <vector>

#include "engine/render/frame_view.h"
#include "fluid/sim/surface/ellipsoids.h"
#include "fluid/validate/surface_metrics.h"

namespace rivulet {

// What is drawn: particles that need no world.
struct SplatSet {
    std::vector<vec4> at;  // m; w: density ratio
    float spacing = 0;     // m
    Bounds box;            // m, that cuts the water; empty: none does
    HostEllipsoids ellipsoids = {};
};

struct SurfaceShape {
    const char* name;
    SplatSet splats;
    FrameView view;
    SurfaceMap reference;
    bool whole;   // its silhouette is seen
    bool judged;  // its particles lie as water leaves them
};

// A sphere and a level. The sphere that is judged is a drop that has settled: one that is cut from a lattice has real terraces, and its
// true surface, ray-marched, is off the sphere's normals by 5.7 deg itself. In pixels.
std::vector<SurfaceShape> surfaceShapes(int width, int height);

}  // namespace rivulet
