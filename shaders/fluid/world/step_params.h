// The parameter block of all kernels of a step. Layout shared by C++, GLSL (std140) and OpenCL: scalars and vec4 only, size % 16 == 0.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
STRUCT(StepParams) {
    vec4 gravity;     // m/s^2, w unused
    vec4 gridOrigin;  // m, the low corner of the padded grid's cell (0,0,0)
    vec4 gridScale;   // 1/m, cells per metre along x, y, z: the cell edge is h, or slightly more on a periodic axis
    vec4 period;      // m; 0 = the axis is not periodic
    vec4 invPeriod;   // 1/m; 0 = the axis is not periodic
    vec4 boxMin;      // m, the walls; w = 1 if there are walls, else 0
    vec4 boxMax;      // m
    vec4 force;       // parameters of a row of forces(); its kernels document them
    int cellsX;       // padded: one empty cell on every side
    int cellsY;
    int cellsZ;
    uint cellCount;     // of fluid: cellsX * cellsY * cellsZ (cpu: twice that); cellStart[cellCount] = fluid particles inside the grid
    uint totalCells;    // including those of body samples: cellCount, or twice it. For the entries of cellStart after them see grid.h
    uint count;         // slots of particles and body samples
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
    float contact;      // m, minimum distance of a particle's centre from walls
    float restitution;  // 0..1, of the box walls
    float spacing;      // m
    float maxSpeed;     // m/s, above which a particle could pass a wall in one step: higher speeds are limited and counted
    uint planeCount;    // of the array of collider planes
    float wallMargin;   // m, walls are looked for this much farther: for particles that move before their walls are looked for again
    float friction;     // Coulomb friction of the box walls
    float relaxation;   // relaxation factor of the pressure solvers
    float warmStart;    // share of the last step's pressures that the next step starts with
    uint iteration;     // of a solver, from 0; dfsph: 0 of the first, 1 of the next, 2 of later ones
    float correction;   // share of a density error that a step corrects
    uint awakeSlots;    // cpu: slots before those of sleeping particles; else, and in a step that sorts them anew, count
    float sampleScale;  // of push_samples.kernel: an acceleration (m/s^2) over pressure times gradient (1/m)
    uint asleepSets;    // 1: sleeping particles have cells of their own, see grid.h; else 0
    float momentum;     // share of the last iteration's change that is repeated (heavy ball)
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(StepParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
