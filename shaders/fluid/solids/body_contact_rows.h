// Contacts of rigid bodies as the host gives them, and what advance_touching stores of each.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
CONSTANT(uint, MOST_TOUCHING, 384u);  // bodies that may touch something in a frame: 24 of the 32 KiB of work-group memory that every GPU has
CONSTANT(uint, TOUCHING_GROUP, 64u);  // work items of advance_touching
CONSTANT(uint, NO_CONTACT, 0xffffffffu);
STRUCT(ContactPair) {
    uint a;      // slot of BodyMotion
    uint b;      // the same, or NO_SLOT: a wall or solid
    uint first;  // its contacts: from first to before end
    uint end;
    uint bodyA;  // places among the bodies
    uint bodyB;
    uint padding0;
    uint padding1;
};
// See BodyContact.
STRUCT(ContactRow) {
    vec4 onA;       // m, in the frame of a; w: the radius about it
    vec4 onB;       // m, in the frame of b; of a solid in the world, at the frame's begin; w: the radius about it
    vec4 normal;    // unit, from b to a, in the frame of b (of a where b is a ball); of a solid in the world; w: Coulomb friction
    vec4 velocity;  // m/s, of the solid's centre; w: restitution
    vec4 centre;    // m, of a solid, at the frame's begin; w: s, of the frame in which it moves
    vec4 spin;      // rad/s, of a solid about it
    uint before;    // its row in the frame before, or NO_CONTACT
    uint before1;   // more of them, of which it takes the impulses: those that no other has
    uint before2;
    uint before3;
};
STRUCT(ContactState) {
    vec4 impulse;  // N s, of this substep: x along the normal, y and z along the tangents
    vec4 armA;     // m, from the centre of mass of a; w: m/s, the speed at which the surfaces meet; then that at which they are to part, 0: they do not bounce
    vec4 armB;     // m; w: m, the separation, negative where they overlap
    vec4 normal;   // in the world; w: kg, effective mass along it
    vec4 along;    // a tangent; w: kg
    vec4 across;   // the other; w: kg
    vec4 turnA;    // rad/s, of a, for an impulse of 1 N s along the normal, and so on
    vec4 turnB;
    vec4 alongA;
    vec4 alongB;
    vec4 acrossA;
    vec4 acrossB;
    vec4 velocity;  // m/s, of a solid's point
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(ContactPair) == 32 && sizeof(ContactRow) == 112 && sizeof(ContactState) == 208);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
