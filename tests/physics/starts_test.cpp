// The water of a world at t = 0: shapes and velocities of blocks, layers beside walls, meshes, placed particles; against formulas of
// geometry and mechanics.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "engine/scene/import_model.h"
#include "engine/scene/transform.h"
#include "fluid/session/session.h"
#include "fluid/sim/sources/block.h"
#include "fluid/sim/world/start_surface.h"
#include "tests/physics/worlds.h"
#include "tests/unit/mesh_volume.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::starts_test {
namespace {

std::vector<NewParticle> filled(const BlockParams& block, float spacing) {
    std::vector<NewParticle> made;
    fillBlock(block, spacing, made);
    return made;
}

// m^3, of all particles
double volumeOf(const std::vector<NewParticle>& particles, float spacing) {
    return static_cast<double>(particles.size()) * std::pow(double{spacing}, 3);
}

class Shapes : public testing::TestWithParam<const char*> {
  protected:
    int axis() const { return GetParam()[0] - 'x'; }
    // Half its width, half its depth, its height along the axis, m.
    BlockParams block(const char* shape, float a, float b, float height) const {
        BlockParams p{.min = vec3(0.3F, -0.2F, 1.0F), .shape = shape, .axis = GetParam()};
        p.max = p.min;
        p.max[axis()] += height;
        p.max[(axis() + 1) % 3] += 2 * a;
        p.max[(axis() + 2) % 3] += 2 * b;
        return p;
    }
};

// Radii that are no multiples of the spacing, too: the sites within the ellipse would be up to 0.7 % too many.
TEST_P(Shapes, ACylinderHasItsVolume) {
    constexpr float spacing = 0.01F;
    for (float radius = 0.19F; radius < 0.26F; radius += 0.0013F) {
        const BlockParams b = block("cylinder", radius, 1.2F * radius, 0.3F);
        const std::vector<NewParticle> made = filled(b, spacing);
        EXPECT_NEAR(volumeOf(made, spacing) / (double{kPi} * radius * 1.2 * radius * 0.3), 1, 0.001) << radius;
        const vec3 middle = 0.5F * (b.min + b.max);
        for (const NewParticle& p : made) {
            vec3 r = (p.position - middle) / (0.5F * (b.max - b.min) + 0.25F * spacing);
            EXPECT_LT(std::abs(r[axis()]), 1);
            r[axis()] = 0;
            ASSERT_LT(glm::length(r), 1) << "a particle is a quarter of a spacing outside";
        }
    }
}

// Its volume, and its centre of mass at a quarter of its height above the base.
TEST_P(Shapes, AConeHasItsVolumeAndCentreOfMass) {
    constexpr float spacing = 0.01F;
    for (const float radius : {0.2F, 0.2037F, 0.2471F}) {
        const BlockParams b = block("cone", radius, 0.9F * radius, 0.4F);
        const std::vector<NewParticle> made = filled(b, spacing);
        EXPECT_NEAR(volumeOf(made, spacing) / (double{kPi} * radius * 0.9 * radius * 0.4 / 3), 1, 0.001) << radius;
        dvec3 sum(0.0);
        for (const NewParticle& p : made) sum += dvec3(p.position);
        const dvec3 centre = sum / static_cast<double>(made.size());
        dvec3 expected = 0.5 * (dvec3(b.min) + dvec3(b.max));
        expected[axis()] = double{b.min[axis()]} + 0.1;
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(centre[k], expected[k], 0.001) << k;
    }
}

INSTANTIATE_TEST_SUITE_P(EachAxis, Shapes, testing::Values("x", "y", "z"));

// A cylinder that turns about its axis and moves: momentum m v, angular momentum and energy of a rigid body with I = m r^2 / 2.
TEST(Start, SpinIsARigidRotation) {
    constexpr float spacing = 0.01F, radius = 0.2F, rate = 7;
    const BlockParams b{.min = vec3(0.1F),
                        .max = vec3(0.1F + 2 * radius, 0.3F, 0.1F + 2 * radius),
                        .velocity = vec3(1, -2, 0.5F),
                        .shape = "cylinder",
                        .spin = vec3(0, rate, 0)};
    const dvec3 middle = 0.5 * dvec3(b.min + b.max);
    const std::vector<NewParticle> made = filled(b, spacing);
    const auto mass = static_cast<double>(made.size());
    dvec3 momentum(0.0), turning(0.0);
    double energy = 0;
    for (const NewParticle& p : made) {
        momentum += dvec3(p.velocity);
        const dvec3 u = dvec3(p.velocity) - dvec3(b.velocity);
        turning += glm::cross(dvec3(p.position) - middle, u);
        energy += 0.5 * glm::dot(u, u);
    }
    const double inertia = 0.5 * mass * radius * radius;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(momentum[k] / mass, double{b.velocity[k]}, 0.002 * radius * rate);
    EXPECT_NEAR(turning.y / (inertia * rate), 1, 0.005);
    EXPECT_LT(std::max(std::abs(turning.x), std::abs(turning.z)), 0.005 * turning.y);
    EXPECT_NEAR(energy / (0.5 * inertia * rate * rate), 1, 0.005);
    const double rim = glm::length(vec3(1, 0, 0.5F)) + std::sqrt(2.0) * radius * rate;
    EXPECT_LT(fastestOf(b), std::hypot(rim, 2)) << "a corner of the box is the fastest point that a block can have";
    for (const NewParticle& p : made) EXPECT_LE(glm::length(p.velocity), fastestOf(b));
}

// The velocity along each axis, fitted by least squares over the particles: the slope is the requested gradient. Each row is its own.
TEST(Start, GradientsAreThoseOfTheVelocity) {
    const BlockParams b{.min = vec3(-0.1F, 0.2F, 0.3F),
                        .max = vec3(0.3F, 0.5F, 0.5F),
                        .velocity = vec3(0.5F, 0, -1),
                        .jitter = 0,
                        .gradientX = vec3(0, 3, -1),
                        .gradientY = vec3(2, 0.5F, 4),
                        .gradientZ = vec3(-5, 1, -0.5F)};
    const std::vector<NewParticle> made = filled(b, 0.02F);
    const vec3 rows[] = {b.gradientX, b.gradientY, b.gradientZ};
    for (int of = 0; of < 3; ++of) {
        double mean = 0;
        for (const NewParticle& p : made) mean += double{p.velocity[of]} / static_cast<double>(made.size());
        EXPECT_NEAR(mean, double{b.velocity[of]}, 1e-4);
        for (int along = 0; along < 3; ++along) {
            double product = 0, square = 0;
            for (const NewParticle& p : made) {
                const double r = double{p.position[along]} - 0.5 * double{b.min[along] + b.max[along]};
                product += r * double{p.velocity[of]};
                square += r * r;
            }
            EXPECT_NEAR(product / square, double{rows[of][along]}, 1e-3) << of << along;
        }
    }
}

// The world starts with this motion: its energy is that of the rotation, and its steps are short enough for the fastest particle.
TEST(Start, AWorldStartsWithTheSpinOfItsBlock) {
    FluidParams p;
    p.spacing = 0.02F;
    p.gravity = vec3(0.0F);
    p.blocks = {{.min = vec3(0.3F), .max = vec3(0.7F), .jitter = 0, .shape = "cylinder", .spin = vec3(0, 10, 0)}};
    auto device = cpu();
    auto world = makeWorld(*device, p);
    EXPECT_GE(world->fastestFall(), 2) << "the rim, 0.2 m from the axis";
    const double mass = static_cast<double>(world->particles().count) * 1000 * 8.0e-6;
    world->step({}, 1.0e-4);
    EXPECT_NEAR(world->stats().kinetic / (0.25 * mass * 0.04 * 100), 1, 0.02);
    EXPECT_NEAR(world->stats().maxSpeed, 2, 0.05);
    world->reset();
    world->step({}, 1.0e-4);
    EXPECT_NEAR(world->stats().maxSpeed, 2, 0.05);
}

// A tank of triangles keeps every particle of a block that is flush with its floor and walls: as one sheet, with walls that have a
// thickness, standing still and turned as a rigid solid. A block that reaches further loses the layer that is too near.
TEST(Start, ABlockFlushWithAMeshKeepsItsLayer) {
    constexpr float spacing = 0.02F;
    test::Mesh sheet = test::makeBox(vec3(0.2F, 0.1F, 0.2F), vec3(0.8F, 0.7F, 0.8F));
    sheet.indices.resize(36);
    // Without its two triangles of the top: both have all corners at 0.7 m.
    std::vector<uint32_t> open;
    for (size_t t = 0; t < sheet.indices.size(); t += 3)
        if (std::any_of(&sheet.indices[t], &sheet.indices[t] + 3, [&](uint32_t i) { return sheet.positions[i].y < 0.6F; }))
            open.insert(open.end(), &sheet.indices[t], &sheet.indices[t] + 3);
    ASSERT_EQ(open.size(), 30U);
    sheet.indices = open;
    test::Mesh thick;
    const auto wall = [&thick](const vec3& low, const vec3& high) {
        const test::Mesh box = test::makeBox(low, high);
        for (size_t t = 0; t < box.indices.size(); t += 3)
            thick.triangle(box.positions[box.indices[t]], box.positions[box.indices[t + 1]], box.positions[box.indices[t + 2]]);
    };
    wall(vec3(0.15F, 0.05F, 0.15F), vec3(0.85F, 0.1F, 0.85F));
    wall(vec3(0.15F, 0.05F, 0.15F), vec3(0.2F, 0.7F, 0.85F));
    wall(vec3(0.8F, 0.05F, 0.15F), vec3(0.85F, 0.7F, 0.85F));
    wall(vec3(0.15F, 0.05F, 0.15F), vec3(0.85F, 0.7F, 0.2F));
    wall(vec3(0.15F, 0.05F, 0.8F), vec3(0.85F, 0.7F, 0.85F));
    auto device = cpu();
    FluidParams p;
    p.spacing = spacing;
    p.blocks = {{.min = vec3(0.2F, 0.1F, 0.2F), .max = vec3(0.8F, 0.5F, 0.8F)}};
    for (const test::Mesh* mesh : {&sheet, &thick}) {
        const MeshView view = mesh->view();
        for (const int resolution : {142, 151, 200}) {  // voxels of at most a quarter of a spacing, at several offsets
            auto field = bakeVoxelField(std::span(&view, 1), {.resolution = resolution, .band = 2 * spacing, .padding = 2 * spacing});
            ASSERT_TRUE(field) << field.error().message;
            EXPECT_EQ(makeWorld(*device, p, {.field = &*field})->particles().count, 30U * 20U * 30U) << resolution;
        }
    }
    const MeshView view = sheet.view();
    auto field = bakeVoxelField(std::span(&view, 1), {.resolution = 120, .band = 2 * spacing, .padding = 2 * spacing});
    const Pose turned{vec3(1.0F, 0, 0), glm::angleAxis(-0.5F * kPi, vec3(0, 1, 0))};  // x, z -> 1 - z, x
    EXPECT_EQ(makeWorld(*device, p, {.rigid = {{&*field, turned}}})->particles().count, 30U * 20U * 30U);
    FluidParams wider = p;
    wider.blocks[0].max.x += 0.5F * spacing;  // the lattice is centred in the block
    EXPECT_EQ(makeWorld(*device, wider, {.field = &*field})->particles().count, 29U * 20U * 30U) << "half the rest distance from the wall";
    auto world = makeWorld(*device, p, {.field = &*field});
    for (int frame = 0; frame < 10; ++frame) world->step({.gravity = p.gravity}, 1.0 / 60);
    EXPECT_EQ(world->stats().lost, 0U);
    for (const vec4& x : device->readAll<vec4>(*world->particles().position, world->particles().count)) {
        EXPECT_GT(x.y, 0.1F);
        EXPECT_TRUE(x.x > 0.2F && x.x < 0.8F && x.z > 0.2F && x.z < 0.8F);
    }
}

// The same beside a plane that floats round: its places are no multiples of the spacing.
TEST(Start, ABlockFlushWithAPlaneKeepsItsLayer) {
    auto device = cpu();
    for (float height = 0.1F; height < 0.3F; height += 0.0137F) {
        FluidParams p;
        p.spacing = 0.02F;
        p.blocks = {{.min = vec3(0.2F, height, 0.2F), .max = vec3(0.6F, height + 0.2F, 0.6F)}};
        EXPECT_EQ(makeWorld(*device, p, {.planes = {{.position = vec3(0, height, 0)}}})->particles().count, 20U * 10U * 20U) << height;
    }
}

// Corners of the triangles of a mesh, as Sources::blockTriangles.
std::vector<vec3> cornersOf(const test::Mesh& mesh) {
    std::vector<vec3> corners;
    for (const uint32_t i : mesh.indices) corners.push_back(mesh.positions[i]);
    return corners;
}

// The particles have the volume of the mesh, at about 20 spacings a radius: of a ball, as given and inverted; of a knotted tube.
TEST(Start, AMeshIsFilledWithItsVolume) {
    test::Mesh inverted = test::makeSphere(vec3(0.5F), 0.4F, 48);
    for (size_t t = 0; t < inverted.indices.size(); t += 3) std::swap(inverted.indices[t], inverted.indices[t + 1]);
    const test::Mesh knot = test::readObj(test::testMesh("generated/trefoil_tube.obj"));
    for (const test::Mesh& mesh : {test::makeSphere(vec3(0.5F), 0.4F, 48), inverted, knot}) {
        Bounds bounds;
        for (const vec3& p : mesh.positions) bounds.add(p);
        const vec3 size = bounds.size();
        const double volume = std::abs(volumeOf(mesh.view()));
        for (const float spacing : {0.1F * static_cast<float>(std::cbrt(volume)) / 3, 0.029F * static_cast<float>(std::cbrt(volume))}) {
            std::vector<NewParticle> made;
            fillBlock({.min = bounds.min - 0.3F * spacing, .max = bounds.max + 0.4F * spacing, .shape = "mesh"}, spacing, made,
                      cornersOf(mesh));
            EXPECT_NEAR(volumeOf(made, spacing) / volume, 1, 0.005) << size.x << " " << spacing;
        }
    }
}

// max.y is the level: a ball that is filled to a height has the volume of a spherical cap, and no particle above it or outside.
TEST(Start, AMeshIsFilledToALevel) {
    constexpr float spacing = 0.02F, radius = 0.4F;
    const std::vector<vec3> ball = cornersOf(test::makeSphere(vec3(0.5F), radius, 96));
    for (const float level : {0.3F, 0.5F, 0.72F}) {
        const BlockParams b{.min = vec3(0.1F), .max = vec3(0.9F, level, 0.9F), .shape = "mesh"};
        std::vector<NewParticle> made;
        fillBlock(b, spacing, made, ball);
        const double height = double{level} - 0.1, cap = double{kPi} * height * height * (3 * double{radius} - height) / 3;
        EXPECT_NEAR(volumeOf(made, spacing) / cap, 1, 0.005) << level;
        for (const NewParticle& p : made) {
            EXPECT_LT(p.position.y, level);
            EXPECT_LE(glm::length(p.position - 0.5F), radius);
        }
    }
}

// A scene names the file: the duck, scaled, turned and moved as a collider is, has its volume, about its centroid.
TEST(Start, ASceneFillsTheMeshThatItNames) {
    auto device = cpu();
    SceneFile scene;
    scene.fluid.spacing = 0.015F;
    scene.fluid.box.max = vec3(1.2F);
    scene.fluid.blocks = {{.min = vec3(0.0F),
                           .max = vec3(1.2F),
                           .shape = "mesh",
                           .mesh = "meshes/duck.obj",
                           .fitSize = 1,
                           .position = vec3(0.55F, 0.6F, 0.65F),
                           .rotation = vec3(20, 70, 0)}};
    auto session = Session::create(scene, *device, {});
    ASSERT_TRUE(session) << session.error().message;
    Result<Mesh> duck = importMesh(*findAsset("meshes/duck.obj", ""));
    ASSERT_TRUE(duck);
    const Mesh placed = transformed(*duck, Transform::fitted(duck->bounds(), 1, scene.fluid.blocks[0].position, vec3(20, 70, 0)));
    dvec3 moment(0.0);  // of the tetrahedra below the triangles
    for (size_t t = 0; t < placed.indices.size(); t += 3) {
        const dvec3 a(placed.positions[placed.indices[t]]), b(placed.positions[placed.indices[t + 1]]),
            c(placed.positions[placed.indices[t + 2]]);
        moment += glm::dot(a, glm::cross(b, c)) / 24 * (a + b + c);
    }
    const double volume = volumeOf(placed.view());
    const uint32_t count = (*session)->world().particles().count;
    EXPECT_NEAR(count * std::pow(0.015, 3) / volume, 1, 0.005);
    dvec3 sum(0.0);
    for (const vec4& x : device->readAll<vec4>(*(*session)->world().particles().position, count)) sum += dvec3(x);
    EXPECT_LT(glm::length(sum / static_cast<double>(count) - moment / volume), 0.003);
    scene.fluid.blocks[0].mesh = "meshes/swan.obj";
    auto none = Session::create(scene, *device, {});
    ASSERT_FALSE(none);
    EXPECT_NE(none.error().message.find("meshes/swan.obj does not exist"), std::string::npos) << none.error().message;
}

FluidParams emptyBox() {
    FluidParams p;
    p.spacing = 0.05F;
    return p;
}

Sources placing(std::vector<NewParticle> particles) {
    Sources s;
    s.particles = std::move(particles);
    return s;
}

// Particles that a host places are where it placed them, beside those of a block, and again after a reset. One that falls freely has
// v + g t and x + v t + g t^2 / 2.
TEST(Start, PlacedParticlesStartAndFall) {
    auto device = cpu();
    FluidParams p = emptyBox();
    p.box.max.y = 3;
    p.blocks = {{.max = vec3(0.2F)}};  // 64 particles
    const vec3 at(0.5F, 2.5F, 0.6F), v(0.3F, 0.1F, -0.2F);
    auto made = FluidWorld::create(*device, p, {}, {}, placing({{at, v}, {vec3(0.9F, 0.025F, 0.9F)}}));
    ASSERT_TRUE(made) << made.error().message;
    FluidWorld& world = **made;
    ASSERT_EQ(world.particles().count, 66U);
    // The highest of all.
    const auto placed = [&](const Buffer& of) {
        const std::vector<vec4> x = device->readAll<vec4>(*world.particles().position, 66), all = device->readAll<vec4>(of, 66);
        return vec3(all[static_cast<size_t>(std::max_element(x.begin(), x.end(), [](auto& a, auto& b) { return a.y < b.y; }) - x.begin())]);
    };
    for (int turn = 0; turn < 2; ++turn) {
        EXPECT_EQ(placed(*world.particles().position), at);
        EXPECT_EQ(placed(*world.particles().velocity), v);
        EXPECT_GE(world.fastestFall(), std::sqrt(2 * 9.81F * 2.5F)) << "it falls to the bottom of the box";
        constexpr float t = 0.25F;
        for (int frame = 0; frame < 15; ++frame) world.step({.gravity = p.gravity}, double{t} / 15);
        const vec3 now = placed(*world.particles().position), fallen = at + v * t + 0.5F * p.gravity * t * t;
        EXPECT_LT(glm::length(now - fallen), 0.01F) << now.x << " " << now.y << " " << now.z;
        EXPECT_LT(glm::length(placed(*world.particles().velocity) - (v + p.gravity * t)), 0.02F);
        world.reset();
    }
}

// What cannot be placed is refused by number, with the remedy; what is inside a mesh is left out.
TEST(Start, PlacedParticlesThatCannotBeAreRefused) {
    auto device = cpu();
    const auto refusal = [&](const FluidParams& p, std::vector<NewParticle> particles) {
        auto made = FluidWorld::create(*device, p, {}, {}, placing(std::move(particles)));
        return made ? std::string() : made.error().message;
    };
    FluidParams p = emptyBox();
    EXPECT_EQ(
        refusal(p, {{vec3(0.5F)}, {vec3(0.5F, 1.5F, 0.5F)}}),
        "particles[1] at (0.5, 1.5, 0.5) m is outside fluid.box from (0, 0, 0) to (1, 1, 1) m: move it into the box, or enlarge the box");
    EXPECT_TRUE(refusal(p, {{vec3(0.5F, NAN, 0.5F)}}).starts_with("particles[0] has the position (0.5, nan, 0.5) m"));
    for (const float speed : {INFINITY, 2 * kMostSpeed})
        EXPECT_NE(refusal(p, {{vec3(0.5F), vec3(speed, 0, 0)}}).find("give finite numbers, and at most"), std::string::npos);
    p.maxParticles = 1;
    EXPECT_TRUE(refusal(p, {{vec3(0.4F)}, {vec3(0.6F)}}).starts_with("fluid.maxParticles is 1, but the world starts with 2 particles"));
    p.blocks = {{.max = vec3(1.0F), .shape = "mesh"}};
    EXPECT_TRUE(refusal(p, {}).starts_with("fluid.blocks[0].shape is mesh, and no triangles are given for it"));

    const test::Mesh ball = test::makeSphere(vec3(0.5F), 0.3F, 24);
    const MeshView view = ball.view();
    auto field = bakeVoxelField(std::span(&view, 1), {.resolution = 64, .band = 0.1F, .padding = 0.1F});
    ASSERT_TRUE(field);
    auto world = FluidWorld::create(*device, emptyBox(), {.field = &*field}, {}, placing({{vec3(0.5F)}, {vec3(0.5F, 0.81F, 0.5F)}}));
    ASSERT_TRUE(world) << world.error().message;
    EXPECT_EQ((*world)->particles().count, 1U) << "the one beside it stays, nearer than its rest distance";
}

// ---- a free surface at the start ----

TEST(FreeSurface, IsWhereOneMoreParticleHasRoom) {
    FluidParams p;
    p.spacing = 0.1F;
    const auto surface = [&](const vec3& size, const vec3& water, const std::function<bool(const vec3&)>& may) {
        p.box.max = size;
        std::vector<NewParticle> start;
        fillBlock({vec3(0.0F), water, vec3(0.0F)}, p.spacing, start);
        return hasFreeSurface(start, p, may);
    };
    const auto anywhere = [](const vec3&) { return true; };
    EXPECT_FALSE(surface(vec3(1.0F), vec3(1.0F), anywhere)) << "full";
    EXPECT_TRUE(surface(vec3(1.0F), vec3(1.0F, 0.8F, 1.0F), anywhere)) << "a pool";
    EXPECT_FALSE(surface(vec3(1.0F, 1.08F, 1.0F), vec3(1.0F), anywhere)) << "a gap that holds no layer";
    EXPECT_TRUE(surface(vec3(1.0F, 1.12F, 1.0F), vec3(1.0F), anywhere)) << "a gap that holds one";
    EXPECT_FALSE(surface(vec3(1.0F, 1.5F, 1.0F), vec3(1.0F), [](const vec3& x) { return x.y < 1.0F; })) << "under a lid";
    p.box.periodicY = true;
    EXPECT_FALSE(surface(vec3(1.0F), vec3(1.0F), anywhere)) << "full and periodic";
    EXPECT_TRUE(surface(vec3(1.0F), vec3(1.0F, 0.8F, 1.0F), anywhere)) << "a film across a periodic axis";
}

}  // namespace
}  // namespace rivulet::starts_test
