// What every kernel of a step knows. Layout shared by C++, GLSL (std140) and OpenCL: scalars and vec4 only, size % 16 == 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(StepParams) {
    vec4 gravity;     // m/s^2, w unused
    vec4 gridOrigin;  // m, the low corner of the padded grid's cell (0,0,0)
    vec4 gridScale;   // 1/m, cells a metre along x, y, z: an edge is h, or a little more on a periodic axis
    vec4 period;      // m; 0 = the axis is not periodic
    vec4 invPeriod;   // 1/m; 0 = the axis is not periodic
    vec4 boxMin;      // m, the walls; w = 1 if there are walls, else 0
    vec4 boxMax;      // m
    vec4 force;       // what a row of forces() wants to know: its kernels say
    int cellsX;       // padded: one empty cell on every side
    int cellsY;
    int cellsZ;
    uint cellCount;     // of fluid: cellsX * cellsY * cellsZ (cpu: twice that); cellStart[cellCount] = fluid particles inside the grid
    uint totalCells;    // with those of body samples: cellCount, or twice it. Behind them in cellStart: see grid.h
    uint count;         // slots of particles, body samples with them
    uint firstSample;   // ids from here on are samples on the surface of bodies
    float h;            // m, support radius = cell edge
    float invH;         // 1/m
    float dt;           // s
    float mass;         // kg
    float restDensity;  // kg/m^3
    float kernelK;      // density kernel's factor: Wendland C2 21/(2 pi h^3); thesis poly6 315/(64 pi h^9)
    float gradientK;    // gradient's factor: Wendland C2 -210/(pi h^5); thesis spiky -45/(pi h^6)
    float stiffness;    // Tait: c0^2 rho0 / 7 (Pa). Thesis (4): k (m^2/s^2). DFSPH: c^2 (m^2/s^2)
    float viscosity;    // m^2/s, kinematic
    float artificial;   // alpha c0 hs, m^2/s: Monaghan's artificial viscosity (approaching pairs only)
    float contact;      // m, a particle's centre keeps this far from walls
    float restitution;  // 0..1, of the box walls
    float spacing;      // m
    float maxSpeed;     // m/s, above which the step would tunnel: speeds are limited to it and counted
    uint planeCount;    // of the array of collider planes
    float wallOffset;   // m, added to a wall's distance in the density: a lattice half a spacing off a wall is then at rest density
    float friction;     // Coulomb's, of the box
    float relaxation;   // of an iteration of the pressure solvers
    float warmStart;    // share of the last step's pressures that the next begins with
    uint iteration;     // of a solver, from 0; dfsph: 1 of all but the first
    float correction;   // of a density that is off: the share that a step puts right
    float wallShare;    // of a wall at the distance at which particles rest on it, less a hair: above it none moves nearer
    float sampleScale;  // of push_samples.kernel: an acceleration (m/s^2) over pressure times gradient (1/m)
    float padding2;
    float momentum;  // share of the last iteration's change that is made again (heavy ball)
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(StepParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
