// What every kernel of flow on a skin knows, and how a drop is kept. Layout shared by C++, GLSL and OpenCL. Lengths in m, in the skin's frame.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
#define PICOLITRE 1.0e-15f  /* m^3 */
// A drop, by id: four uints. Its volume is a whole number, so that none is lost to rounding; 0 is a free slot.
#define DROP_TRIANGLE 0u  /* DROP_LEFT + the last one when it has let go or run over an edge */
#define DROP_B1 1u        /* float bits: barycentric coordinates of corners 1 and 2 */
#define DROP_B2 2u
#define DROP_VOLUME 3u    /* picolitres */
#define DROP_UINTS 4u
#define DROP_LEFT 0x80000000u
#define SKIN_OPEN 0xFFFFFFFFu
#define SKIN_UINTS 8u
#define DRY_EVERY 16u  /* triangles: one in so many has its turn each step */
STRUCT(FlowStep) {
    vec4  pull;            // xyz m/s^2, what acts on all mass alike: gravity, and the inertia of a skin that moves
    vec4  wind;            // xyz m/s, of the air past the skin
    uint  count;           // slots of drops
    uint  triangles;
    uint  places;
    uint  births;          // of this step
    uint  insideAt;        // index into cellStart: how many drops there are
    uint  freeAt;          // index into cellStart: where free slots begin
    float dt;              // s
    float density;         // kg/m^3
    float contactRadius;   // of a drop, over the cube root of its volume
    float hold;            // N/m: times a drop's width, the force that holds it
    float drag;            // Pa s: times its width and speed, the force that slows it
    float adhesion;        // N/m: times its width, the force that keeps it on a skin it hangs from
    float airDrag;         // kg/m^3: times the square of its width and of the air's speed, the force of wind
    float trail;           // m, thickness of the film that a drop leaves; 0: none
    float trailWidth;      // of a drop's width
    float slip;            // share of what holds it that a wet way takes
    float steer;           // of what holds it: the pull of a trail to one side
    float cell;            // m, a film's cells are no wider
    float dries;           // m, of film in the time since this triangle's turn
    uint  dryPhase;        // whose turn it is
    uint  spare0;
    uint  spare1;
    uint  spare2;
    uint  spare3;
};
STRUCT(FlowBirth) {
    vec4  velocity;  // m/s, along the triangle
    uint  triangle;
    float b1;        // barycentric, of corners 1 and 2
    float b2;
    uint  volume;    // picolitres
};
STRUCT(FlowLeft) {
    vec4  position;  // m; w: the slot it had
    vec4  velocity;  // m/s
    uint  volume;    // picolitres
    uint  triangle;  // the last one
    uint  spare0;
    uint  spare1;
};
#define MOST_LEFT 256u     /* in a step; the others wait for the next */
#define FLOW_COUNTERS 8u  /* see born, merge, leave, dry */
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
static_assert(sizeof(FlowStep) % 16 == 0 && sizeof(FlowBirth) == 32 && sizeof(FlowLeft) == 48);
}  // namespace rivulet
#endif
