// The parameter block of the kernels of flow on a skin, and the layout of a drop. Shared by C++, GLSL and OpenCL. Lengths in m, in the
// skin's frame.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
CONSTANT(float, PICOLITRE, 1.0e-15f);  // m^3
// A drop, by id: five uints. Its volume is a whole number, so that none is lost to rounding; 0 is a free slot.
CONSTANT(uint, DROP_TRIANGLE, 0u);  // its number, and flags
CONSTANT(uint, DROP_B1, 1u);  // float bits: barycentric coordinates of corners 1 and 2
CONSTANT(uint, DROP_B2, 2u);
CONSTANT(uint, DROP_VOLUME, 3u);  // picolitres
CONSTANT(uint, DROP_SHARE, 4u);  // float bits, 0 a drop, 1 part of a film
CONSTANT(uint, DROP_UINTS, 5u);
CONSTANT(uint, MOTION_VECS, 3u);  // of a drop, by id: see flow/place, flow/steer
CONSTANT(float, DRIVE_STALE, 1.0e30f);  // in the place of a curvature: flow/drive has still to compute it
CONSTANT(uint, DROP_LEFT, 0x80000000u);  // has let go, or run over an edge: the triangle is the last one
CONSTANT(uint, DROP_FILM, 0x40000000u);  // part of a film: merges with no drop
CONSTANT(uint, DROP_BRIM, 0x20000000u);  // part of a brim: stays. In a birth: the number is that of a brim's place, which gets the volume
CONSTANT(uint, DROP_NEW, 0x10000000u);  // spawned in this step, or what stays of a drop that let go: its velocity is the given one
CONSTANT(uint, DROP_NUMBER, 0x0FFFFFFFu);
CONSTANT(uint, SKIN_OPEN, 0xFFFFFFFFu);
CONSTANT(uint, SKIN_UINTS, 8u);
CONSTANT(uint, DRY_EVERY, 16u);  // triangles: one in so many has its turn each step
STRUCT(FlowStep) {
    vec4 pull;   // xyz m/s^2, gravity, in the skin's frame as all vectors below
    vec4 wind;   // xyz m/s, velocity of the air
    vec4 turn0;  // rows of a matrix: a direction in the last step's frame -> in this step's frame
    vec4 turn1;
    vec4 turn2;
    vec4 drift0;  // rows of a matrix, applied to (x, y, z, 1): a point (m) -> its velocity because the frame moves, m/s
    vec4 drift1;
    vec4 drift2;
    uint count;  // number of drop slots
    uint triangles;
    uint places;
    uint births;          // drops spawned in this step
    uint insideAt;        // index into cellStart: the number of drops
    uint freeAt;          // index into cellStart: the first free slot
    float dt;             // s
    float density;        // kg/m^3
    float contactRadius;  // radius of a drop's foot over the cube root of its volume
    float hold;           // N/m: times a drop's width: the retention force (contact angle hysteresis)
    float drag;           // Pa s: times its width and speed: the drag force
    float hangs0;         // 1 / the largest volume that hangs under a skin, over the cube of the capillary length l: hangs0 + hangs1 b +
    float hangs1;         // hangs2 b^2, where b is l over the radius of the skin, 0 to 1 (fluid/flow/pendant_drop.h)
    float hangs2;
    float falls0;         // share of a drop that falls when it lets go: falls0 + falls1 b
    float falls1;
    float airDrag;        // kg/m^3: times the squares of its width and of the air's speed: the force of the wind
    float trail;          // m, thickness of the film that a drop leaves; 0: none
    float trailWidth;     // share of a drop's width
    float slip;           // share of the retention force that a wet trail removes
    float steer;          // share of the retention force: the sideways pull of a trail
    float cell;           // m, maximum width of a film's cell
    float dries;          // m, thickness that evaporates between two turns of a triangle
    float viscosity;      // Pa s
    float filmSelf;       // 1/m^2: height of a film over its volume for a single particle
    float filmReach;      // m, support radius of the film's SPH sum
    float filmRadius;     // m, radius of a cap that is as wide as one particle of a film
    float jump;           // m/s: a faster place of the skin counts as teleported, with velocity 0
    float inverseDt;      // 1/s
    float tension;        // N/m
    uint dryPhase;        // the group of triangles whose turn it is to dry
    uint brimAt;          // id of the first place of a brim
    uint brims;
    float brimMost;    // picolitres, capacity of a place of a brim: more spills
    float brimRadius;  // m, radius of a place of a brim, as drawn
    float tear;        // picolitres, volume of a drop that spills
    float settle;      // share of the way to equilibrium that a brim moves in a step
    float reach;       // share of a cap's height: the distance at which a drop moves to the facing skin
    uint number;       // number of this step, from 1
    uint everywhere;   // 1: flow/drive is needed at every place
    float pearlPace;   // m/s: a faster drop sheds small ones
    uint reports;      // 1: flow/law reports the drops that hang
    uint unused1;
    uint unused2;
};
STRUCT(FlowBirth) {
    vec4 velocity;  // m/s, along the triangle; w: 1 part of a film, 0 a drop
    uint triangle;
    float b1;  // barycentric coordinates of corners 1 and 2
    float b2;
    uint volume;  // picolitres
};
STRUCT(FlowLeft) {
    vec4 position;  // xyz m; w: its former slot
    vec4 velocity;  // m/s
    uint volume;    // picolitres
    uint triangle;  // its last triangle
    uint letGo;     // 1: it hung; 0: it ran over an edge
    uint spare0;
};
// A drop that hangs from the skin.
STRUCT(FlowHanging) {
    vec4 position;  // xyz m; w: its slot
    vec4 up;        // xyz unit, the skin's mean normal; w 1/m, the skin's curvature
    vec4 pull;      // xyz m/s^2, what pulls at it; w: its share of the largest volume there
    uint volume;    // picolitres
    uint count;     // of the first of the list: how many hang, which may be more than the list holds
    uint spare0;
    uint spare1;
};
CONSTANT(float, CORNER_LEAVES, 0.125f);  // share of the cube of the receding angle where a drop's back becomes a corner: at half the angle
CONSTANT(uint, PEARL_SHARE, 512u);  // volumes of a drop that it sheds in that of the drop: an eighth as wide
CONSTANT(uint, MOST_LEFT, 256u);  // in a step; the others wait for the next
CONSTANT(uint, MOST_HANGING, 256u);  // that are reported and drawn as such: the others are drawn as caps
CONSTANT(uint, FLOW_COUNTERS, 8u);  // see born, merge, leave, law, dry
// A drop is drawn as a cap up to the first share of the largest volume that hangs there, and from the second on as one that hangs.
CONSTANT(float, HANGS_FROM, 0.06f);
CONSTANT(float, HANGS_FULLY, 0.2f);
// Not of the language: a positive number's cube root, to rounding (Newton, from a guess by its bits).
#if !defined(__cplusplus) || defined(RIVULET_KERNEL_UNIT)
FN float cubeRoot(float v) {
    float x = BITS_FLOAT(FLOAT_BITS(v) / 3u + 709921077u);
    x = x - (x * x * x - v) / (3.0f * x * x);
    x = x - (x * x * x - v) / (3.0f * x * x);
    return x - (x * x * x - v) / (3.0f * x * x);
}
#endif
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(FlowStep) % 16 == 0 && sizeof(FlowBirth) == 32 && sizeof(FlowLeft) == 48 && sizeof(FlowHanging) == 64);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
