// Where two convex shapes come nearest to each other in a frame in which both move. A contact found there does not hold up what only passes
// by: the plane between the two lies along their way.
#pragma once

#include <optional>

#include "fluid/scene/bullet.h"

namespace rivulet {

// Of a rigid body in a frame: it keeps its velocities for `seconds`, then it rests.
struct FrameMotion {
    btVector3 centre{0, 0, 0};                   // m, in the world when the frame begins
    btVector3 velocity{0, 0, 0}, spin{0, 0, 0};  // m/s, of the centre; rad/s
    btScalar seconds = 0;
    btTransform in(btScalar time) const;             // moves what is where it was when the frame began
    btVector3 velocityAt(const btVector3& p) const;  // m/s; `p`: m, in the world, while it moves
};

struct MovingShape {
    const btConvexShape* shape;
    btTransform place;  // when the frame begins
    FrameMotion motion;
};

// The points of two surfaces that are nearest to each other at `time` (s): m, in the world then; normal: unit, from b to a.
struct Approach {
    btScalar time = 0;
    btVector3 onA{0, 0, 0}, onB{0, 0, 0}, normal{0, 0, 0};
    btScalar distance = 0;  // m
};

// Of the times from 0 to `seconds`: when the shapes are nearest, or are about to touch (nearer than `touching`, m). Nothing if they touch
// or overlap when the frame begins, or do not come nearer by more than `touching`.
std::optional<Approach> nearestApproach(const MovingShape& a, const MovingShape& b, btScalar seconds, btScalar touching);

}  // namespace rivulet
