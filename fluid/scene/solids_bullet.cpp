#include "fluid/scene/solids_bullet.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>

#include "engine/core/assert.h"
#include "fluid/scene/bullet.h"
#include "fluid/scene/solids_bullet_contacts.h"
#include "shaders/fluid/solids/body_pull.h"

namespace rivulet {

namespace {

btVector3 to(const vec3& v) { return toBullet(v); }
btVector3 to(const dvec3& v) { return to(vec3(v)); }
vec3 from(const btVector3& v) { return fromBullet(v); }
btTransform to(const Pose& p) { return toBullet(p); }
Pose from(const btTransform& t) {
    const btQuaternion q = t.getRotation();
    return {from(t.getOrigin()), glm::normalize(quat(q.w(), q.x(), q.y(), q.z()))};
}

// Bullet's own margin, 4 cm, is as large as many a body here.
constexpr float kMargin = 0.02F;  // of the smallest side
float marginOf(const vec3& size) { return kMargin * std::min({size.x, size.y, size.z}); }

// Contacts of a body with a plane: its corners, which its user pointer has, below or near it. Bullet's own algorithm finds one a step,
// and each box of a mesh meets every plane, however far it is.
using Corners = std::vector<btVector3>;
void touchPlane(const btCollisionObject& plane, const btCollisionObject& body, btCollisionDispatcher& dispatcher) {
    const auto& shape = static_cast<const btStaticPlaneShape&>(*plane.getCollisionShape());  // in the world: see addStill
    const btVector3& n = shape.getPlaneNormal();
    const btVector3 &low = body.getBroadphaseHandle()->m_aabbMin, &high = body.getBroadphaseHandle()->m_aabbMax;
    if (n.dot(btVector3(n.x() > 0 ? low.x() : high.x(), n.y() > 0 ? low.y() : high.y(), n.z() > 0 ? low.z() : high.z())) >
        shape.getPlaneConstant())
        return;
    const btCollisionObjectWrapper on(nullptr, plane.getCollisionShape(), &plane, plane.getWorldTransform(), -1, -1),
        of(nullptr, body.getCollisionShape(), &body, body.getWorldTransform(), -1, -1);
    btManifoldResult result(&of, &on);
    result.setPersistentManifold(dispatcher.getNewManifold(&body, &plane));
    for (const btVector3& corner : *static_cast<const Corners*>(body.getUserPointer())) {
        const btVector3 p = body.getWorldTransform() * corner;
        const btScalar distance = n.dot(p) - shape.getPlaneConstant();
        result.addContactPoint(n, p - n * distance, distance);
    }
}

void setLayers(btCollisionObject& object, const LayersParams& layers) {
    object.setUserIndex(layers.layers);
    object.setUserIndex2(layers.meets);
}

void meet(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info) {
    const auto& a = *static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject);
    const auto& b = *static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject);
    const bool ofBox = layersOf(a) == kBoxLayers || layersOf(b) == kBoxLayers;
    if (!ofBox && !layersOf(a).meet(layersOf(b))) return;
    for (const auto& [plane, body] : {std::pair(&a, &b), std::pair(&b, &a)})
        if (plane->getCollisionShape()->getShapeType() == STATIC_PLANE_PROXYTYPE && body->getUserPointer() != nullptr)
            return touchPlane(*plane, *body, dispatcher);
    btCollisionDispatcher::defaultNearCallback(pair, dispatcher, info);
}

}  // namespace

std::vector<std::pair<vec3, vec3>> cellsOf(const BodyShape& shape, const Bounds& bounds, int across) {
    std::vector<std::pair<vec3, vec3>> boxes;
    const vec3 size = bounds.size();
    const float edge = std::max({size.x, size.y, size.z}) / static_cast<float>(across);
    if (!(edge > 0)) return boxes;
    const ivec3 n = glm::max(ivec3(glm::ceil(size / edge - 0.01F)), ivec3(1));
    const vec3 cell = size / vec3(n);
    for (int z = 0; z < n.z; ++z)
        for (int y = 0; y < n.y; ++y) {
            // Cells that follow each other along x are one box.
            int begin = -1;
            for (int x = 0; x <= n.x; ++x) {
                const vec3 middle = bounds.min + cell * (vec3(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) + 0.5F);
                const bool inside = x < n.x && shape.distance(middle) < 0;
                if (inside && begin < 0) begin = x;
                if (inside || begin < 0) continue;
                const float length = static_cast<float>(x - begin) * cell.x;
                boxes.emplace_back(vec3(middle.x - 0.5F * cell.x - 0.5F * length, middle.y, middle.z), vec3(length, cell.y, cell.z));
                begin = -1;
            }
        }
    return boxes;
}

HullMesh convexHull(std::span<const vec3> points) {
    HullMesh mesh;
    if (points.size() < 4) return mesh;
    btConvexHullComputer hull;
    hull.compute(&points[0].x, sizeof(vec3), static_cast<int>(points.size()), 0, 0);
    for (int k = 0; k < hull.vertices.size(); ++k) mesh.positions.push_back(from(hull.vertices[k]));
    for (int f = 0; f < hull.faces.size(); ++f) {
        const btConvexHullComputer::Edge* first = &hull.edges[hull.faces[f]];
        const int a = first->getSourceVertex();
        for (const auto* e = first->getNextEdgeOfFace(); e->getTargetVertex() != a; e = e->getNextEdgeOfFace())
            for (const int v : {a, e->getSourceVertex(), e->getTargetVertex()}) mesh.indices.push_back(static_cast<uint32_t>(v));
    }
    return mesh;
}

struct BulletSolids::Impl {
    btDefaultCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btSimpleBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
    struct MeshData {
        std::vector<vec3> positions;
        std::vector<int> indices;
        std::unique_ptr<btTriangleIndexVertexArray> array;
    };
    std::vector<std::unique_ptr<MeshData>> meshes;
    std::vector<std::unique_ptr<btCollisionShape>> shapes;
    std::vector<std::unique_ptr<btRigidBody>> all, bodies;  // the scene's, the floating ones
    std::vector<std::unique_ptr<Corners>> corners;          // of bodies
    std::vector<btRigidBody*> moving;
    std::vector<Pose> now, target;  // of those that move
    double left = 0;                // s until they are there
    struct Past {
        double seconds;           // until the next
        std::vector<Pose> poses;  // of those that move
        std::optional<BodyPull> hand;
    };
    std::deque<Past> pasts;  // for predictions, which begin in the past
    // Copies of the floating bodies, for contacts(). Bullet clips the faces of their shapes against each other. The shapes of the bodies
    // in the world have no faces, because a body would move differently with them.
    std::vector<std::unique_ptr<btCollisionObject>> probes;
    std::vector<ContactBody> probed;
    std::optional<BodyPull> hand;

    ~Impl() {
        for (auto* list : {&all, &bodies})
            for (auto& b : *list) world.removeRigidBody(b.get());
    }
    template <class Shape, class... Args>
    Shape* shape(Args&&... args) {
        auto made = std::make_unique<Shape>(std::forward<Args>(args)...);
        Shape* raw = made.get();
        shapes.push_back(std::move(made));
        return raw;
    }
    // Friction and restitution of a pair are products: the scene's are 1, so that the body's hold.
    btRigidBody* addStill(btCollisionShape* form, const Pose& pose, const LayersParams& layers) {
        auto body = std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(0, nullptr, form));
        body->setWorldTransform(to(pose));
        body->setFriction(1);
        body->setRestitution(1);
        setLayers(*body, layers);
        world.addRigidBody(body.get());
        all.push_back(std::move(body));
        return all.back().get();
    }
    btCollisionShape* meshOf(const MeshView& view) {
        auto data = std::make_unique<MeshData>();
        data->positions.assign(view.positions.begin(), view.positions.end());
        data->indices.assign(view.indices.begin(), view.indices.end());
        data->array = std::make_unique<btTriangleIndexVertexArray>(
            static_cast<int>(data->indices.size() / 3), data->indices.data(), static_cast<int>(3 * sizeof(int)),
            static_cast<int>(data->positions.size()), &data->positions[0].x, static_cast<int>(sizeof(vec3)));
        auto* made = shape<btBvhTriangleMeshShape>(data->array.get(), true);
        made->setMargin(0);
        meshes.push_back(std::move(data));
        return made;
    }
    btCollisionShape* formOf(const BodyForm& f, float size) {
        switch (f.kind) {
            case BodyForm::Kind::sphere:
                return at(shape<btSphereShape>(f.radius), f.centre);
            case BodyForm::Kind::hull: {
                auto* hull = shape<btConvexHullShape>(&f.points[0].x, static_cast<int>(f.points.size()), static_cast<int>(sizeof(vec3)));
                hull->setMargin(0.2F * kMargin * size);
                return hull;
            }
            case BodyForm::Kind::cells: {
                auto* compound = shape<btCompoundShape>();
                for (const auto& [centre, extent] : f.cells) {
                    auto* box = shape<btBoxShape>(to(0.5F * extent));
                    box->setMargin(marginOf(extent));
                    compound->addChildShape(btTransform(btQuaternion::getIdentity(), to(centre)), box);
                }
                return compound;
            }
            case BodyForm::Kind::box:
                break;
        }
        auto* box = shape<btBoxShape>(to(0.5F * f.size));
        box->setMargin(marginOf(f.size));
        return at(box, f.centre);
    }
    // The farthest points of what touches, in the own frame; null where it is round.
    Corners* cornersOf(const BodyForm& f) {
        std::vector<vec3> points = f.points;
        const auto addBox = [&points](const vec3& centre, const vec3& size) {
            for (int k = 0; k < 8; ++k) points.push_back(centre + size * (vec3(k & 1, (k >> 1) & 1, k >> 2) - 0.5F));
        };
        if (f.kind == BodyForm::Kind::sphere) return nullptr;
        if (f.kind == BodyForm::Kind::box) addBox(f.centre, f.size);
        for (const auto& [centre, size] : f.cells) addBox(centre, size);
        if (f.kind == BodyForm::Kind::cells) points = convexHull(points).positions;
        corners.push_back(std::make_unique<Corners>());
        for (const vec3& p : points) corners.back()->push_back(to(p));
        return corners.back().get();
    }
    btCollisionShape* at(btCollisionShape* form, const vec3& centre) {
        if (centre == vec3(0.0F)) return form;
        auto* compound = shape<btCompoundShape>();
        compound->addChildShape(btTransform(btQuaternion::getIdentity(), to(centre)), form);
        return compound;
    }
    void addProbe(const btRigidBody& body, const BodyForm& form, float size) {
        btCollisionShape* own = formOf(form, size);
        const auto clips = [](btCollisionShape* part) {
            if (part->isPolyhedral() && part->isConvex()) static_cast<btPolyhedralConvexShape*>(part)->initializePolyhedralFeatures();
        };
        clips(own);
        if (own->isCompound()) {
            auto& parts = static_cast<btCompoundShape&>(*own);
            for (int k = 0; k < parts.getNumChildShapes(); ++k) clips(parts.getChildShape(k));
        }
        const auto add = [&](btCollisionShape* of) {
            auto probe = std::make_unique<btCollisionObject>();
            probe->setCollisionShape(of);
            probe->setFriction(body.getFriction());
            probe->setRestitution(body.getRestitution());
            setLayers(*probe, form.layers);
            probes.push_back(std::move(probe));
            return probes.back().get();
        };
        ContactBody contact{add(own), nullptr, {}, vec4(0.0F), body.getMass() > 0};
        contact.hull = contact.object;
        if (form.kind == BodyForm::Kind::cells) {
            auto* hull = shape<btConvexHullShape>();
            for (const btVector3& corner : *corners.back()) hull->addPoint(corner, false);
            hull->recalcLocalAabb();
            hull->setMargin(0.2F * kMargin * size);
            clips(hull);
            contact.hull = add(hull);
        }
        if (form.kind == BodyForm::Kind::sphere)
            contact.ball = vec4(form.centre, form.radius);
        else
            contact.corners = std::span(corners.back()->begin(), corners.back()->end());
        probed.push_back(contact);
    }
    // Bullet would keep contacts and their forces for the next step, in an order of their own; what a state keeps are the bodies. So
    // nothing is kept: a step depends on nothing but where bodies and solids are. Stacks creep somewhat more for it (23 mm instead of 18
    // in 4 s at 1/120 s); more iterations make up for the rest.
    void forget() {
        btOverlappingPairCache& pairs = *broadphase.getOverlappingPairCache();
        for (int n = pairs.getNumOverlappingPairs(); n > 0; --n) {
            const btBroadphasePair& last = pairs.getOverlappingPairArray()[n - 1];
            pairs.removeOverlappingPair(last.m_pProxy0, last.m_pProxy1, &dispatcher);
        }
        for (int n = dispatcher.getNumManifolds(); n > 0; --n) dispatcher.releaseManifold(dispatcher.getManifoldByIndexInternal(n - 1));
        solver.reset();
    }
    void put(std::span<const BodyState> states) {
        for (size_t k = 0; k < bodies.size(); ++k) {
            btRigidBody& b = *bodies[k];
            b.setWorldTransform(to(states[k].pose));
            b.setInterpolationWorldTransform(b.getWorldTransform());
            b.setLinearVelocity(to(states[k].velocity));
            b.setAngularVelocity(to(states[k].spin));
            b.setInterpolationLinearVelocity(b.getLinearVelocity());
            b.setInterpolationAngularVelocity(b.getAngularVelocity());
            b.updateInertiaTensor();
        }
    }
    bool holds(const std::optional<BodyPull>& by) const { return by && by->body < bodies.size() && bodies[by->body]->getMass() > 0; }
    // `usual`: s, the length of the steps on which the stiffness depends.
    void pull(const BodyPull& by, const vec3& gravity, double seconds, double usual) {
        if (!(seconds > 0)) return;
        btRigidBody& b = *bodies[by.body];
        const auto mass = static_cast<float>(b.getMass());
        const btVector3 arm = b.getWorldTransform() * to(by.at) - b.getWorldTransform().getOrigin();
        const vec3 place = from(b.getWorldTransform().getOrigin() + arm), velocity = from(b.getVelocityInLocalPoint(arm));
        const btVector3& inverse = b.getInvInertiaDiagLocal();
        const float light = 1 + mass * arm.length2() * inverse[inverse.maxAxis()];
        b.applyForce(to(springOf(place, velocity, by.to, by.rate, by.most, static_cast<float>(usual), light) * mass), arm);
        b.applyCentralForce(to(-gravity * mass));  // at its middle: else it would hang from the grip and swing
        b.setAngularVelocity(b.getAngularVelocity() * calmOf(static_cast<float>(seconds)));
    }
    // As of BodyHost.
    bool contacts(std::span<const BodyState> states, std::span<const vec4> balls, double seconds, std::vector<BodyContact>& found) {
        std::vector<ContactSolid> solids;
        solids.reserve(all.size());
        for (const auto& solid : all) solids.push_back({solid.get(), vec3(0.0F), vec3(0.0F), 0});
        for (size_t k = 0; k < moving.size(); ++k) {
            moving[k]->setWorldTransform(to(now[k]));
            if (!(left > 0)) continue;
            const auto solid = std::ranges::find(solids, moving[k], &ContactSolid::object);
            btVector3 linear, angular;
            btTransformUtil::calculateVelocity(to(now[k]), to(target[k]), static_cast<btScalar>(left), linear, angular);
            solid->velocity = from(linear);
            solid->spin = from(angular);
            solid->seconds = left;
        }
        findContacts(world, probed, solids, states, balls, seconds, found);
        return true;
    }
    // The moving solids go on, as in advance().
    void passed(double seconds) {
        remember(seconds);
        now = posesIn(seconds);
        left = std::max(left - seconds, 0.0);
    }
    // The poses of the moving solids in `seconds`, in the past where negative.
    std::vector<Pose> posesIn(double seconds) const {
        std::vector<Pose> poses = now;
        if (seconds > 0) {
            const double share = left > 0 ? std::min(seconds / left, 1.0) : 1.0;
            for (size_t k = 0; k < moving.size(); ++k) poses[k] = between(now[k], target[k], share);
            return poses;
        }
        for (auto past = pasts.rbegin(); past != pasts.rend() && seconds < 0; ++past) {
            const double share = std::min(-seconds / past->seconds, 1.0);
            for (size_t k = 0; k < moving.size(); ++k) poses[k] = between(poses[k], past->poses[k], share);
            seconds += past->seconds;
        }
        return poses;
    }
    // What pulls in `seconds`, in the past where negative.
    std::optional<BodyPull> handIn(double seconds) const {
        for (auto past = pasts.rbegin(); past != pasts.rend() && seconds < 0; ++past) {
            seconds += past->seconds;
            if (seconds >= 0) return past->hand;
        }
        return hand;
    }
    // All are about to move on by `seconds`.
    void remember(double seconds) {
        constexpr size_t kMost = 256;  // steps: the last few frames
        if (!(seconds > 0)) return;
        if (pasts.size() == kMost) pasts.pop_front();
        pasts.push_back({seconds, now, hand});
    }
    void advance(std::span<const BodyLoad> loads, const vec3& gravity, double seconds, std::span<BodyState> states) {
        const std::vector<Pose> next = posesIn(seconds);
        remember(seconds);
        move(loads, gravity, seconds, now, next, hand, seconds, states);
        left = std::max(left - seconds, 0.0);
        now = next;
    }
    // As of BodyHost. The spring of a hand needs short steps, and is as stiff as in those of the world.
    void predict(std::span<const BodyLoad> loads, const vec3& gravity, double begin, double seconds, std::span<BodyState> states) {
        constexpr double kShort = 1.0 / 300;  // s: steps that are shorter change nothing
        const std::optional<BodyPull> by = handIn(begin + 0.5 * seconds);
        const double longest = std::max(pasts.empty() ? 0.0 : pasts.back().seconds, kShort);
        const int parts = holds(by) ? static_cast<int>(std::ceil(seconds / longest - 1.0e-6)) : 1;
        for (int k = 0; k < parts; ++k) {
            const double length = seconds / parts, at = begin + k * length;
            move(loads, gravity, length, posesIn(at), posesIn(at + length), by, longest, states);
        }
    }
    // By a step, in which the moving solids go from `begin` to `end`.
    void move(std::span<const BodyLoad> loads, const vec3& gravity, double seconds, std::span<const Pose> begin, std::span<const Pose> end,
              const std::optional<BodyPull>& by, double usual, std::span<BodyState> states) {
        put(states);
        for (size_t k = 0; k < bodies.size(); ++k) {
            btRigidBody& b = *bodies[k];
            b.clearForces();
            if (b.getMass() > 0) b.applyCentralForce(to(loads[k].force + dvec3(gravity) * double{b.getMass()}));
            if (b.getMass() > 0) b.applyTorque(to(loads[k].torque));
        }
        if (holds(by)) pull(*by, gravity, seconds, usual);
        for (size_t k = 0; k < moving.size(); ++k) {
            moving[k]->setInterpolationWorldTransform(to(begin[k]));
            moving[k]->setWorldTransform(to(end[k]));
            btVector3 linear, angular;
            btTransformUtil::calculateVelocity(to(begin[k]), to(end[k]), static_cast<btScalar>(seconds), linear, angular);
            moving[k]->setLinearVelocity(linear);
            moving[k]->setAngularVelocity(angular);
        }
        world.stepSimulation(static_cast<btScalar>(seconds), 0);
        forget();
        for (size_t k = 0; k < bodies.size(); ++k) {
            if (!(bodies[k]->getMass() > 0)) continue;
            states[k].pose = from(bodies[k]->getWorldTransform());
            states[k].velocity = from(bodies[k]->getLinearVelocity());
            states[k].spin = from(bodies[k]->getAngularVelocity());
        }
    }
};

BulletSolids::BulletSolids(const Scene& scene, std::span<const Body> bodies, std::span<const BodyForm> forms)
    : impl_(std::make_unique<Impl>()) {
    ASSERT(bodies.size() == forms.size(), "one form a body");
    Impl& w = *impl_;
    w.dispatcher.setNearCallback(meet);
    w.world.setGravity(btVector3(0, 0, 0));  // a load like the others
    w.world.getSolverInfo().m_splitImpulse = 1;
    // All contacts of a step are detected at once, and their forces start at zero: see forget.
    w.configuration.setConvexConvexMultipointIterations(8, 4);
    w.world.getSolverInfo().m_numIterations = 30;
    const bvec3 periodic = scene.box.periodic();
    const Pose origin;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {1.0F, -1.0F}) {
            if (periodic[axis]) continue;
            vec3 normal(0.0F);
            normal[axis] = side;
            w.addStill(w.shape<btStaticPlaneShape>(to(normal), side > 0 ? scene.box.min[axis] : -scene.box.max[axis]), origin, kBoxLayers);
        }
    const auto layersAt = [](std::span<const LayersParams> all, size_t k) { return all.empty() ? LayersParams() : all[k]; };
    for (size_t k = 0; k < scene.planes.size(); ++k) {
        const PlaneSolid& p = scene.planes[k];
        const vec3 normal = glm::normalize(p.normal);
        w.addStill(w.shape<btStaticPlaneShape>(to(normal), glm::dot(normal, p.position)), origin, layersAt(scene.planeLayers, k));
    }
    for (size_t k = 0; k < scene.still.size(); ++k)
        if (scene.still[k].triangleCount() > 0) w.addStill(w.meshOf(scene.still[k]), origin, layersAt(scene.stillLayers, k));
    for (size_t k = 0; k < scene.moving.size(); ++k) {
        if (scene.moving[k].triangleCount() == 0) continue;
        btRigidBody* body = w.addStill(w.meshOf(scene.moving[k]), scene.poses[k], layersAt(scene.movingLayers, k));
        body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
        body->setActivationState(DISABLE_DEACTIVATION);
        w.moving.push_back(body);
        w.now.push_back(scene.poses[k]);
    }
    w.target = w.now;
    std::vector<BodyState> states;
    for (size_t k = 0; k < bodies.size(); ++k) {
        const BodyShape& s = bodies[k].shape;
        Bounds bounds;
        for (const vec3& p : s.samples) bounds.add(p);
        const vec3 size = bounds.size();
        btRigidBody::btRigidBodyConstructionInfo info(s.mass, nullptr, w.formOf(forms[k], std::max({size.x, size.y, size.z})),
                                                      to(s.inertia));
        info.m_friction = forms[k].friction;
        info.m_restitution = forms[k].restitution;
        info.m_linearDamping = info.m_angularDamping = 0;
        auto body = std::make_unique<btRigidBody>(info);
        body->setActivationState(DISABLE_DEACTIVATION);
        body->setUserPointer(w.cornersOf(forms[k]));
        setLayers(*body, forms[k].layers);
        w.world.addRigidBody(body.get());
        w.addProbe(*body, forms[k], std::max({size.x, size.y, size.z}));
        w.bodies.push_back(std::move(body));
        states.push_back(bodies[k].state);
    }
    w.put(states);
}

BulletSolids::~BulletSolids() = default;

BodyHost BulletSolids::host() {
    BodyHost h;
    h.self = impl_.get();
    h.advance = [](void* self, std::span<const BodyLoad> loads, const vec3& gravity, double seconds, std::span<BodyState> states) {
        static_cast<Impl*>(self)->advance(loads, gravity, seconds, states);
    };
    h.reset = [](void* self, std::span<const BodyState> states) { static_cast<Impl*>(self)->put(states); };
    h.contacts = [](void* self, std::span<const BodyState> states, std::span<const vec4> balls, double seconds,
                    std::vector<BodyContact>& found) { return static_cast<Impl*>(self)->contacts(states, balls, seconds, found); };
    h.predict = [](void* self, std::span<const BodyLoad> loads, const vec3& gravity, double from, double seconds,
                   std::span<BodyState> states) { static_cast<Impl*>(self)->predict(loads, gravity, from, seconds, states); };
    h.passed = [](void* self, double seconds) { static_cast<Impl*>(self)->passed(seconds); };
    h.pulls = [](void* self, std::vector<BodyPull>& found) {
        const Impl& w = *static_cast<Impl*>(self);
        if (w.holds(w.hand)) found.push_back(*w.hand);
    };
    // Poses of the moving solids: current and at the end of the step.
    h.save = [](void* self) {
        const Impl& w = *static_cast<Impl*>(self);
        std::vector<std::byte> bytes;
        const auto add = [&bytes](std::span<const std::byte> more) { bytes.insert(bytes.end(), more.begin(), more.end()); };
        add(std::as_bytes(std::span(w.now)));
        add(std::as_bytes(std::span(w.target)));
        add(std::as_bytes(std::span(&w.left, 1)));
        return bytes;
    };
    h.restore = [](void* self, std::span<const std::byte> bytes, std::span<const BodyState> states) -> Status {
        Impl& w = *static_cast<Impl*>(self);
        const size_t poses = w.now.size() * sizeof(Pose);
        if (bytes.size() != 2 * poses + sizeof(double))
            return badInput(
                fmt::format("the saved state has other moving solids than the {} that bodies touch in this scene", w.now.size()));
        std::vector<Pose> now(w.now.size()), target(w.now.size());
        double left = 0;
        if (poses > 0) {
            std::memcpy(now.data(), bytes.data(), poses);
            std::memcpy(target.data(), bytes.data() + poses, poses);
        }
        std::memcpy(&left, bytes.data() + 2 * poses, sizeof left);
        constexpr double kLongest = 1.0e9;  // s
        if (!std::ranges::all_of(now, isSound) || !std::ranges::all_of(target, isSound) || !(left >= 0 && left <= kLongest))
            return badInput("section bodies.host of the saved state has invalid poses of solids that bodies touch: save it again");
        w.now = std::move(now);
        w.target = std::move(target);
        w.left = left;
        w.pasts.clear();
        w.put(states);
        return ok();
    };
    return h;
}

void BulletSolids::hold(const std::optional<BodyPull>& hand) { impl_->hand = hand; }

void BulletSolids::moveTo(std::span<const Pose> poses, double seconds) {
    if (poses.size() != impl_->moving.size()) return;
    impl_->target.assign(poses.begin(), poses.end());
    impl_->left = seconds;
    if (seconds > 0) return;
    impl_->now = impl_->target;
    impl_->pasts.clear();
}

}  // namespace rivulet
