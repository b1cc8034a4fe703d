// What every kernel of flow on a skin knows, and how a drop is kept. Layout shared by C++, GLSL and OpenCL. Lengths in m, in the skin's
// frame.
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
CONSTANT(uint, DROP_LEFT, 0x80000000u);  // has let go, or run over an edge: the triangle is the last one
CONSTANT(uint, DROP_FILM, 0x40000000u);  // part of a film: runs into nobody
CONSTANT(uint, DROP_BRIM, 0x20000000u);  // part of a brim: stays where it is. In a birth: the number is a brim's place, which the volume is added to
CONSTANT(uint, DROP_NEW, 0x10000000u);  // born in this step: its velocity is as it was given
CONSTANT(uint, DROP_NUMBER, 0x0FFFFFFFu);
CONSTANT(uint, SKIN_OPEN, 0xFFFFFFFFu);
CONSTANT(uint, SKIN_UINTS, 8u);
CONSTANT(uint, DRY_EVERY, 16u);  // triangles: one in so many has its turn each step
STRUCT(FlowStep) {
    vec4 pull;   // xyz m/s^2, what acts on all mass alike, in the skin's frame as all that follows
    vec4 wind;   // xyz m/s, of the air
    vec4 turn0;  // rows of a matrix: a direction as the last step's frame has it -> as this one's has it
    vec4 turn1;
    vec4 turn2;
    vec4 drift0;  // rows of a matrix, w with 1: a place (m) -> its speed as the frame moves, m/s
    vec4 drift1;
    vec4 drift2;
    uint count;  // slots of drops
    uint triangles;
    uint places;
    uint births;          // of this step
    uint insideAt;        // index into cellStart: how many drops there are
    uint freeAt;          // index into cellStart: where free slots begin
    float dt;             // s
    float density;        // kg/m^3
    float contactRadius;  // of a drop, over the cube root of its volume
    float hold;           // N/m: times a drop's width, the force that holds it
    float drag;           // Pa s: times its width and speed, the force that slows it
    float adhesion;       // N/m: times its width, the force that keeps it on a skin it hangs from
    float airDrag;        // kg/m^3: times the square of its width and of the air's speed, the force of wind
    float trail;          // m, thickness of the film that a drop leaves; 0: none
    float trailWidth;     // of a drop's width
    float slip;           // share of what holds it that a wet way takes
    float steer;          // of what holds it: the pull of a trail to one side
    float cell;           // m, a film's cells are no wider
    float dries;          // m, of film in the time since this triangle's turn
    float viscosity;      // Pa s
    float filmSelf;       // 1/m^2: height of a film over volume, where one particle is alone
    float filmReach;      // m, support radius of the film's sum
    float filmRadius;     // m, of a cap that is spread as widely as one particle of a film
    float jump;           // m/s: a skin's place that is faster has not moved, it is another
    float inverseDt;      // 1/s
    float tension;        // N/m
    uint dryPhase;        // whose turn it is
    uint brimAt;          // id of the first place of a brim
    uint brims;
    float brimMost;    // picolitres, of a place of a brim: more spills
    float brimRadius;  // m, of a place of a brim, as drawn
    float tear;        // picolitres, of a drop that spills
    float settle;      // share of the way to rest that a brim goes in a step
    float reach;       // of a cap's height: how near another skin takes a drop over
    uint number;       // of this step, from 1
    uint everywhere;   // 1: flow/drive is needed at every place
};
STRUCT(FlowBirth) {
    vec4 velocity;  // m/s, along the triangle; w: 1 part of a film, 0 a drop
    uint triangle;
    float b1;  // barycentric, of corners 1 and 2
    float b2;
    uint volume;  // picolitres
};
STRUCT(FlowLeft) {
    vec4 position;  // m; w: the slot it had
    vec4 velocity;  // m/s
    uint volume;    // picolitres
    uint triangle;  // the last one
    uint spare0;
    uint spare1;
};
CONSTANT(uint, MOST_LEFT, 256u);  // in a step; the others wait for the next
CONSTANT(uint, FLOW_COUNTERS, 8u);  // see born, merge, leave, dry
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
#include "shaders/common/lang_end.h"
#endif
