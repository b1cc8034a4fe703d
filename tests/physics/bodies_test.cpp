// Bodies in the fluid: Archimedes' principle, Newton's third law, walls of boundary particles, and very light bodies.
#include "fluid/sim/solids/bodies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/compute/device_cpu.h"
#include "fluid/session/session.h"
#include "fluid/sim/methods/smoothing.h"
#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet::bodies_test {
namespace {

std::unique_ptr<CpuDevice> cpu(int threads = 0) {
    static const std::vector<CpuKernelRow> rows = cpuKernels();
    return makeCpuDevice(rows, {.threads = threads});
}

// The fluid's particles alone.
struct Drop {
    vec3 position, velocity;
};
std::vector<Drop> fluidOf(FluidWorld& world) {
    const ParticleView view = world.particles();
    const std::vector<vec4> x = world.device().readAll<vec4>(*view.position, view.slots),
                            v = world.device().readAll<vec4>(*view.velocity, view.slots);
    std::vector<Drop> all;
    for (size_t i = 0; i < x.size(); ++i)
        if (x[i].w >= 0) all.push_back({vec3(x[i]), vec3(v[i])});
    EXPECT_EQ(all.size(), view.count) << "samples are never among the particles, whatever is lost";
    return all;
}

FluidParams tank(const std::string& method, float spacing, const vec3& size, float depth) {
    FluidParams p;
    p.method = method;
    p.spacing = spacing;
    p.box.min = vec3(0);
    p.box.max = size;
    p.blocks = {{vec3(0), vec3(size.x, depth, size.z), vec3(0.0F)}};
    p.soundSpeed = 20;
    p.cfl = 0.8F;
    p.artificialViscosity = 0.1F;  // with less, noise keeps the fluid a third of a spacing away from the bodies
    return p;
}

std::unique_ptr<FluidWorld> make(Device& device, const FluidParams& params, const Solids& solids) {
    auto world = FluidWorld::create(device, params, solids, {});
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    return world ? std::move(*world) : nullptr;
}

// Moves bodies freely, but not through the floor.
struct OnFloor {
    explicit OnFloor(std::span<const Body> bodies, double half) : free(bodies), halfHeight(half) {}
    FreeBodies free;
    double halfHeight;
    BodyHost host() {
        BodyHost h = free.host();
        h.self = this;
        h.advance = [](void* self, std::span<const BodyLoad> loads, const vec3& gravity, double seconds, std::span<BodyState> states) {
            OnFloor& o = *static_cast<OnFloor*>(self);
            const BodyHost inner = o.free.host();
            inner.advance(inner.self, loads, gravity, seconds, states);
            for (BodyState& s : states)
                if (s.pose.position.y < o.halfHeight) {
                    s.pose.position.y = static_cast<float>(o.halfHeight);
                    s.velocity = vec3(0.0F);
                }
        };
        return h;
    }
};

// Height of the surface where `counts` is true: mean height of the highest particle of each column of one spacing, plus half a spacing.
template <class Counts>
double surfaceOf(const std::vector<Drop>& drops, float spacing, Counts counts) {
    std::map<std::pair<int, int>, float> top;
    for (const Drop& d : drops) {
        if (!counts(d.position)) continue;
        float& y = top[{static_cast<int>(d.position.x / spacing), static_cast<int>(d.position.z / spacing)}];
        y = std::max(y, d.position.y);
    }
    double sum = 0;
    for (const auto& [column, y] : top) sum += double{y};
    return sum / static_cast<double>(top.size()) + 0.5 * double{spacing};
}

// ---- samples ----

// A lattice of fluid that begins half a spacing from a flat surface is at rest density, for any offset along the samples: but for the
// factor with which sampleVolumes counts a fluid in disorder.
TEST(Samples, APlaneHasTheDensityOfTheFluidThatItReplaces) {
    for (const char* kernel : {"wendland", "cubic_spline"})
        for (const float support : {2.0F, 2.5F, 3.0F}) {
            FluidParams p{.method = "wcsph"};
            p.kernel = kernel;
            p.spacing = 0.02F;
            p.supportSpacings = support;
            std::vector<vec3> plane;
            for (int i = -12; i <= 12; ++i)
                for (int k = -12; k <= 12; ++k) plane.emplace_back(0.02F * static_cast<float>(i), -0.01F, 0.02F * static_cast<float>(k));
            const std::vector<float> volume = sampleVolumes(plane, p);
            const double disorder = 1 + 0.35 * (double{support} - 2);
            const double h = double{support} * 0.02;
            const auto w = [&](const dvec3& d) {
                const double q = glm::length(d) / h, a = std::max(1 - q, 0.0), b = std::max(0.5 - q, 0.0);
                return p.kernel == "wendland" ? 21 / (2 * M_PI * h * h * h) * a * a * a * a * (4 * q + 1) / wendlandLatticeSum(support)
                                              : 8 / (M_PI * h * h * h) * (2 * a * a * a - 8 * b * b * b) / cubicLatticeSum(support);
            };
            for (const double aside : {0.0, 0.25, 0.5})
                for (int layer = 0; layer < 3; ++layer) {
                    const dvec3 x(0.02 * aside, 0.02 * (layer + 0.5), 0.02 * aside * 0.6);
                    double ratio = 0;
                    for (int i = -5; i <= 5; ++i)
                        for (int j = 0; j <= 9; ++j)
                            for (int k = -5; k <= 5; ++k) ratio += 8e-6 * w(x - dvec3(x.x + 0.02 * i, 0.02 * (j + 0.5), x.z + 0.02 * k));
                    for (size_t s = 0; s < plane.size(); ++s) ratio += 8e-6 * double{volume[s]} / disorder * w(x - dvec3(plane[s]));
                    EXPECT_NEAR(ratio, 1, 0.005) << kernel << ", support " << support << ", layer " << layer << ", aside " << aside;
                }
        }
}

// A body's mass, inertia and volume equal those of its shape, for a box and for a rotated and translated mesh; samples lie half a spacing
// deep.
TEST(Samples, AMeshOfABoxEqualsTheBox) {
    const vec3 size(0.3F, 0.2F, 0.12F);
    const float s = 0.02F;
    const BodyShape box = boxShape(size, 700, s);
    const quat turn = glm::angleAxis(0.7F, glm::normalize(vec3(1, 2, 0.5F)));
    std::vector<vec3> corners;
    corners.reserve(8);
    for (int k = 0; k < 8; ++k)
        corners.push_back(
            vec3(3, -2, 1) +
            turn * ((vec3(static_cast<float>(k & 1), static_cast<float>(k >> 1 & 1), static_cast<float>(k >> 2)) - 0.5F) * size));
    const std::vector<uint32_t> faces = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                         2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    const Result<MeshBody> mesh = meshShape({corners, faces, {}, {}}, 700, s);
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_NEAR(mesh->shape.mass, box.mass, 1e-4 * box.mass);
    EXPECT_NEAR(mesh->shape.volume, box.volume, 1e-4 * box.volume);
    EXPECT_LT(glm::length(mesh->frame.position - vec3(3, -2, 1)), 1e-5F);
    vec3 a = mesh->shape.inertia, b = box.inertia;
    std::sort(&a.x, &a.x + 3);
    std::sort(&b.x, &b.x + 3);
    EXPECT_LT(glm::length(a - b), 1e-3F * glm::length(b));
    for (const vec3& p : mesh->shape.samples) {
        EXPECT_NEAR(mesh->shape.distance(p), -0.5F * s, 0.31F * 0.5F * s);
        EXPECT_NEAR(box.distance(glm::conjugate(turn) * (mesh->frame.toWorld(p) - vec3(3, -2, 1))), mesh->shape.distance(p), 1e-5F);
    }
    for (const vec3& p : box.samples) EXPECT_NEAR(box.distance(p), -0.5F * s, 1e-6F);
    // The number of samples equals that of a lattice, and there is no gap that fluid could pass.
    EXPECT_NEAR(static_cast<double>(mesh->shape.samples.size()), static_cast<double>(box.samples.size()),
                0.3 * static_cast<double>(box.samples.size()));
    for (const vec3& p : box.samples) {
        const vec3 own = mesh->frame.toOwn(vec3(3, -2, 1) + turn * p);
        float near = 1;
        for (const vec3& q : mesh->shape.samples) near = std::min(near, glm::length(q - own));
        EXPECT_LT(near, 1.1F * s);
    }
    std::vector<uint32_t> inverted(faces.rbegin(), faces.rend());
    EXPECT_FALSE(meshShape({corners, inverted, {}, {}}, 700, s)) << "inside out";
}

// A free body obeys Euler's equations: angular momentum and energy are conserved, while the spin moves around the middle axis.
TEST(FreeBody, TumblesWithItsAngularMomentum) {
    Body body;
    body.shape = boxShape(vec3(0.3F, 0.2F, 0.1F), 500, 0.02F);
    body.state.spin = vec3(0.01F, 3.0F, 0.0F);  // about the axis of intermediate inertia: the body flips
    FreeBodies free(std::span(&body, 1));
    const BodyHost host = free.host();
    const auto momentum = [&](const BodyState& s) {
        return s.pose.rotation * (body.shape.inertia * (glm::conjugate(s.pose.rotation) * s.spin));
    };
    const vec3 before = momentum(body.state);
    BodyState s = body.state;
    float least = 1;
    const BodyLoad none;
    for (int k = 0; k < 20000; ++k) {
        host.advance(host.self, std::span(&none, 1), vec3(0.0F), 1e-3, std::span(&s, 1));
        least = std::min(least, (s.pose.rotation * vec3(0, 1, 0)).y);
        ASSERT_LT(glm::length(momentum(s) - before), 1e-3F * glm::length(before));
        ASSERT_NEAR(glm::dot(momentum(s), s.spin), glm::dot(before, body.state.spin), 0.02F * glm::dot(before, body.state.spin));
    }
    EXPECT_LT(least, -0.9F) << "the tennis racket turns over";
}

// ---- two-way coupling ----

// A drop hits a resting body off centre, without gravity or in free fall. For every method, the total momentum and angular momentum of
// fluid and body change only by gravity.
TEST(TwoWay, MomentaOfFluidAndBodyAreConserved) {
    for (const auto& [method, gravity] : {std::pair("wcsph", 0.0F), std::pair("wcsph", 9.81F), std::pair("dfsph", 0.0F),
                                          std::pair("dfsph", 9.81F), std::pair("pbf", 0.0F)}) {
        auto device = cpu();
        FluidParams p = tank(method, 0.02F, vec3(2), 0);
        p.gravity = vec3(0.0F, -gravity, 0.0F);
        p.viscosity = 0.01F;
        p.blocks = {{vec3(0.7F, 0.9F, 0.92F), vec3(0.9F, 1.1F, 1.08F), vec3(1.5F, 0, 0)}};
        Body body;
        body.shape = boxShape(vec3(0.16F), 1500, p.spacing);
        body.shape.sticks = 1;
        body.state.pose.position = vec3(1.0F, 1.03F, 1.0F);
        auto world = make(*device, p, {.bodies = {body}});
        ASSERT_TRUE(world);
        const double mass = world->particles().mass;
        const auto sum = [&](dvec3& momentum, dvec3& turning) {
            momentum = turning = dvec3(0.0);
            for (const Drop& d : fluidOf(*world)) {
                momentum += mass * dvec3(d.velocity);
                turning += mass * glm::cross(dvec3(d.position), dvec3(d.velocity));
            }
            const BodyState& s = world->bodies()[0];
            const dvec3 own = double{body.shape.mass} * dvec3(s.velocity);
            momentum += own;
            turning += glm::cross(dvec3(s.pose.position), own) +
                       dvec3(s.pose.rotation * (body.shape.inertia * (glm::conjugate(s.pose.rotation) * s.spin)));
        };
        dvec3 before, beforeTurning, after, afterTurning;
        sum(before, beforeTurning);
        dvec3 impulse(0.0);
        for (int frame = 0; frame < 12; ++frame) world->step({.gravity = p.gravity}, 1.0 / 60);
        sum(after, afterTurning);
        after += world->bodyLoads()[0].pendingImpulse;
        const double all = mass * world->particles().count + double{body.shape.mass};
        const dvec3 fallen = world->time() * dvec3(p.gravity);
        after -= all * fallen;
        impulse = double{body.shape.mass} * (dvec3(world->bodies()[0].velocity) - fallen);
        EXPECT_GT(glm::length(impulse), 0.2 * glm::length(before)) << method << ": the drop must hit";
        EXPECT_LT(glm::length(after - before), 1e-4 * glm::length(impulse)) << method;
        EXPECT_GT(glm::length(world->bodies()[0].spin), 0.1F) << method;
        std::printf("%s: momentum %.2e of the impulse", method, glm::length(after - before) / glm::length(impulse));
        if (gravity == 0) std::printf(", angular momentum %.2e", glm::length(afterTurning - beforeTurning) / glm::length(beforeTurning));
        std::printf("\n");
    }
}

// ---- Archimedes ----

// A ball of a hundredth of the density of water and one of a hundred times that density, dropped from just above the surface: the first
// ends on top, the second on the floor.
TEST(Floating, AHundredTimesAsLightAndAsHeavy) {
    for (const char* method : {"wcsph", "pbf", "dfsph"})
        for (const double ratio : {0.01, 100.0}) {
            auto device = cpu();
            const float s = 0.0125F, radius = 0.05F;
            FluidParams p = tank(method, s, vec3(0.2F, 0.4F, 0.2F), 0.125F);
            Body body;
            body.shape = sphereShape(radius, 1000 * ratio, s);
            body.state.pose.position = vec3(0.1F, 0.125F + radius + 0.02F, 0.1F);
            OnFloor floor(std::span(&body, 1), radius);
            auto world = make(*device, p, {.bodies = {body}, .bodyHost = floor.host()});
            ASSERT_TRUE(world);
            double height = 0, fastest = 0;
            for (int frame = 0; frame < 60; ++frame) {
                world->step({.gravity = p.gravity}, 1.0 / 60);
                const BodyState& b = world->bodies()[0];
                ASSERT_TRUE(isFinite(b.pose.position));
                fastest = std::max(fastest, double{glm::length(b.velocity)});
                if (frame >= 30) height += double{b.pose.position.y} / 30;
            }
            EXPECT_LT(fastest, 2.2) << "falls 0.14 m at most: 1.7 m/s";
            if (ratio < 1) {
                // The share of the ball below the surface weighs what the ball weighs: (3 - d) d^2 / 4 = ratio, d its depth in radii.
                double d = 0;
                while ((3 - d) * d * d / 4 < ratio) d += 1e-4;
                const double water = world->particles().count * std::pow(double{s}, 3),
                             wet = ratio * 4 / 3 * M_PI * std::pow(double{radius}, 3);
                const double expected = (water + wet) / 0.04 + radius * (1 - d);
                std::printf("%s %g: %.4f, expected %.4f\n", method, ratio, height, expected);
                EXPECT_NEAR(height, expected, 0.5 * s) << method << ", ratio " << ratio;
            } else {
                EXPECT_NEAR(height, radius, 0.2 * s) << method << ", ratio " << ratio;
            }
            EXPECT_EQ(world->stats().lost, 0U);
        }
}

// ---- walls of boundary particles ----

// A pool over a floor of boundary particles is as deep as over the floor of the box: no gap, no particle below the floor, no climbing at
// its edge.
TEST(BoundaryParticles, APoolStandsAsOverTheFloor) {
    auto device = cpu();
    const float s = 0.02F;
    double level[2] = {0, 0}, lowest[2] = {1, 1};
    for (const bool particles : {false, true}) {
        const float ground = particles ? 0.1F : 0.0F;
        FluidParams p = tank("wcsph", s, vec3(0.3F, 0.5F, 0.3F), 0.0F);
        p.blocks = {{vec3(0, ground, 0), vec3(0.3F, ground + 0.16F, 0.3F), vec3(0.0F)}};
        Solids solids;
        if (particles) {
            Body floor;
            floor.shape = boxShape(vec3(0.3F, 0.08F, 0.3F), 0, s);  // from wall to wall
            floor.state.pose.position = vec3(0.15F, ground - 0.04F, 0.15F);
            solids.bodies = {floor};
        }
        auto world = make(*device, p, solids);
        ASSERT_TRUE(world);
        for (int frame = 0; frame < 45; ++frame) {
            world->step({.gravity = p.gravity}, 1.0 / 60);
            if (frame < 30) continue;
            const std::vector<Drop> drops = fluidOf(*world);
            level[particles] += (surfaceOf(drops, s, [](const vec3&) { return true; }) - double{ground}) / 15;
            for (const Drop& d : drops) lowest[particles] = std::min(lowest[particles], double{d.position.y - ground});
        }
        EXPECT_EQ(world->stats().lost, 0U);
    }
    std::printf("level %.4f and %.4f, lowest %.4f and %.4f\n", level[0], level[1], lowest[0], lowest[1]);
    EXPECT_NEAR(level[1], level[0], 0.2 * s);
    EXPECT_NEAR(lowest[1], lowest[0], 0.3 * s);
}

// Water flows through a gap of three spacings between walls of boundary particles.
class ChannelOfParticles : public testing::TestWithParam<const char*> {};
TEST_P(ChannelOfParticles, ThreeSpacingsWideLetsWaterThrough) {
    auto device = cpu();
    const float s = 0.02F;
    FluidParams p = tank(GetParam(), s, vec3(0.42F, 0.8F, 0.1F), 0.0F);
    p.blocks = {{vec3(0, 0.44F, 0), vec3(0.42F, 0.6F, 0.1F), vec3(0.0F)}};
    Solids solids;
    for (const float side : {-1.0F, 1.0F}) {
        Body half;
        half.shape = boxShape(vec3(0.18F, 0.08F, 0.1F), 0, s);
        half.state.pose.position = vec3(0.21F + side * (0.03F + 0.09F), 0.4F, 0.05F);
        solids.bodies.push_back(half);
    }
    auto world = make(*device, p, solids);
    ASSERT_TRUE(world);
    for (int frame = 0; frame < 60; ++frame) world->step({.gravity = p.gravity}, 1.0 / 60);
    size_t through = 0, within = 0;
    const std::vector<Drop> drops = fluidOf(*world);
    for (const Drop& d : drops) {
        through += d.position.y < 0.36F ? 1 : 0;
        within += d.position.y > 0.37F && d.position.y < 0.43F && std::abs(d.position.x - 0.21F) > 0.04F ? 1 : 0;
    }
    std::printf("%zu of %zu through, %zu within\n", through, drops.size(), within);
    EXPECT_GT(through, drops.size() * 6 / 10);
    EXPECT_EQ(within, 0U) << "nothing goes through the walls";
    EXPECT_EQ(world->stats().lost, 0U);
}
INSTANTIATE_TEST_SUITE_P(Methods, ChannelOfParticles, testing::Values("wcsph", "pbf", "dfsph"),
                         [](const auto& row) { return std::string(row.param); });

// ---- reproducibility ----

TEST(TwoWay, TheSameBitsForAnyThreads) {
    std::vector<vec4> first;
    BodyState body0;
    for (const int threads : {1, 2}) {
        auto device = cpu(threads);
        FluidParams p = tank("wcsph", 0.02F, vec3(0.4F), 0.16F);
        std::vector<Body> bodies(2);
        bodies[0].shape = boxShape(vec3(0.12F, 0.08F, 0.1F), 600, p.spacing);
        bodies[0].state.pose.position = vec3(0.13F, 0.2F, 0.2F);
        bodies[0].state.spin = vec3(1, 2, 3);
        bodies[1].shape = sphereShape(0.05F, 300, p.spacing);
        bodies[1].state.pose.position = vec3(0.3F, 0.25F, 0.2F);
        auto world = make(*device, p, {.bodies = bodies});
        ASSERT_TRUE(world);
        for (int frame = 0; frame < 10; ++frame) world->step({.gravity = p.gravity}, 1.0 / 60);
        const std::vector<vec4> x = device->readAll<vec4>(*world->particles().position, world->particles().slots);
        if (threads == 1) {
            first = x;
            body0 = world->bodies()[0];
            // And again after a reset.
            world->reset();
            for (int frame = 0; frame < 10; ++frame) world->step({.gravity = p.gravity}, 1.0 / 60);
            EXPECT_EQ(world->bodies()[0].pose.position, body0.pose.position);
        }
        EXPECT_TRUE(x == first);
        EXPECT_EQ(world->bodies()[0].pose.position, body0.pose.position);
        EXPECT_EQ(world->bodies()[0].spin, body0.spin);
        EXPECT_GT(glm::length(world->bodies()[0].spin - vec3(1, 2, 3)), 0.1F);
    }
}

// ---- contact ----

// Heavy bodies of every shape in a dry box: a box on the floor, a ball on the box, a hull and a mesh next to them. They come to rest.
TEST(Contact, BodiesRestOnTheFloorAndOnEachOther) {
    auto device = cpu();
    SceneFile scene;
    scene.fluid.method = "wcsph";
    scene.fluid.spacing = 0.02F;
    scene.fluid.soundSpeed = 20;
    scene.fluid.blocks = {{vec3(0.9F, 0, 0.9F), vec3(1.0F, 0.04F, 1.0F), vec3(0.0F)}};
    BodyParams body;
    body.density = 2000;
    body.size = vec3(0.2F, 0.1F, 0.2F);
    body.position = vec3(0.3F, 0.07F, 0.3F);
    scene.bodies.push_back(body);
    body.shape = "sphere";
    body.position = vec3(0.3F, 0.2F, 0.3F);
    scene.bodies.push_back(body);
    for (const char* shape : {"hull", "mesh"}) {
        body.shape = shape;
        body.mesh = "meshes/sphere.obj";
        body.fitSize = 0.12F;
        body.position = vec3(shape[0] == 'h' ? 0.6F : 0.8F, 0.1F, 0.4F);
        scene.bodies.push_back(body);
    }
    // The distance of the ball is computed for every particle near it: a coarse mesh is enough.
    auto session = Session::create(scene, *device, {});
    ASSERT_TRUE(session) << session.error().message;
    for (int frame = 0; frame < 60; ++frame) (*session)->step(1.0 / 60, true);
    const std::vector<BodyState>& b = (*session)->world().bodies();
    EXPECT_NEAR(b[0].pose.position.y, 0.05F, 0.002F);
    EXPECT_NEAR(b[1].pose.position.y, 0.15F, 0.004F);
    EXPECT_NEAR(b[2].pose.position.y, 0.06F, 0.004F);
    EXPECT_NEAR(b[3].pose.position.y, 0.06F, 0.008F);  // of the boxes a twelfth of that
    for (const BodyState& s : b) EXPECT_LT(glm::length(s.velocity), 0.1F);
    (*session)->reset();
    EXPECT_EQ((*session)->world().bodies()[1].pose.position, vec3(0.3F, 0.2F, 0.3F));
}

// Contacts without fluid: a stack is stable, and a box on a slope stays or slides by Coulomb's law.
struct Contacts {
    std::vector<Body> bodies;
    std::vector<BodyForm> forms;
    std::vector<PlaneSolid> planes;
    void add(const vec3& position, float friction, const quat& turn = quat(1, 0, 0, 0)) {
        const vec3 size(0.1F);
        Body b;
        b.shape = boxShape(size, 500, 0.02F);
        b.state.pose = {position, turn};
        bodies.push_back(b);
        BodyForm form;
        form.size = size;
        form.friction = friction;
        forms.push_back(form);
    }
    std::vector<BodyState> after(double seconds, double dt) const {
        BoxParams room;
        room.min = vec3(-5, 0, -5);
        room.max = vec3(5);
        BulletSolids solids({.box = room, .planes = planes, .still = {}, .moving = {}, .poses = {}}, bodies, forms);
        const BodyHost host = solids.host();
        std::vector<BodyState> states;
        for (const Body& b : bodies) states.push_back(b.state);
        const std::vector<BodyLoad> none(bodies.size());
        for (int k = 0; k < std::lround(seconds / dt); ++k) host.advance(host.self, none, vec3(0, -9.81F, 0), dt, states);
        return states;
    }
};

TEST(Contact, AStackIsStableWithoutStoredContacts) {
    for (const double dt : {1.0 / 120, 1.0 / 480, 1.0 / 2000}) {
        Contacts stack;
        for (int k = 0; k < 5; ++k) stack.add(vec3(0, 0.05F + 0.1F * static_cast<float>(k), 0), 0.5F);
        const std::vector<BodyState> end = stack.after(3, dt);
        for (size_t k = 0; k < end.size(); ++k) {
            const vec3 moved = end[k].pose.position - stack.bodies[k].state.pose.position;
            EXPECT_LT(std::abs(moved.y), 0.001F) << k << ", dt " << dt;
            EXPECT_LT(glm::length(moved), 0.025F) << k << ", dt " << dt;
            EXPECT_GT((end[k].pose.rotation * vec3(0, 1, 0)).y, 0.999F) << k << ", dt " << dt;
        }
    }
}

TEST(Contact, ABoxOnASlopeObeysCoulombsLaw) {
    const double angle = 20 * M_PI / 180;
    const vec3 normal(static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle)), 0);
    for (const float friction : {0.5F, 0.2F}) {  // tan 20 degrees is 0.364
        Contacts slope;
        slope.planes = {{vec3(0, 1, 0), normal, 0}};
        slope.add(vec3(0, 1, 0) + 0.05F * normal, friction, glm::angleAxis(static_cast<float>(-angle), vec3(0, 0, 1)));
        const double down = 9.81 * std::max(std::sin(angle) - double{friction} * std::cos(angle), 0.0);
        const vec3 moved = slope.after(0.5, 1.0 / 480)[0].pose.position - slope.bodies[0].state.pose.position;
        const double expected = friction > 0.364F ? 0 : 0.5 * down * 0.25;
        EXPECT_NEAR(double{glm::length(moved)}, expected, 0.01 * expected + 1.0e-4) << friction;
    }
}

// Bodies would pass through a deforming mesh: such a scene is refused with an error.
TEST(Contact, ADeformingColliderIsRefusedInASceneWithBodies) {
    auto device = cpu();
    SceneFile scene;
    scene.fluid.spacing = 0.05F;
    ColliderParams sheet;
    sheet.mesh = "meshes/sheet.obj";
    sheet.fitSize = 0.3F;
    sheet.resolution = 16;
    sheet.position = vec3(0.3F, 0.4F, 0.3F);
    sheet.wave.amplitude = 0.05F;
    scene.colliders = {sheet};
    EXPECT_TRUE(Session::create(scene, *device, {}));
    BodyParams body;
    body.position = vec3(0.5F);
    scene.bodies = {body};
    const auto session = Session::create(scene, *device, {});
    ASSERT_FALSE(session);
    EXPECT_EQ(session.error().fault, Fault::badInput);
    EXPECT_NE(session.error().message.find("colliders[0]"), std::string::npos) << session.error().message;
    scene.colliders[0].wave.amplitude = 0;
    EXPECT_TRUE(Session::create(scene, *device, {}));
}

}  // namespace
}  // namespace rivulet::bodies_test
