// Bodies that are added and removed while the water flows.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/world/host_particles.h"
#include "fluid/validate/draught.h"
#include "tests/physics/baked_mesh.h"
#include "tests/physics/worlds.h"

namespace rivulet::bodies_change_test {
namespace {

constexpr float kSpacing = 0.025F;
constexpr double kFrame = 1.0 / 60;

// A pool of 0.5 x 0.5 m, so deep.
FluidParams pool(float deep = 0.25F) {
    FluidParams p{.method = "pbf"};
    p.spacing = kSpacing;
    p.box.max = vec3(0.5F, 0.8F, 0.5F);
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.5F, deep, 0.5F)}};
    p.maxBodySamples = 2000;
    return p;
}

Body boxAt(const vec3& place, const vec3& size, double density) {
    Body body;
    body.shape = boxShape(size, density, kSpacing);
    body.state.pose.position = place;
    return body;
}

void run(FluidWorld& world, int frames) {
    for (int k = 0; k < frames; ++k) world.step({}, kFrame);
}
std::vector<vec4> waterOf(const FluidWorld& world) { return readParticles(world).position; }
uint32_t add(FluidWorld& world, const Body& body) {
    const Result<uint32_t> id = world.addBody(body);
    EXPECT_TRUE(id) << (id ? "" : id.error().message);
    return id ? *id : UINT32_MAX;
}
void expectRefused(const Status& status, const char* part) {
    ASSERT_FALSE(status);
    EXPECT_NE(status.error().message.find(part), std::string::npos) << status.error().message;
}
void expectRefused(const Result<uint32_t>& id, const char* part) {
    ASSERT_FALSE(id);
    EXPECT_NE(id.error().message.find(part), std::string::npos) << id.error().message;
}
bool sameStates(const std::vector<BodyState>& a, const std::vector<BodyState>& b, size_t count) {
    bool same = true;
    for (size_t k = 0; k < count; ++k)
        same = same && a[k].pose.position == b[k].pose.position && a[k].pose.rotation == b[k].pose.rotation &&
               a[k].velocity == b[k].velocity && a[k].spin == b[k].spin;
    return same;
}

// Thrown into a pool that has run for a while, a body displaces the water that weighs as much as it does (Archimedes).
TEST(BodiesChange, AnAddedBodyFloatsAtTheDraughtOfArchimedes) {
    for (const char* method : {"pbf", "dfsph"}) {
        const float s = 0.0125F;
        const vec3 size(12 * s, 8 * s, 12 * s);
        const double height = double{size.y}, ratio = 0.5;
        FluidParams p;
        p.method = method;
        p.spacing = s;
        p.supportSpacings = 2;
        p.box.max = vec3(24 * s, 0.4F, 24 * s);
        p.box.periodicX = p.box.periodicZ = true;
        p.cfl = 0.8F;
        p.artificialViscosity = 0.05F;
        p.maxBodySamples = 1000;
        p.blocks = {{.min = vec3(0.0F), .max = vec3(p.box.max.x, 10 * s, p.box.max.z), .jitter = 0}};
        auto device = cpu();
        auto world = makeWorld(*device, p);
        ASSERT_TRUE(world);
        run(*world, 5);
        Body body;
        body.shape = boxShape(size, 1000 * ratio, s);
        body.state.pose.position = vec3(12 * s, 20 * s, 12 * s);
        add(*world, body);
        const size_t before = waterOf(*world).size();
        const double area = double{p.box.max.x * p.box.max.z};
        Floater floater{height, double{size.x * size.y * size.z}, 0, false};
        double under = 0;
        constexpr int kFrames = 110, kLast = 45;
        for (int frame = 0; frame < kFrames; ++frame) {
            run(*world, 1);
            if (frame < kFrames - kLast) continue;
            floater.keel = double{world->bodies()[0].pose.position.y} - 0.5 * height;
            const double top = waterLevel(waterVolume(waterOf(*world), double{s}), area, std::span(&floater, 1));
            under += floater.shareUnder(top - floater.keel) / kLast;
        }
        std::printf("%s: under %.4f, expected %.4f\n", method, under, ratio);
        // As of a body that is there from the start, in water that is no lattice: floating_test.cpp.
        EXPECT_NEAR(under * height / double{s}, ratio * height / double{s}, 0.4) << method << ", of a spacing";
        EXPECT_EQ(waterOf(*world).size(), before) << "no water is lost";
    }
}

// A body that appears in the water takes the place of as much water, and where it was the water closes and comes to rest.
TEST(BodiesChange, WaterMakesRoomAndCloses) {
    auto device = cpu();
    auto world = makeWorld(*device, pool());
    run(*world, 30);
    const vec3 size(0.2F, 0.15F, 0.2F), centre(0.25F, 0.1F, 0.25F);
    const double particle = std::pow(double{kSpacing}, 3);
    const size_t before = waterOf(*world).size();
    const uint32_t id = add(*world, boxAt(centre, size, 0));
    run(*world, 30);
    const std::vector<vec4> around = waterOf(*world);
    const auto grown = [&](double by) { return (double{size.x} + by) * (double{size.y} + by) * (double{size.z} + by); };
    const double gone = static_cast<double>(before - around.size()) * particle;
    EXPECT_GT(gone, grown(-0.5 * double{kSpacing}));
    EXPECT_LT(gone, grown(0.5 * double{kSpacing})) << "each face within a quarter of a spacing";
    EXPECT_NEAR(world->stats().drained, gone, 1.0e-9);
    const auto within = [&](const std::vector<vec4>& all) {
        return std::ranges::count_if(all, [&](const vec4& p) { return glm::all(glm::lessThan(glm::abs(vec3(p) - centre), 0.5F * size)); });
    };
    EXPECT_EQ(within(around), 0);
    EXPECT_LT(world->stats().maxSpeed, 3) << "nothing is thrown out";
    ASSERT_TRUE(world->removeBody(id));
    EXPECT_TRUE(world->bodies().empty());
    run(*world, 100);
    const std::vector<vec4> closed = waterOf(*world);
    EXPECT_EQ(closed.size(), around.size());
    const double level = static_cast<double>(closed.size()) * particle / 0.25;
    const double filled = double{size.x} * size.z * (std::min(level, 0.175) - 0.025);
    EXPECT_NEAR(static_cast<double>(within(closed)) * particle, filled, 0.1 * filled);
    float highest = 0;
    for (const vec4& p : closed) highest = std::max(highest, p.y);
    EXPECT_NEAR(double{highest} + 0.5 * double{kSpacing}, level, 1.5 * double{kSpacing});
    EXPECT_LT(world->stats().kinetic, 1.0e-3 * world->stats().particles * particle * 1000 * 9.81 * 0.25) << "it is at rest";
}

// The motion of the others and of the water does not depend on one that is out of reach, nor on its removal.
TEST(BodiesChange, OthersKeepTheirMotionToTheBit) {
    for (const char* method : {"pbf", "dfsph", "wcsph"}) {
        auto device = cpu();
        FluidParams p = pool(0.1F);
        p.method = method;
        p.soundSpeed = 10;
        const Body first = boxAt(vec3(0.15F, 0.2F, 0.25F), vec3(0.1F), 400), second = boxAt(vec3(0.35F, 0.16F, 0.25F), vec3(0.1F), 300),
                   far = boxAt(vec3(0.25F, 3.0F, 0.25F), vec3(0.1F), 0);
        auto plain = makeWorld(*device, p, {.bodies = {second}}), other = makeWorld(*device, p, {.bodies = {second}});
        run(*plain, 3);
        run(*other, 3);
        const uint32_t id = add(*other, far);
        run(*plain, 5);
        run(*other, 5);
        EXPECT_EQ(other->bodyIds(), (std::vector<uint32_t>{0, id}));
        EXPECT_TRUE(sameStates(plain->bodies(), other->bodies(), 1)) << method;
        add(*plain, first);
        add(*other, first);
        ASSERT_TRUE(other->removeBody(id));
        run(*plain, 5);
        run(*other, 5);
        EXPECT_TRUE(sameStates(plain->bodies(), other->bodies(), 2)) << method;
        EXPECT_TRUE(waterOf(*plain) == waterOf(*other)) << method;
        EXPECT_NE(plain->bodyLoads()[0].force, dvec3(0.0)) << "the water is at the body";
    }
}

// A world that is as full of holes as another one continues its saved state bit for bit; a reset puts added bodies back to where they were
// added, and leaves out the particles of t = 0 inside them.
TEST(BodiesChange, SavesRestoresAndResets) {
    auto device = cpu();
    const FluidParams p = pool();
    const Body a = boxAt(vec3(0.1F, 0.35F, 0.1F), vec3(0.1F), 300), b = boxAt(vec3(0.35F, 0.4F, 0.35F), vec3(0.125F, 0.1F, 0.1F), 600),
               c = boxAt(vec3(0.25F, 0.12F, 0.25F), vec3(0.15F), 0);
    // Samples of the second one begin where those of the first had been, or behind them.
    auto whole = makeWorld(*device, p, {.bodies = {a}}), resumed = makeWorld(*device, p, {.bodies = {b}});
    run(*whole, 2);
    add(*whole, b);
    ASSERT_TRUE(whole->removeBody(0));
    add(*whole, c);
    add(*resumed, c);
    run(*whole, 5);
    run(*resumed, 1);
    WorldState state;
    whole->save(state);
    const Status restored = resumed->restore(state);
    ASSERT_TRUE(restored) << restored.error().message;
    run(*whole, 5);
    run(*resumed, 5);
    EXPECT_TRUE(waterOf(*whole) == waterOf(*resumed));
    EXPECT_TRUE(sameStates(whole->bodies(), resumed->bodies(), 2));
    auto other = makeWorld(*device, p, {.bodies = {b}});
    WorldState again;
    whole->save(again);
    expectRefused(other->restore(again), "2 bodies");

    const size_t all = waterOf(*makeWorld(*device, p)).size();
    whole->reset();
    EXPECT_EQ(whole->bodies()[0].pose.position, b.state.pose.position);
    EXPECT_EQ(whole->bodies()[1].pose.position, c.state.pose.position);
    const std::vector<vec4> start = waterOf(*whole);
    EXPECT_NEAR(static_cast<double>(all - start.size()), std::pow(0.15 / double{kSpacing}, 3), 40);
    for (const vec4& x : start) EXPECT_GT(c.shape.distance(vec3(x) - c.state.pose.position), 0.0F);
    EXPECT_EQ(whole->stats().particles, start.size());
    run(*whole, 20);
    EXPECT_EQ(waterOf(*whole).size(), start.size());
    EXPECT_LT(whole->stats().maxSpeed, 3);
    ASSERT_TRUE(whole->removeBody(whole->bodyIds()[1]));
    whole->reset();
    EXPECT_EQ(waterOf(*whole).size(), all);
}

TEST(BodiesChange, ManyComeAndGo) {
    auto device = cpu();
    const FluidParams p = pool(0.1F);
    auto world = makeWorld(*device, p);
    const Body crate = boxAt(vec3(0.25F, 0.5F, 0.25F), vec3(0.075F), 500);
    const size_t each = crate.shape.samples.size();
    ASSERT_LT(20 * each, 2000U);
    const auto thrown = [&](int count) {
        for (int k = 0; k < count; ++k) {
            Body one = crate;
            one.state.pose.position += vec3(0.1F * static_cast<float>(k % 4) - 0.15F, 0.0F, 0.1F * static_cast<float>(k / 4 % 4) - 0.15F);
            add(*world, one);
            run(*world, 1);
        }
    };
    thrown(20);
    EXPECT_EQ(world->bodies().size(), 20U);
    run(*world, 20);
    for (const BodyState& s : world->bodies()) EXPECT_TRUE(isFinite(s.pose.position) && s.pose.position.y < 0.5F);
    EXPECT_EQ(world->stats().lost, 0U);
    const size_t bytes = device->bytesAllocated();
    for (int round = 0; round < 3; ++round) {
        // Every other one, and then the rest: the room is in pieces.
        std::vector<uint32_t> ids = world->bodyIds();
        for (size_t k = 0; k < ids.size(); k += 2) ASSERT_TRUE(world->removeBody(ids[k]));
        add(*world, boxAt(vec3(0.25F, 0.6F, 0.25F), vec3(0.2F, 0.1F, 0.2F), 500));
        run(*world, 1);
        ids = world->bodyIds();
        for (const uint32_t id : ids) ASSERT_TRUE(world->removeBody(id));
        thrown(20);
    }
    EXPECT_LE(device->bytesAllocated(), bytes + bytes / 20) << "only neighbour lists may have grown";
    EXPECT_EQ(world->bodyIds().back(), 20U + 3 * 21 - 1) << "an id is never used again";
}

TEST(BodiesChange, WhatDoesNotFitIsRefused) {
    auto device = cpu();
    const VoxelField wall = test::baked(test::makeBox(vec3(0.35F, 0.0F, 0.0F), vec3(0.5F, 0.3F, 0.5F)), 0.25F * kSpacing, kSpacing);
    FluidParams p = pool();
    p.maxBodySamples = 200;
    auto world = makeWorld(*device, p, {.field = &wall});
    auto plain = makeWorld(*device, p, {.field = &wall});
    const Body good = boxAt(vec3(0.15F, 0.4F, 0.25F), vec3(0.1F), 500);
    expectRefused(world->addBody(boxAt(vec3(0.4F, 0.2F, 0.25F), vec3(0.1F), 500)), "inside a wall");
    expectRefused(world->addBody(boxAt(vec3(0.2F, 0.5F, 0.25F), vec3(0.3F), 500)), "fluid.bodies.maxSamples");
    Body wrong = good;
    wrong.shape.inertia = vec3(0.0F);
    expectRefused(world->addBody(wrong), "no inertia");
    wrong = good;
    wrong.state.velocity = vec3(std::nanf(""));
    expectRefused(world->addBody(wrong), "not finite");
    expectRefused(world->removeBody(0), "no body 0");
    device->limitMemory(device->bytesAllocated());
    Body second = good;
    second.state.pose.position.z = 0.1F;
    add(*world, second);  // there is room for one
    expectRefused(world->addBody(good), "cannot allocate");
    device->limitMemory(SIZE_MAX);
    ASSERT_TRUE(world->removeBody(0));
    run(*world, 5);
    run(*plain, 5);
    EXPECT_TRUE(waterOf(*world) == waterOf(*plain)) << "nothing was changed by what was refused";
    p.maxBodySamples = 0;
    auto none = makeWorld(*device, p);
    expectRefused(none->addBody(good), "fluid.bodies.maxSamples of at least");
    p.maxBodySamples = 10;
    EXPECT_FALSE(FluidWorld::create(*device, p, {.bodies = {good}}, {}));
}

// A host's engine learns what was added and removed, and has one load and one state for each in the order of the ids.
struct Engine {
    std::vector<uint32_t> ids;
    FluidWorld* world = nullptr;
    bool right = true;
    std::string refused;
    BodyHost host() {
        BodyHost h;
        h.self = this;
        h.advance = [](void* self, std::span<const BodyLoad> loads, const vec3&, double, std::span<BodyState> states) {
            Engine& e = *static_cast<Engine*>(self);
            e.right = e.right && loads.size() == e.ids.size() && states.size() == e.ids.size();
            for (size_t k = 0; k < states.size(); ++k) states[k].pose.position.x = 0.1F * static_cast<float>(e.ids[k]);
            if (const Status gone = e.world->removeBody(e.ids[0]); !gone) e.refused = gone.error().message;
        };
        h.reset = [](void*, std::span<const BodyState>) {};
        h.added = [](void* self, uint32_t id, const Body&) { static_cast<Engine*>(self)->ids.push_back(id); };
        h.removed = [](void* self, uint32_t id, size_t index) {
            Engine& e = *static_cast<Engine*>(self);
            e.right = e.right && e.ids[index] == id;
            e.ids.erase(e.ids.begin() + static_cast<std::ptrdiff_t>(index));
        };
        return h;
    }
};

// A world without bodies and without memory for samples takes those that the water does not meet: they fall freely.
TEST(BodiesChange, WhatTheWaterDoesNotMeetNeedsNoSamples) {
    auto device = cpu();
    FluidParams p = pool(0.1F);
    p.maxBodySamples = 0;
    auto world = makeWorld(*device, p), plain = makeWorld(*device, p);
    Body ghost = boxAt(vec3(0.25F, 0.5F, 0.25F), vec3(0.1F), 500);
    ghost.meetsWater = false;
    const uint32_t first = add(*world, ghost);
    add(*world, ghost);
    run(*world, 10);
    run(*plain, 10);
    ASSERT_EQ(world->bodies().size(), 2U);
    const double t = 10 * kFrame;
    EXPECT_NEAR(double{world->bodies()[1].pose.position.y}, 0.5 - 0.5 * 9.81 * t * t, 0.02);
    EXPECT_EQ(world->bodyLoads()[0].force, dvec3(0.0));
    EXPECT_TRUE(waterOf(*world) == waterOf(*plain));
    FluidParams probed = p;
    probed.probes = {{.name = "all", .on = "box"}};
    auto measured = makeWorld(*device, probed);
    const uint32_t only = add(*measured, ghost);
    probed.probes[0].on = "body";
    ASSERT_TRUE(measured->setParams(probed));
    run(*measured, 2);
    EXPECT_EQ(measured->stats().loads.probes[0].force, dvec3(0.0));
    expectRefused(measured->removeBody(only), "measures all bodies");
    probed.probes[0].on = "box";  // the number of probes is fixed
    ASSERT_TRUE(measured->setParams(probed));
    ASSERT_TRUE(measured->removeBody(only));
    ASSERT_TRUE(world->removeBody(first));
    run(*world, 1);
    world->reset();
    EXPECT_EQ(world->bodies()[0].pose.position.y, 0.5F);
}

TEST(BodiesChange, NothingChangesWhileAStopIsAsked) {
    auto device = cpu();
    std::atomic<bool> stop = false;
    device->stopOn(&stop);
    auto world = makeWorld(*device, pool());
    const Body body = boxAt(vec3(0.25F, 0.1F, 0.25F), vec3(0.15F), 500);
    const size_t before = waterOf(*world).size();
    stop = true;
    expectRefused(world->addBody(body), "a stop is asked");
    expectRefused(world->setWalls({}), "a stop is asked");
    stop = false;
    EXPECT_EQ(waterOf(*world).size(), before);
    const uint32_t id = add(*world, body);
    EXPECT_LT(waterOf(*world).size(), before);
    stop = true;
    expectRefused(world->removeBody(id), "a stop is asked");
    stop = false;
    EXPECT_EQ(world->bodyIds(), std::vector<uint32_t>{id});
    run(*world, 1);
    device->stopOn(nullptr);
}

TEST(BodiesChange, TheHostLearnsOfThem) {
    auto device = cpu();
    const Body body = boxAt(vec3(0.1F, 0.5F, 0.25F), vec3(0.1F), 500);
    Engine engine;
    engine.ids = {0};
    auto world = makeWorld(*device, pool(), {.bodies = {body}, .bodyHost = engine.host()});
    engine.world = world.get();
    add(*world, body);
    add(*world, body);
    ASSERT_TRUE(world->removeBody(1));
    run(*world, 1);
    EXPECT_EQ(engine.ids, (std::vector<uint32_t>{0, 2}));
    EXPECT_TRUE(engine.right);
    EXPECT_EQ(world->bodies()[1].pose.position.x, 0.2F);
    EXPECT_NE(engine.refused.find("a step is under way"), std::string::npos) << engine.refused;
    BodyHost silent = engine.host();
    silent.added = nullptr;
    silent.removed = nullptr;
    auto other = makeWorld(*device, pool(), {.bodies = {body}, .bodyHost = silent});
    expectRefused(other->addBody(body), "no function added");
    expectRefused(other->removeBody(0), "no function removed");
}

// A probe names a body by its id, whatever else comes and goes.
TEST(BodiesChange, ProbesFollowTheirBody) {
    auto device = cpu();
    FluidParams p = pool();
    p.probes = {{.name = "second", .on = "body", .index = 1}};
    const Body dry = boxAt(vec3(0.25F, 0.6F, 0.25F), vec3(0.1F), 0), wet = boxAt(vec3(0.25F, 0.1F, 0.25F), vec3(0.15F), 0);
    auto world = makeWorld(*device, p, {.bodies = {dry, wet}});
    run(*world, 40);
    const double lift = world->stats().loads.probes[0].force.y;
    EXPECT_NEAR(lift, 1000 * 9.81 * std::pow(0.15, 3), 0.3 * 1000 * 9.81 * std::pow(0.15, 3));
    expectRefused(world->removeBody(1), "set fluid.probes[0].on to box, or .index to another body, first");
    ASSERT_TRUE(world->removeBody(0));
    run(*world, 5);
    EXPECT_NEAR(world->stats().loads.probes[0].force.y, lift, 0.1 * lift);
}

std::vector<float> wetness(const FluidWorld& world) {
    const WetnessView view = world.wetness();
    return world.device().readAll<float>(*view.values, view.surface->points.size());
}
std::vector<float> wetnessOf(const FluidWorld& world, const SolidRef& ref) {
    const WetSolid* solid = world.wetness().surface->find(ref);
    if (solid == nullptr) return {};
    const std::vector<float> all = wetness(world);
    return {all.begin() + solid->firstPoint, all.begin() + solid->firstPoint + solid->points};
}
size_t wetPoints(const std::vector<float>& values) {
    return static_cast<size_t>(std::ranges::count_if(values, [](float v) { return v > 0.1F; }));
}

// Of what stays, whatever comes and goes beside it, each point keeps its value; what is added is dry.
TEST(BodiesChange, WhatIsWetStaysWet) {
    auto device = cpu();
    FluidParams p = pool(0.1F);
    p.wetness.on = true;
    p.wetness.dries = 1.0e4F;
    p.wetness.runs = 0;
    const VoxelField post = test::baked(test::makeBox(vec3(0.4F, 0.0F, 0.4F), vec3(0.48F, 0.4F, 0.48F)), 0.25F * kSpacing, kSpacing),
                     still = test::baked(test::makeBox(vec3(0.02F, 0.0F, 0.02F), vec3(0.1F, 0.4F, 0.1F)), 0.25F * kSpacing, kSpacing),
                     finer = test::baked(test::makeBox(vec3(0.02F, 0.0F, 0.02F), vec3(0.1F, 0.4F, 0.1F)), 0.2F * kSpacing, kSpacing);
    const Body low = boxAt(vec3(0.15F, 0.06F, 0.25F), vec3(0.1F), 0), other = boxAt(vec3(0.35F, 0.08F, 0.25F), vec3(0.1F), 0),
               dry = boxAt(vec3(0.25F, 0.5F, 0.25F), vec3(0.1F), 0);
    auto world = makeWorld(*device, p, {.field = &still, .rigid = {{&post, {}}}, .bodies = {low, other}});
    run(*world, 4);
    const std::vector<float> onOther = wetnessOf(*world, {ProbeOn::body, 1}), onPost = wetnessOf(*world, {ProbeOn::rigid, 0}),
                             onStill = wetnessOf(*world, {ProbeOn::still, 0});
    ASSERT_GT(wetPoints(onOther), 50U);
    ASSERT_GT(wetPoints(onPost), 20U);
    ASSERT_GT(wetPoints(onStill), 20U);
    add(*world, dry);
    ASSERT_TRUE(world->removeBody(0));
    EXPECT_EQ(wetnessOf(*world, {ProbeOn::body, 0}), onOther);
    EXPECT_EQ(wetPoints(wetnessOf(*world, {ProbeOn::body, 1})), 0U);
    EXPECT_FALSE(wetnessOf(*world, {ProbeOn::body, 1}).empty());
    EXPECT_EQ(wetnessOf(*world, {ProbeOn::rigid, 0}), onPost);
    // A wall that comes before it in the list, and the static one baked again with other voxels.
    const VoxelField above = test::baked(test::makeBox(vec3(0.2F, 0.5F, 0.02F), vec3(0.3F, 0.6F, 0.1F)), 0.25F * kSpacing, kSpacing);
    ASSERT_TRUE(world->setWalls({.field = &finer, .rigid = {{&above, {}}, {&post, {}}}}));
    EXPECT_EQ(wetnessOf(*world, {ProbeOn::rigid, 1}), onPost);
    EXPECT_EQ(wetPoints(wetnessOf(*world, {ProbeOn::rigid, 0})), 0U);
    EXPECT_EQ(wetnessOf(*world, {ProbeOn::body, 0}), onOther);
    const WetSurface& surface = *world->wetness().surface;
    const WetSolid& again = *surface.find({ProbeOn::still, 0});
    const std::vector<float> values = wetnessOf(*world, {ProbeOn::still, 0});
    size_t wet = 0;
    for (size_t k = 0; k < values.size(); ++k) {
        const float y = surface.points[again.firstPoint + k].place.y;
        if (y < 0.06F) wet += values[k] > 0.5F ? 1 : 0;
        if (y > 0.25F) EXPECT_EQ(values[k], 0.0F);
    }
    EXPECT_GT(wet, wetPoints(onStill) / 3);
    run(*world, 2);
    EXPECT_GT(wetPoints(wetnessOf(*world, {ProbeOn::body, 0})), 50U);
    ASSERT_TRUE(world->setWalls({}));
    EXPECT_TRUE(wetnessOf(*world, {ProbeOn::rigid, 0}).empty());
}

// What the water does not meet is not in it: the water is bit for bit that of a world without the body, and the body falls freely.
TEST(BodiesChange, ABodyThatDoesNotMeetTheWaterFallsThroughIt) {
    auto device = cpu();
    auto plain = makeWorld(*device, pool());
    Body ghost = boxAt(vec3(0.25F, 0.5F, 0.25F), vec3(0.1F), 500), other = ghost;
    ghost.meetsWater = other.meetsWater = false;
    other.state.pose.position.x = 0.1F;
    auto world = makeWorld(*device, pool(), {.bodies = {ghost}});
    add(*world, other);
    run(*plain, 15);
    run(*world, 15);
    EXPECT_TRUE(waterOf(*plain) == waterOf(*world));
    for (const BodyState& s : world->bodies()) {
        EXPECT_NEAR(double{s.velocity.y}, -9.81 * world->time(), 1.0e-4);
        EXPECT_LT(s.pose.position.y, 0.25F) << "it is under water";
    }
    for (const BodyLoad& l : world->bodyLoads()) EXPECT_EQ(l.force, dvec3(0.0));
}

}  // namespace
}  // namespace rivulet::bodies_change_test
