#include "fluid/scene/solids_bullet_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "fluid/scene/bullet.h"
#include "fluid/scene/solids_bullet_approach.h"
#include "fluid/sim/solids/body_contacts.h"

namespace rivulet {

namespace {

constexpr size_t kMostOfPair = 8;
constexpr float kNear = 0.02F;        // of a body's size: it may touch what is so near, however little it moves
constexpr float kBand = 0.15F;        // of a body's size, beside what it moves in the frame: so near its parts are looked at
constexpr float kSame = 1.0e-3F;      // of a body's size: points that are so near are one
constexpr float kFlat = 5.0e-3F;      // of a body's size: a corner that stands out by less is none
constexpr float kSlow = 0.01F;        // of a body's size: what moves less in a frame passes by nothing
constexpr float kSpare = 2;           // times as fast as expected may it move
constexpr float kTouching = 2.0e-3F;  // of a body's size: so near two that meet are looked at
constexpr float kAlike = 0.99999F;    // cosine: normals of one plane
constexpr float kWrong = 0.02F;       // of a body's size: more than what is reported, they do not overlap along the reported direction
constexpr float kOfFace = 0.9F;       // cosine between the normals of a triangle and of a point of it where a body overlaps it

// Of a contact, in the world when the frame begins: the points of both surfaces, the normal towards a, and the distance (negative where
// they overlap).
struct Touch {
    vec3 onA, onB, normal;
    float distance;
};

// Of two objects in a frame.
struct Motions {
    FrameMotion a, b;
    float seconds = 0;             // of the frame
    float size = 0;                // m, of the smaller
    float reachA = 0, reachB = 0;  // m, from the centres
    bool fast(float most) const {  // they move by more than `most` (m) against each other
        const btScalar turning = a.spin.length() * reachA + b.spin.length() * reachB;
        return ((a.velocity - b.velocity).length() + turning) * seconds > most;
    }
    // A touch found at `time`, where its points and its normal were when the frame began.
    Touch back(const Touch& t, float time) const {
        const btTransform toA = a.in(time).inverse(), toB = b.in(time).inverse();
        Touch then{fromBullet(toA * toBullet(t.onA)), fromBullet(toB * toBullet(t.onB)), fromBullet(toB.getBasis() * toBullet(t.normal)),
                   0};
        then.distance = glm::dot(then.onA - then.onB, then.normal);
        return then;
    }
};

// The faces of a shape; null where it has none.
const btConvexPolyhedron* facesOf(const btCollisionObjectWrapper& of) {
    const btCollisionShape& shape = *of.getCollisionShape();
    if (!shape.isPolyhedral() || shape.getShapeType() == TRIANGLE_SHAPE_PROXYTYPE) return nullptr;
    return static_cast<const btPolyhedralConvexShape&>(shape).getConvexPolyhedron();
}
// m, of its surface beyond its faces.
float marginOf(const btCollisionObjectWrapper& of) {
    const btCollisionShape& shape = *of.getCollisionShape();
    return shape.getShapeType() == BOX_SHAPE_PROXYTYPE ? 0 : shape.getMargin();  // the corners of a box have it
}

// How far two shapes with faces are apart along a unit vector from b to a (m, negative where they overlap), and where a is nearest to b.
struct Apart {
    float distance = -std::numeric_limits<float>::infinity();
    btVector3 direction{0, 1, 0}, onA{0, 0, 0};
};
Apart apartAlong(const btVector3& direction, const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b) {
    btScalar lowA = 0, highA = 0, lowB = 0, highB = 0;
    btVector3 nearest, lowest, farthest, highest;
    facesOf(a)->project(a.getWorldTransform(), direction, lowA, highA, nearest, farthest);
    facesOf(b)->project(b.getWorldTransform(), direction, lowB, highB, lowest, highest);
    return {lowA - highB - marginOf(a) - marginOf(b), direction, nearest - marginOf(a) * direction};
}
// Along the normal of a face along which they overlap least.
Apart apartByFaces(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b) {
    Apart best;
    for (const auto& [of, sign] : {std::pair(&a, -1.0F), std::pair(&b, 1.0F)}) {
        const btConvexPolyhedron& faces = *facesOf(*of);
        for (int k = 0; k < faces.m_faces.size(); ++k) {
            const btScalar* plane = faces.m_faces[k].m_plane;
            const btVector3 outward = of->getWorldTransform().getBasis() * btVector3(plane[0], plane[1], plane[2]);
            if (const Apart apart = apartAlong(sign * outward.normalized(), a, b); apart.distance > best.distance) best = apart;
        }
    }
    return best;
}

// Faces of two shapes, clipped against each other. Bullet itself clips only shapes that overlap; of others it reports one point.
class Clipped : public btDiscreteCollisionDetectorInterface::Result {
  public:
    // Nothing where a shape has no faces. `normal`: unit, from b to a.
    static void add(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b, const btVector3& normal, float within,
                    std::vector<Touch>& touches) {
        const btConvexPolyhedron *one = facesOf(a), *other = facesOf(b);
        if (one == nullptr) return;
        // The face of a that looks at b.
        btScalar least = 1;
        for (int k = 0; k < one->m_faces.size(); ++k) {
            const btScalar* plane = one->m_faces[k].m_plane;
            least = std::min(least, normal.dot(a.getWorldTransform().getBasis() * btVector3(plane[0], plane[1], plane[2])));
        }
        constexpr btScalar kFacing = -0.7F;  // else it is an edge or a corner that is nearest
        if (!(least < kFacing)) return;
        const float margins = marginOf(a) + marginOf(b);
        Clipped result(-least, marginOf(a), marginOf(b), touches);
        btVertexArray some, more;
        if (other != nullptr) {
            btPolyhedralContactClipping::clipHullAgainstHull(normal, *one, *other, a.getWorldTransform(), b.getWorldTransform(),
                                                             -SIMD_INFINITY, within + margins, some, more, result);
        } else if (b.getCollisionShape()->getShapeType() == TRIANGLE_SHAPE_PROXYTYPE) {
            const auto& triangle = static_cast<const btTriangleShape&>(*b.getCollisionShape());
            for (const btVector3& corner : triangle.m_vertices1) some.push_back(b.getWorldTransform() * corner);
            btPolyhedralContactClipping::clipFaceAgainstHull(normal, *one, a.getWorldTransform(), some, more, -SIMD_INFINITY,
                                                             within + margins, result);
        }
    }
    void setShapeIdentifiersA(int, int) override {}
    void setShapeIdentifiersB(int, int) override {}
    void addContactPoint(const btVector3& normal, const btVector3& point, btScalar depth) override {
        const vec3 n = fromBullet(normal), on = fromBullet(point);
        const float distance = depth / cosine_;  // along the normal, and not to the face's plane
        touches_->push_back({on + (distance - marginA_) * n, on + marginB_ * n, n, distance - marginA_ - marginB_});
    }

  private:
    Clipped(float cosine, float marginA, float marginB, std::vector<Touch>& touches)
        : cosine_(cosine), marginA_(marginA), marginB_(marginB), touches_(&touches) {}
    float cosine_, marginA_, marginB_;
    std::vector<Touch>* touches_;
};

// Points that Bullet finds up to a distance. The two shapes may be exchanged in what it reports.
class Closest : public btCollisionWorld::ContactResultCallback {
  public:
    Closest(const btCollisionObject& a, bool ball, float within, const Motions& motions, std::vector<Touch>& touches)
        : a_(&a),
          ball_(ball),
          parts_(a.getCollisionShape()->isCompound()),
          fast_(motions.fast(kSlow * motions.size)),
          motions_(&motions),
          touches_(&touches) {
        m_closestDistanceThreshold = within;
    }
    btScalar addSingleResult(btManifoldPoint& p, const btCollisionObjectWrapper* first, int, int part,
                             const btCollisionObjectWrapper* second, int, int otherPart) override {
        if (p.m_distance1 > m_closestDistanceThreshold) return 0;
        const vec3 one = fromBullet(p.m_positionWorldOnA), other = fromBullet(p.m_positionWorldOnB), n = fromBullet(p.m_normalWorldOnB);
        if (!(glm::dot(n, n) > 0.5F)) return 0;
        const bool same = first->getCollisionObject() == a_;
        const btCollisionObjectWrapper &of = same ? *first : *second, &by = same ? *second : *first;
        const btVector3 direction = same ? p.m_normalWorldOnB : -p.m_normalWorldOnB;
        const Parts parts{of.getCollisionShape(), by.getCollisionShape(), part, otherPart};
        const bool again = std::exchange(last_, parts) == parts;  // those are clipped
        if (again && passes_) return 0;
        passes_ = fast_ && p.m_distance1 > 0 &&
                  mayBeReached(same ? p.m_positionWorldOnA : p.m_positionWorldOnB, direction, p.m_distance1) && addApproach(of, by);
        if (passes_) return 0;
        // Where they overlap, Bullet knows no direction out of a flat triangle: the corners do.
        if (!ball_ && p.m_distance1 < 0 && std::abs(glm::dot(n, normalOf(by, n))) < kOfFace) return 0;
        // Of two faces that overlap a little, Bullet now and then reports a direction along which they overlap by their length, and then
        // points of other faces.
        if (!again)
            wrong_ = facesOf(of) != nullptr && facesOf(by) != nullptr &&
                     apartAlong(direction, of, by).distance < p.m_distance1 - kWrong * of.getCollisionShape()->getAngularMotionDisc();
        if (wrong_ && again) return 0;
        if (wrong_) {
            const Apart apart = apartByFaces(of, by);
            const vec3 on = fromBullet(apart.onA), along = fromBullet(apart.direction);
            touches_->push_back({on, on - apart.distance * along, along, apart.distance});
            Clipped::add(of, by, apart.direction, m_closestDistanceThreshold, *touches_);
            return 0;
        }
        touches_->push_back({same ? one : other, same ? other : one, fromBullet(direction), p.m_distance1});
        if (!parts_ && !again) Clipped::add(of, by, direction, m_closestDistanceThreshold, *touches_);
        return 0;
    }

  private:
    // Whether the body may come to the plane of a contact in the frame; else it bars no way. `normal`: from b to a.
    bool mayBeReached(const btVector3& onA, const btVector3& normal, btScalar distance) const {
        const btVector3 onB = onA - distance * normal;
        const btScalar closing = normal.dot(motions_->b.velocityAt(onB) - motions_->a.velocityAt(onA));
        return kSpare * closing * motions_->seconds > distance;
    }
    // Two parts that move fast are in contact as they are when they are nearest. False: they touch when the frame begins.
    bool addApproach(const btCollisionObjectWrapper& of, const btCollisionObjectWrapper& by) {
        const btCollisionShape &one = *of.getCollisionShape(), &other = *by.getCollisionShape();
        if (!one.isConvex() || !other.isConvex()) return false;
        const MovingShape a{static_cast<const btConvexShape*>(&one), of.getWorldTransform(), motions_->a};
        const MovingShape b{static_cast<const btConvexShape*>(&other), by.getWorldTransform(), motions_->b};
        const std::optional<Approach> at = nearestApproach(a, b, motions_->seconds, kTouching * motions_->size);
        if (!at) return false;
        std::vector<Touch> then = {{fromBullet(at->onA), fromBullet(at->onB), fromBullet(at->normal), at->distance}};
        const btTransform ofThen = a.motion.in(at->time) * a.place, byThen = b.motion.in(at->time) * b.place;
        const btCollisionObjectWrapper movedOf(&of, &one, of.getCollisionObject(), ofThen, of.m_partId, of.m_index);
        const btCollisionObjectWrapper movedBy(&by, &other, by.getCollisionObject(), byThen, by.m_partId, by.m_index);
        if (!parts_) Clipped::add(movedOf, movedBy, at->normal, m_closestDistanceThreshold, then);
        bool some = false;
        for (const Touch& t : then) {
            const Touch now = motions_->back(t, at->time);
            if (!(now.distance >= 0)) continue;  // it turns out of the way
            touches_->push_back(now);
            some = true;
        }
        return some;
    }
    // Of a triangle; of another shape `other`.
    static vec3 normalOf(const btCollisionObjectWrapper& of, const vec3& other) {
        if (of.getCollisionShape()->getShapeType() != TRIANGLE_SHAPE_PROXYTYPE) return other;
        btVector3 normal;
        static_cast<const btTriangleShape&>(*of.getCollisionShape()).calcNormal(normal);
        return fromBullet(of.getWorldTransform().getBasis() * normal);
    }
    struct Parts {
        const btCollisionShape *first = nullptr, *second = nullptr;
        int part = 0, otherPart = 0;
        bool operator==(const Parts&) const = default;
    };
    Parts last_;
    bool wrong_ = false;   // what is reported of them
    bool passes_ = false;  // addApproach has added them
    const btCollisionObject* a_;
    bool ball_, parts_;  // it has parts: a point of each will do
    bool fast_;
    const Motions* motions_;
    std::vector<Touch>* touches_;
};

// Corners above, or a little below, the triangles of a mesh: those that the body turns into the mesh later in the frame. What is above is
// where its centre of mass is. A corner that comes nearer is looked at where it meets the triangle's plane.
class CornersOnMesh : public btTriangleCallback {
  public:
    CornersOnMesh(const btTransform& mesh, std::span<const vec3> corners, const vec3& middle, float within, const Motions& motions,
                  std::vector<Touch>& touches)
        : mesh_(mesh), corners_(corners), middle_(middle), within_(within), motions_(&motions), touches_(&touches) {}
    void processTriangle(btVector3* triangle, int, int) override {
        const vec3 a = fromBullet(mesh_ * triangle[0]), b = fromBullet(mesh_ * triangle[1]), c = fromBullet(mesh_ * triangle[2]);
        vec3 n = glm::cross(b - a, c - a);
        const float area = glm::length(n);
        if (!(area > 0)) return;
        n /= area;
        if (glm::dot(n, middle_ - a) < 0) n = -n;
        for (const vec3& p : corners_) {
            const float distance = glm::dot(n, p - a);
            if (std::abs(distance) > within_) continue;
            const vec3 on = p - distance * n;
            const auto holds = [&](const vec3& place) {
                const auto leftOf = [&](const vec3& from, const vec3& to) { return glm::dot(glm::cross(to - from, place - from), n); };
                const float x = leftOf(a, b), y = leftOf(b, c), z = leftOf(c, a);
                return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
            };
            vec3 meets = on;
            const vec3 speed = fromBullet(motions_->a.velocityAt(toBullet(p)) - motions_->b.velocityAt(toBullet(on)));
            const float closing = -glm::dot(speed, n);
            if (distance > kTouching * motions_->size && closing > 0)
                meets += std::min(distance / closing, motions_->seconds) * (speed + closing * n);
            if (holds(meets)) touches_->push_back({p, on, n, distance});
        }
    }

  private:
    btTransform mesh_;
    std::span<const vec3> corners_;
    vec3 middle_;
    float within_;
    const Motions* motions_;
    std::vector<Touch>* touches_;
};

// Leaves out contacts that others make unnecessary: one of two that are in the same place, and those of a surface behind the plane of a
// nearer contact. Such are the edges between a floor's triangles: their normals are slanted, and would stop a body that slides or rolls.
// Of a ball one contact with a plane is enough.
void filter(std::vector<Touch>& touches, float size, bool ball) {
    std::ranges::stable_sort(touches, {}, &Touch::distance);
    std::vector<Touch> kept;
    kept.reserve(touches.size());
    const float same = kSame * size;
    for (const Touch& c : touches) {
        const bool implied = std::ranges::any_of(kept, [&](const Touch& k) {
            if (!ball && glm::dot(c.normal, k.normal) > kAlike) return glm::length(c.onA - k.onA) < same;
            return glm::dot(k.normal, c.onB - k.onB) <= same && glm::dot(k.normal, c.onA - k.onB) >= std::min(k.distance, 0.0F) - same;
        });
        if (!implied) kept.push_back(c);
    }
    touches = std::move(kept);
}

// Of touches with one normal, those at the corners of what they span: the same from frame to frame, as what lies between them is not.
void leaveOutline(std::vector<Touch>& touches, float size) {
    std::vector<Touch> kept;
    kept.reserve(touches.size());
    std::vector<bool> done(touches.size());
    for (size_t first = 0; first < touches.size(); ++first) {
        if (done[first]) continue;
        std::vector<Touch> alike;
        std::vector<vec3> places;
        std::vector<float> separations;
        for (size_t k = first; k < touches.size(); ++k) {
            if (done[k] || !(glm::dot(touches[k].normal, touches[first].normal) > kAlike)) continue;
            done[k] = true;
            alike.push_back(touches[k]);
            places.push_back(touches[k].onB);
            separations.push_back(touches[k].distance);
        }
        for (const size_t k : outlineOf(places, separations, touches[first].normal, kFlat * size)) kept.push_back(alike[k]);
    }
    touches = std::move(kept);
}

// One search: the bodies where they are expected, and how far they may come.
class Search {
  public:
    Search(btCollisionWorld& world, std::span<const ContactBody> bodies, std::span<const BodyState> states, std::span<const vec4> balls,
           double seconds, std::vector<BodyContact>& found)
        : world_(&world), bodies_(bodies), states_(states), balls_(balls), seconds_(static_cast<float>(seconds)), found_(&found) {
        size_.reserve(bodies.size());
        allowed_.reserve(bodies.size());
        for (size_t k = 0; k < bodies.size(); ++k) {
            for (btCollisionObject* object : {bodies[k].object, bodies[k].hull}) object->setWorldTransform(toBullet(states[k].pose));
            const float size = bodies[k].object->getCollisionShape()->getAngularMotionDisc();
            const float turned = bodies[k].corners.empty() ? 0 : size * std::min(glm::length(states[k].spin) * seconds_, 1.0F);
            size_.push_back(size);
            allowed_.push_back(glm::length(states[k].pose.position - vec3(balls[k])) + balls[k].w + turned + kNear * size);
        }
    }
    void meet(size_t a, const ContactSolid& solid) {
        const btCollisionShape& shape = *solid.object->getCollisionShape();
        const float speed = glm::length(solid.velocity);
        std::vector<Touch> touches;
        if (shape.getShapeType() == STATIC_PLANE_PROXYTYPE) {
            onPlane(a, static_cast<const btStaticPlaneShape&>(shape), touches);
        } else {
            btVector3 low, high;
            shape.getAabb(solid.object->getWorldTransform(), low, high);
            const vec3 middle = 0.5F * (fromBullet(low) + fromBullet(high));
            const float reach = 0.5F * glm::length(fromBullet(high) - fromBullet(low));
            const float way = (speed + glm::length(solid.spin) * (reach + glm::length(middle - originOf(solid)))) * seconds_;
            const vec3 centre(balls_[a]), nearest = glm::clamp(centre, fromBullet(low), fromBullet(high));
            if (glm::length(centre - nearest) > balls_[a].w + (1 + kNear) * size_[a] + way) return;
            const float near = kBand * size_[a] + (glm::length(states_[a].velocity) * seconds_) + way;
            const Motions motions{motionOf(a), motionOf(solid), seconds_,
                                  size_[a],    size_[a],        reach + glm::length(middle - originOf(solid))};
            touches = between(bodies_[a], *solid.object, *solid.object, near, allowed_[a] + way, motions);
            if (!bodies_[a].corners.empty()) onMesh(a, *solid.object, allowed_[a] + way, motions, touches);
        }
        const btCollisionObject& of = *bodies_[a].object;
        filter(touches, size_[a], bodies_[a].ball.w > 0);
        if (!(bodies_[a].ball.w > 0)) leaveOutline(touches, size_[a]);
        for (const size_t k : chosen(touches)) {
            const Touch& t = touches[k];
            BodyContact c = contact(a, t);
            c.onB = t.onB;
            c.normal = t.normal;
            c.velocityB = solid.velocity;
            c.spinB = solid.spin;
            c.centreB = originOf(solid);
            c.secondsB = static_cast<float>(solid.seconds);
            c.friction = of.getFriction() * solid.object->getFriction();
            c.restitution = of.getRestitution() * solid.object->getRestitution();
            found_->push_back(c);
        }
    }
    // Those whose balls may come near each other, the first before the second: by a sweep along the axis along which they lie farthest
    // apart.
    std::vector<std::pair<size_t, size_t>> nearPairs() const {
        const size_t count = bodies_.size();
        Bounds all;
        for (const vec4& ball : balls_) all.add(vec3(ball));
        const vec3 size = all.size();
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const auto reachOf = [&](size_t k) { return balls_[k].w + (1 + kNear) * size_[k]; };
        std::vector<size_t> order(count);
        std::iota(order.begin(), order.end(), size_t{0});
        std::ranges::sort(order, {}, [&](size_t k) { return balls_[k][axis] - reachOf(k); });
        std::vector<std::pair<size_t, size_t>> pairs;
        std::vector<size_t> open;  // that reach as far as the sweep is
        open.reserve(count);
        for (const size_t k : order) {
            const float low = balls_[k][axis] - reachOf(k);
            std::erase_if(open, [&](size_t other) { return balls_[other][axis] + reachOf(other) < low; });
            for (const size_t other : open)
                if (glm::length(vec3(balls_[k]) - vec3(balls_[other])) <= reachOf(k) + reachOf(other))
                    pairs.emplace_back(std::min(k, other), std::max(k, other));
            open.push_back(k);
        }
        std::ranges::sort(pairs);
        return pairs;
    }
    // Two of nearPairs; `a` moves.
    void meet(size_t a, size_t b) {
        if (bodies_[a].ball.w <= 0 && bodies_[b].ball.w > 0 && bodies_[b].moves) std::swap(a, b);  // the ball first
        const float near = kBand * std::min(size_[a], size_[b]) + glm::length(states_[a].velocity - states_[b].velocity) * seconds_;
        const Motions motions{motionOf(a), motionOf(b), seconds_, std::min(size_[a], size_[b]), size_[a], size_[b]};
        std::vector<Touch> touches = between(bodies_[a], *bodies_[b].hull, *bodies_[b].object, near, allowed_[a] + allowed_[b], motions);
        filter(touches, std::min(size_[a], size_[b]), bodies_[a].ball.w > 0);
        if (!(bodies_[a].ball.w > 0)) leaveOutline(touches, std::min(size_[a], size_[b]));
        const btCollisionObject &one = *bodies_[a].object, &other = *bodies_[b].object;
        for (const size_t k : chosen(touches)) {
            const Touch& t = touches[k];
            BodyContact c = contact(a, t);
            c.b = static_cast<uint32_t>(b);
            c.onB = states_[b].pose.toOwn(t.onB);
            if (bodies_[b].ball.w > 0) {
                c.onB = vec3(bodies_[b].ball);
                c.radiusB = bodies_[b].ball.w;
            }
            c.normal = glm::conjugate(states_[b].pose.rotation) * t.normal;
            c.friction = one.getFriction() * other.getFriction();
            c.restitution = one.getRestitution() * other.getRestitution();
            found_->push_back(c);
        }
    }

  private:
    // What Bullet finds between a body and another or a solid, up to `most` (m) apart. Bodies of many parts are compared as their hulls,
    // and by their parts where these are nearer than `near`.
    std::vector<Touch> between(const ContactBody& a, btCollisionObject& hull, btCollisionObject& other, float near, float most,
                               const Motions& motions) const {
        const auto search = [&](btCollisionObject* one, btCollisionObject* two, float within) {
            std::vector<Touch> touches;
            Closest closest(*one, a.ball.w > 0, within, motions, touches);
            world_->contactPairTest(one, two, closest);
            return touches;
        };
        std::vector<Touch> touches = search(a.hull, &hull, most);
        const bool parts = a.hull != a.object || &hull != &other;
        if (parts && std::ranges::any_of(touches, [&](const Touch& t) { return t.distance < near; })) return search(a.object, &other, near);
        return touches;
    }
    // A ball does not turn: its surface stays where it is.
    FrameMotion motionOf(size_t k) const {
        const BodyState& s = states_[k];
        if (!bodies_[k].moves) return {};
        if (!(bodies_[k].ball.w > 0)) return {toBullet(s.pose.position), toBullet(s.velocity), toBullet(s.spin), seconds_};
        const vec3 centre = s.pose.toWorld(vec3(bodies_[k].ball));
        return {toBullet(centre), toBullet(s.velocityAt(centre)), btVector3(0, 0, 0), seconds_};
    }
    static FrameMotion motionOf(const ContactSolid& s) {
        return {toBullet(originOf(s)), toBullet(s.velocity), toBullet(s.spin), static_cast<btScalar>(s.seconds)};
    }
    static vec3 originOf(const ContactSolid& solid) { return fromBullet(solid.object->getWorldTransform().getOrigin()); }
    BodyContact contact(size_t a, const Touch& t) const {
        BodyContact c;
        c.a = static_cast<uint32_t>(a);
        c.onA = states_[a].pose.toOwn(t.onA);
        if (bodies_[a].ball.w > 0) {
            c.onA = vec3(bodies_[a].ball);
            c.radiusA = bodies_[a].ball.w;
        }
        return c;
    }
    static std::vector<size_t> chosen(std::span<const Touch> touches) {
        std::vector<vec3> places;
        std::vector<float> separations;
        places.reserve(touches.size());
        separations.reserve(touches.size());
        for (const Touch& t : touches) {
            places.push_back(t.onB);
            separations.push_back(t.distance);
        }
        return spreadOf(places, separations, kMostOfPair);
    }
    void onPlane(size_t a, const btStaticPlaneShape& plane, std::vector<Touch>& touches) const {
        const vec3 n = fromBullet(plane.getPlaneNormal());
        const float constant = plane.getPlaneConstant(), within = allowed_[a];
        if (glm::dot(n, vec3(balls_[a])) - constant > balls_[a].w + (1 + kNear) * size_[a]) return;
        const auto add = [&](const vec3& p) {
            const float distance = glm::dot(n, p) - constant;
            if (distance <= within) touches.push_back({p, p - distance * n, n, distance});
        };
        if (bodies_[a].ball.w > 0) add(states_[a].pose.toWorld(vec3(bodies_[a].ball)) - bodies_[a].ball.w * n);
        for (const btVector3& corner : bodies_[a].corners) add(states_[a].pose.toWorld(fromBullet(corner)));
    }
    void onMesh(size_t a, const btCollisionObject& mesh, float within, const Motions& motions, std::vector<Touch>& touches) const {
        std::vector<vec3> corners;
        corners.reserve(bodies_[a].corners.size());
        for (const btVector3& corner : bodies_[a].corners) corners.push_back(states_[a].pose.toWorld(fromBullet(corner)));
        CornersOnMesh callback(mesh.getWorldTransform(), corners, states_[a].pose.position, within, motions, touches);
        btVector3 low, high;
        const btTransform own = mesh.getWorldTransform().inverse() * bodies_[a].object->getWorldTransform();
        bodies_[a].object->getCollisionShape()->getAabb(own, low, high);
        const btVector3 around(within, within, within);
        static_cast<const btBvhTriangleMeshShape&>(*mesh.getCollisionShape()).processAllTriangles(&callback, low - around, high + around);
    }
    btCollisionWorld* world_;
    std::span<const ContactBody> bodies_;
    std::span<const BodyState> states_;
    std::span<const vec4> balls_;
    float seconds_;
    std::vector<BodyContact>* found_;
    std::vector<float> size_, allowed_;  // m, of each body: about its centre of mass; how far its surface may move until the frame's end
};

}  // namespace

void findContacts(btCollisionWorld& world, std::span<const ContactBody> bodies, std::span<const ContactSolid> solids,
                  std::span<const BodyState> states, std::span<const vec4> balls, double seconds, std::vector<BodyContact>& found) {
    Search search(world, bodies, states, balls, seconds, found);
    for (size_t a = 0; a < bodies.size(); ++a) {
        if (!bodies[a].moves) continue;
        const LayersParams layers = layersOf(*bodies[a].object);
        for (const ContactSolid& solid : solids)
            if (const LayersParams own = layersOf(*solid.object); own == kBoxLayers || own.meet(layers)) search.meet(a, solid);
    }
    for (const auto& [a, b] : search.nearPairs())
        if ((bodies[a].moves || bodies[b].moves) && layersOf(*bodies[a].object).meet(layersOf(*bodies[b].object)))
            search.meet(bodies[a].moves ? a : b, bodies[a].moves ? b : a);
}

}  // namespace rivulet
