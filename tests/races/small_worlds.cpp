#include "tests/races/small_worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string_view>

#include "fluid/scene/solids_bullet.h"
#include "fluid/session/session.h"
#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/host_particles.h"
#include "fluid/voxel/voxelize_depth.h"
#include "fluid/voxel/voxelize_solid.h"
#include "fluid/voxel/voxelize_surface.h"
#include "shaders/fluid/solids/body_state.h"
#include "shaders/fluid/world/step_params.h"
#include "tests/parity/touching.h"
#include "tests/physics/baked_mesh.h"
#include "tests/physics/loads.h"
#include "tests/races/small_worlds_parts.h"

namespace rivulet::races {

namespace {

Answer particlesAfter(Device& device, const FluidParams& p, const Solids& solids = {}, int steps = 2) {
    auto world = make(device, p, solids);
    Answer a;
    if (!world) return a;
    for (int k = 0; k < steps; ++k) step(*world);
    addParticles(*world, a.exact);
    return a;
}

Answer wcsph(Device& device) {
    FluidParams p = column("wcsph");
    p.kernel = "cubic_spline";
    p.forces.tension = p.forces.adhesion = 0.07F;
    p.forces.airDrag = 0.5F;
    p.forces.wind = vec3(1, 0, 0);
    return particlesAfter(device, p);
}
Answer thesis(Device& device) {
    FluidParams p = column("wcsph_thesis");
    p.forces.normals = "thesis";
    p.forces.thesisTension = 1;
    return particlesAfter(device, p);
}
// Water that holds together under negative pressure, drawn between steps of a fixed length.
Answer shifted(Device& device) {
    FluidParams p = column("dfsph");
    p.dfsph.negativePressure = true;
    p.fixedStep = static_cast<float>(kStep);
    Answer a;
    auto world = make(device, p);
    if (!world) return a;
    for (int k = 0; k < 3; ++k) step(*world, {}, 1.3 * kStep);
    addParticles(*world, a.exact);
    const ParticleView view = world->particles();
    EXPECT_NE(view.drawn, nullptr);
    return a;
}
// The order within a list of a cell is that of the atomics: sums have other roundings.
Answer linkedLists(Device& device) {
    FluidParams p = column("wcsph_thesis");
    p.grid = "linked_list";
    Answer exact = particlesAfter(device, p), a;
    a.near = exact.exact;
    a.within = 1.0e-4;
    return a;
}
Answer dfsph(Device& device) {
    FluidParams p = column("dfsph");
    p.collision.walls = "no-slip";
    p.viscosity = 1.0e-3F;
    p.forces.viscosity = "explicit";
    return particlesAfter(device, p);
}
Answer implicitViscosity(Device& device) {
    FluidParams p = column("dfsph");
    p.viscosity = 0.05F;
    p.forces.viscosity = "implicit";
    p.collision.walls = "no-slip";
    p.forces.viscosityTolerance = 1.0e-3F;
    return particlesAfter(device, p);
}
Answer pbf(Device& device) {
    FluidParams p = column("pbf");
    p.ellipsoids = true;
    p.forces.vorticity = 0.1F;
    p.pbf.tolerance = 0.001F;
    return particlesAfter(device, p);
}
Answer periodic(Device& device) {
    FluidParams p = column("dfsph");
    p.box.max = vec3(0.6F);
    p.box.periodicX = p.box.periodicZ = true;
    Answer all = particlesAfter(device, p);
    p = column("wcsph");
    p.box = {.max = vec3(0.6F), .periodicX = true, .periodicY = true, .periodicZ = true};
    p.gravity = vec3(0.0F);
    const Answer closed = particlesAfter(device, p);
    all.exact.insert(all.exact.end(), closed.exact.begin(), closed.exact.end());
    // A box so large that the grid covers a part of it and follows the water.
    p = column("dfsph");
    p.box.max = vec3(20.0F);
    p.blocks[0].min += vec3(10, 0, 10);
    p.blocks[0].max += vec3(10, 0, 10);
    const Answer wide = particlesAfter(device, p);
    all.exact.insert(all.exact.end(), wide.exact.begin(), wide.exact.end());
    return all;
}
Answer liquids(Device& device) {
    FluidParams p = column("dfsph");
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.3F, 0.15F, 0.3F)}, {.min = vec3(0.0F, 0.15F, 0.0F), .max = vec3(0.3F), .liquid = "oil"}};
    p.blocks[0].dye = vec3(1, 0, 0);
    return particlesAfter(device, p);
}

// A slope, an obstacle, a paddle and, of which the loads are sums in any order, a ball; probes measure all.
Answer solids(Device& device, const char* method, bool ball) {
    FluidParams p = column(method);
    p.viscosity = 1.0e-3F;
    p.forces.viscosity = "explicit";
    p.forces.adhesion = 0.2F;
    p.collision.walls = "no-slip";
    p.collision.friction = 0.1F;
    const VoxelField obstacle = test::baked(test::makeBox(vec3(0.35F, -0.1F, 0.05F), vec3(0.45F, 0.1F, 0.2F)), 0.025F, kSpacing),
                     paddle = test::baked(test::makeBox(vec3(-0.05F, -0.2F, -0.3F), vec3(0.05F, 0.2F, 0.3F)), 0.025F, kSpacing);
    Solids s{
        .field = &obstacle, .planes = {{vec3(0.0F, 0.02F, 0.1F), vec3(0.05F, 1.0F, 0.1F)}}, .rigid = {{&paddle, {vec3(0.4F, 0.3F, 0.1F)}}}};
    if (ball) {
        s.bodies.resize(1);
        s.bodies[0].shape = sphereShape(2 * kSpacing, 400, kSpacing);
        s.bodies[0].state.pose.position = vec3(0.15F, 0.28F, 0.15F);
    }
    p.probes = test::probesOfAll(s);
    Answer a;
    auto world = make(device, p, s);
    if (!world) return a;
    Pose at = s.rigid[0].pose;
    for (int k = 0; k < 2; ++k) {
        at.position.x -= 0.004F;
        step(*world, {.poses = std::span(&at, 1)});
    }
    if (ball)
        addMeans(*world, a.near);
    else
        addParticles(*world, a.exact);
    for (const ProbeReading& reading : world->stats().loads.probes) add(a.near, 1.0e-3F * vec3(reading.impulse));
    return a;
}
Answer walls(Device& device) { return solids(device, "dfsph", false); }
Answer thesisWalk(Device& device) {
    FluidParams p = column("wcsph_thesis");
    p.collision.walk = "thesis";
    const VoxelField obstacle = test::baked(test::makeBox(vec3(0.35F, -0.1F, 0.05F), vec3(0.45F, 0.1F, 0.2F)), 0.025F, kSpacing);
    return particlesAfter(device, p, {.field = &obstacle});
}
Answer bodiesWcsph(Device& device) { return solids(device, "wcsph", true); }
Answer bodiesPbf(Device& device) { return solids(device, "pbf", true); }
Answer bodiesDfsph(Device& device) { return solids(device, "dfsph", true); }

// A hand pulls at three bodies that a GPU moves. One has a load that is NaN and follows the hand, one a load that would make it impossibly
// fast and one a spin that is NaN: these keep their states.
void addBodies(Device& device, std::vector<float>& to) {
    const Result<Kernel> kernel = device.kernel("fluid/solids/advance_bodies");
    EXPECT_TRUE(kernel) << (kernel ? "" : kernel.error().message);
    if (!kernel) return;
    std::vector<LoadRow> loads(size_t{3} * LOAD_THREADS);
    loads[5].torque.y = NAN;
    loads[LOAD_THREADS].force.x = 1.0e16F;
    std::vector<DeviceBody> bodies(3);
    for (DeviceBody& b : bodies) {
        b.position = vec4(0.1F, 0.2F, 0.3F, 0.0F);
        b.rotation = vec4(0, 0, 0, 1);
    }
    bodies[2].spin.y = NAN;
    const std::vector<BodyMotion> motions(3,
                                          {vec4(1.0F), vec4(0.1F, 0.2F, 0.3F, 1.0F), 0.5F, 10.0F, 3, 0, vec4(0.1F, 0, 0, 30), vec4(200)});
    Result<Buffer> sums = device.allocate(loads.size() * sizeof(LoadRow)), moved = device.allocate(bodies.size() * sizeof(DeviceBody)),
                   by = device.allocate(motions.size() * sizeof(BodyMotion));
    EXPECT_TRUE(sums && by && moved);
    if (!sums || !by || !moved) return;
    device.writeAll<LoadRow>(*sums, loads);
    device.writeAll<DeviceBody>(*moved, bodies);
    device.writeAll<BodyMotion>(*by, motions);
    StepParams step{};
    step.dt = static_cast<float>(kStep);
    step.gravity = vec4(0, -9.81F, 0, 0);
    device.run(*kernel, step, {&*sums, &*by, &*moved}, 3);
    const std::vector<DeviceBody> after = device.readAll<DeviceBody>(*moved, 3);
    const vec3 way = vec3(200.0F) - vec3(0.2F, 0.2F, 0.3F);  // so far that the hand pulls as hard as it does at most, 200 m/s^2
    EXPECT_NEAR(after[0].velocity.y, 200 * way.y / glm::length(way) * step.dt, 1.0e-6F);
    EXPECT_NEAR(glm::length(after[0].rotation), 1, 1.0e-6F);
    EXPECT_EQ(after[0].faults, 0U);
    for (size_t k = 1; k < 3; ++k) {
        EXPECT_EQ(after[k].position, bodies[k].position);
        EXPECT_EQ(after[k].rotation, bodies[k].rotation);
        EXPECT_EQ(after[k].faults, BODY_MISLED);
    }
    for (const DeviceBody& b : after) add(to, b.position);
}

// Three boxes in a stack beside a ball, on the floor of the column's tank and in each other's way. Few frames are enough to have contacts
// and impulses of the frame before.
Answer bodiesTouch(Device& device) {
    FluidParams p = column("pbf");
    Solids s;
    std::vector<BodyForm> forms(4);
    for (size_t k = 0; k < forms.size(); ++k) {
        s.bodies.emplace_back();
        Body& b = s.bodies.back();
        const bool ball = k == 3;
        b.shape = ball ? sphereShape(0.05F, 700, kSpacing) : boxShape(vec3(0.1F), 500, kSpacing);
        b.state.pose.position = ball ? vec3(0.35F, 0.05F, 0.1F) : vec3(0.44F, 0.05F + 0.1F * static_cast<float>(k), 0.15F);
        b.state.velocity = ball ? vec3(0.5F, 0, 0) : vec3(0.0F);
        forms[k].kind = ball ? BodyForm::Kind::sphere : BodyForm::Kind::box;
        forms[k].size = vec3(0.1F);
        forms[k].radius = 0.05F;
    }
    BulletSolids contacts({.box = p.box, .planes = {}, .still = {}, .moving = {}, .poses = {}}, s.bodies, forms);
    s.bodyHost = contacts.host();
    Answer a;
    auto world = make(device, p, s);
    if (!world) return a;
    for (int k = 0; k < 3; ++k) step(*world);
    EXPECT_TRUE(device.backend() == Backend::cpu || world->stats().bodyWaits == 0);
    for (const BodyState& state : world->bodies()) {
        add(a.near, state.pose.position);
        add(a.near, state.velocity);
    }
    addMeans(*world, a.near);
    return a;
}

// A body whose state is NaN is a wall to those that touch it, whatever the order of the work items.
void addTouching(Device& device, std::vector<float>& to) {
    Touching t;
    t.step.dt = static_cast<float>(kStep);
    t.step.gravity = vec4(0, -9.81F, 0, 0);
    t.bodies.resize(6);
    for (uint32_t k = 0; k < 6; ++k) {
        t.bodies[k].shape = boxShape(vec3(0.1F), 500, kSpacing);
        t.bodies[k].state.pose.position = vec3(0, 0.1F * static_cast<float>(k), 0);
        if (k == 0) continue;
        BodyContact c;
        c.a = k;
        c.b = k - 1;
        c.onA = vec3(0.01F, -0.05F, 0);
        c.onB = vec3(0.01F, 0.05F, 0);
        c.normal = vec3(0, 1, 0);
        t.contacts.push_back(c);
    }
    t.bodies[2].state.spin.y = NAN;
    const std::vector<DeviceBody> after = t.run(device);
    EXPECT_EQ(after[2].faults, BODY_MISLED);
    for (const DeviceBody& b : after) {
        EXPECT_TRUE(std::isfinite(b.position.y + b.velocity.x + b.velocity.y + b.rotation.x));
        add(to, b.position);
        add(to, b.velocity);
    }
    EXPECT_NEAR(after[3].velocity.y, 0, 5.0e-3F) << "it stands on that, as far as one substep finds out; else it falls at 0.04 m/s";
}

// In each method one particle becomes NaN: it is counted, all others go on and meet the walls. So do bodies.
Answer lost(Device& device) {
    constexpr uint32_t kLost = 77;
    const VoxelField obstacle = test::baked(test::makeBox(vec3(0.35F, -0.1F, 0.05F), vec3(0.45F, 0.1F, 0.2F)), 0.025F, kSpacing);
    Answer a;
    for (const char* method : {"pbf", "dfsph", "wcsph"}) {
        auto world = make(device, column(method), {.field = &obstacle, .planes = {{vec3(0.0F, 0.02F, 0.1F), vec3(0.05F, 1.0F, 0.1F)}}});
        if (!world) return a;
        step(*world);
        const ParticleView view = world->particles();
        const std::vector<uint32_t> ids = device.readAll<uint32_t>(*view.id, view.count);
        const auto slot = static_cast<size_t>(std::find(ids.begin(), ids.end(), kLost) - ids.begin());
        const vec4 nowhere(NAN, 0.1F, NAN, 1.0F);
        device.write(const_cast<Buffer&>(*view.position), std::as_bytes(std::span(&nowhere, 1)), slot * sizeof(vec4));
        const size_t before = readParticles(*world).id.size();
        for (int k = 0; k < 2; ++k) step(*world);
        const HostParticles all = readParticles(*world);
        std::vector<std::pair<uint32_t, vec3>> at;
        for (size_t k = 0; k < all.id.size(); ++k)
            if (all.id[k] != kLost) at.emplace_back(all.id[k], vec3(all.position[k]));
        std::sort(at.begin(), at.end(), [](const auto& one, const auto& other) { return one.first < other.first; });
        size_t wild = 0;
        for (const auto& [id, x] : at) {
            wild += std::isfinite(x.x + x.y + x.z) ? 0 : 1;
            add(a.exact, x);
        }
        EXPECT_EQ(wild, 0U) << "particles that have become NaN by one that is, " << method;
        EXPECT_EQ(at.size(), before - 1) << method;
        const auto stats = world->stats();
        EXPECT_EQ(stats.lost, 1U) << method;
        EXPECT_EQ(stats.nan, 1U) << method;
    }
    addBodies(device, a.exact);
    if (device.backend() != Backend::cpu) addTouching(device, a.exact);
    return a;
}

void addBits(const std::vector<uint8_t>& bits, std::vector<float>& to) {
    for (const uint8_t byte : bits) to.push_back(static_cast<float>(byte));
}
Answer voxels(Device& device) {
    Answer a;
    for (const test::Mesh& mesh : {test::makeSphere(vec3(0.1F, -0.2F, 0.3F), 1.0F, 6), test::makeJumble(1, 24)}) {
        const MeshView view = mesh.view();
        VoxelGrid surface = test::gridAround(mesh, 12), solid = surface;
        const Status onSurface = voxelizeSurface(device, GridTriangles(std::span(&view, 1), surface), surface),
                     inside = voxelizeSolid(device, cleanMesh(std::span(&view, 1)), solid);
        EXPECT_TRUE(onSurface) << (onSurface ? "" : onSurface.error().message);
        EXPECT_TRUE(inside) << (inside ? "" : inside.error().message);
        const Result<DepthVoxels> depth = voxelizeDepth(device, std::span(&view, 1), test::gridAround(mesh, 12), {});
        EXPECT_TRUE(depth) << (depth ? "" : depth.error().message);
        addBits(surface.bits, a.exact);
        addBits(solid.bits, a.exact);
        if (depth) addBits(depth->surface.bits, a.exact);
    }
    return a;
}

// A scene of assets/scenes, made coarse.
Answer scene(Device& device, const char* name, const std::vector<std::string>& settings, int frames) {
    Answer a;
    auto file = loadScene(name, settings);
    EXPECT_TRUE(file) << (file ? "" : file.error().message);
    if (!file) return a;
    auto session = Session::create(*file, device, {});
    EXPECT_TRUE(session) << (session ? "" : session.error().message);
    if (!session) return a;
    for (int k = 0; k < frames; ++k) {
        (*session)->step(1.0 / 60, true);
        device.poll();
    }
    addMeans((*session)->world(), a.near);
    if (!(*session)->flows().empty()) {
        const SkinFlows::Ledger ledger = (*session)->flows().ledger();
        for (const double v : {ledger.onSurface, ledger.inAir, ledger.drained}) a.near.push_back(static_cast<float>(1.0e5 * v));
        EXPECT_LT(std::abs(ledger.error), 1.0e-9);
    }
    a.within = 0.01;
    return a;
}
Answer sheet(Device& device) {
    return scene(device, "waving_sheet", {"fluid.spacing=0.05", "colliders.0.resolution=24", "fluid.pbf.minSubsteps=1"}, 2);
}
Answer rain(Device& device) {
    return scene(device, "window_rain", {"flow.0.mapSize=32", "flow.0.liquid.capacity=512", "flow.0.liquid.filmCell=0.006"}, 3);
}

std::string_view fromEnvironment(const char* name) {
    const char* text = std::getenv(name);
    return text != nullptr ? text : "";
}

}  // namespace

bool full() { return fromEnvironment("RIVULET_RACES") == "full"; }
bool someChosen() { return !fromEnvironment("RIVULET_WORLDS").empty(); }
bool chosen(const SmallWorld& world) {
    std::istringstream words{std::string(fromEnvironment("RIVULET_WORLDS"))};
    for (std::string word; words >> word;)
        if (word == world.name) return true;
    return !someChosen();
}

const std::vector<SmallWorld>& smallWorlds() {
    static const std::vector<SmallWorld> worlds = {
        {"wcsph", wcsph},
        {"thesis", thesis},
        {"linkedLists", linkedLists, false},
        {"dfsph", dfsph},
        {"implicitViscosity", implicitViscosity},
        {"pbf", pbf},
        {"shifted", shifted},
        {"periodic", periodic},
        {"liquids", liquids},
        {"walls", walls},
        {"thesisWalk", thesisWalk},
        {"bodiesWcsph", bodiesWcsph},
        {"bodiesPbf", bodiesPbf},
        {"bodiesDfsph", bodiesDfsph},
        {"bodiesTouch", bodiesTouch},
        {"sources", sources},
        {"foam", foam},
        {"sleep", sleep},
        {"wetness", wetness},
        {"queries", queries},
        {"lost", lost},
        {"voxels", voxels},
        {"skin", skin},
        {"flow", flow},
        {"flowWithoutTrails", flowWithoutTrails},
        {"thesisFlow", thesisFlow},
        {"sheet", sheet},
        {"rain", rain},
    };
    return worlds;
}

}  // namespace rivulet::races
