#include "fluid/scene/solids_bullet_approach.h"

#include <algorithm>

#include "fluid/scene/bullet.h"

namespace rivulet {

namespace {

struct Nearest : btDiscreteCollisionDetectorInterface::Result {
    void setShapeIdentifiersA(int, int) override {}
    void setShapeIdentifiersB(int, int) override {}
    void addContactPoint(const btVector3& normalOnB, const btVector3& point, btScalar depth) override {
        found = true;
        normal = normalOnB;
        onB = point;
        distance = depth;
    }
    bool found = false;
    btVector3 normal{0, 0, 0}, onB{0, 0, 0};
    btScalar distance = 0;
};

// Nothing where they overlap.
std::optional<Approach> nearestAt(const MovingShape& a, const MovingShape& b, btScalar time) {
    btVoronoiSimplexSolver simplex;
    btGjkPairDetector detector(a.shape, b.shape, &simplex, nullptr);
    btGjkPairDetector::ClosestPointInput input;
    input.m_transformA = a.motion.in(time)*a.place;
    input.m_transformB = b.motion.in(time)*b.place;
    Nearest nearest;
    detector.getClosestPoints(input, nearest, nullptr);
    if (!nearest.found) return {};
    return Approach{time, nearest.onB + nearest.distance * nearest.normal, nearest.onB, nearest.normal, nearest.distance};
}

}  // namespace

btTransform FrameMotion::in(btScalar time) const {
    time = std::min(time, seconds);
    const btScalar angle = spin.length() * time;
    const btQuaternion turn = angle > 0 ? btQuaternion(spin.normalized(), angle) : btQuaternion::getIdentity();
    const btMatrix3x3 basis(turn);
    return btTransform(basis, centre + velocity * time - basis * centre);
}

btVector3 FrameMotion::velocityAt(const btVector3& p) const { return velocity + spin.cross(p - centre); }

std::optional<Approach> nearestApproach(const MovingShape& a, const MovingShape& b, btScalar seconds, btScalar touching) {
    const auto closing = [&](const Approach& at) {
        const auto velocity = [&](const FrameMotion& m, const btVector3& p) {
            if (at.time >= m.seconds) return btVector3(0, 0, 0);
            return m.velocity + m.spin.cross(p - m.centre - m.velocity * at.time);
        };
        return at.normal.dot(velocity(b.motion, at.onB) - velocity(a.motion, at.onA));
    };
    std::optional<Approach> low = nearestAt(a, b, 0);
    if (!low || low->distance <= touching) return {};
    if (closing(*low) * seconds <= touching) return low;
    // Without rotation the distance is a convex function of time: from its tangent they touch no earlier than they do. `high`: they part
    // or overlap there.
    constexpr int kMost = 16;
    constexpr btScalar kFine = 1.0e-3F;  // of the frame
    btScalar high = seconds;
    bool within = false;  // high is
    for (int k = 0; k < kMost && low->distance > touching && high - low->time > kFine * seconds; ++k) {
        const btScalar speed = closing(*low);
        const btScalar touch = speed > 0 ? low->time + low->distance / speed : high;
        btScalar next = std::min(touch, high);
        if (within && (next >= high || k > kMost / 2)) next = 0.5F * (low->time + high);
        const std::optional<Approach> at = nearestAt(a, b, next);
        if (at && closing(*at) > 0) {
            low = at;
            if (next >= seconds) break;
        } else {
            high = next;
            within = true;
        }
    }
    return low;
}

}  // namespace rivulet
