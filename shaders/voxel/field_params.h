// The parameter block of the static field. Layout shared by C++, GLSL (std140) and OpenCL: scalars and vec4 only, size % 16 == 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(FieldParams) {
    vec4 origin;  // m, the low corner of voxel (0,0,0); w = 1 / voxel (1/m)
    int sizeX;    // voxels along each axis; the distance band has one more point an axis
    int sizeY;
    int sizeZ;
    uint countIndex;  // cellStart[countIndex] is the number of active particles
    float voxel;      // m, edge
    float band;       // m, distances are exact below it and equal to it beyond
    float contact;    // m, minimum distance of centres from the mesh: max(spacing / 2, kContactVoxels * voxel)
    float restSpeed;  // m/s, a slower approach does not bounce, so that resting particles stay at rest
    float nudge;      // voxels, tolerance for rounding: a voxel nearer than this to a point counts as touched
    uint surfacesAt;  // bandNormal[surfacesAt + 2 s], [.. + 1]: float bits of surface s's Coulomb friction (>= 0) and restitution (0..1)
    float unused0;
    float unused1;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(FieldParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
