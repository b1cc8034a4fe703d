// A world that runs out of memory stops and reports it without loss, and continues when memory is available again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <stdexcept>

#include "tests/physics/worlds.h"

namespace rivulet::memory_test {
namespace {

// Particles packed so closely that the neighbour lists must grow in the first step.
FluidParams packed(const std::string& method, bool periodic = false) {
    FluidParams p;
    p.method = method;
    p.spacing = 0.04F;
    p.maxSubsteps = 4;
    p.dfsph.maxIterations = 5;
    p.box.max = vec3(0.4F, 0.4F, 0.24F);
    p.box.periodicZ = periodic;
    for (int k = 0; k < 60; ++k) p.blocks.push_back({.max = vec3(0.2F, 0.2F, 0.24F), .velocity = vec3(0.5F, 0.25F, 0.0F)});
    return p;
}

struct State {
    std::vector<vec4> position, velocity;
    std::vector<uint32_t> id;
};
State stateOf(FluidWorld& world) {
    const ParticleView v = world.particles();
    Device& d = world.device();
    return {d.readAll<vec4>(*v.position, v.slots), d.readAll<vec4>(*v.velocity, v.slots), d.readAll<uint32_t>(*v.id, v.slots)};
}

TEST(OutOfMemory, TheGridFailsAgainUntilThereIsMemory) {
    auto device = cpu();
    const FluidParams p = packed("dfsph");
    auto world = makeWorld(*device, p);
    ASSERT_TRUE(world);
    const State start = stateOf(*world);
    Result<NeighborGrid> grid =
        NeighborGrid::create(*device, Bounds{p.box.min, p.box.max}, p.supportSpacings * p.spacing, world->particles().slots);
    ASSERT_TRUE(grid);
    Result<Particles> particles = Particles::create(*device, world->particles().slots);
    ASSERT_TRUE(particles);
    device->writeAll<vec4>(particles->positionNext, start.position);
    device->writeAll<vec4>(particles->velocityNext, start.velocity);
    device->writeAll<uint32_t>(particles->id, start.id);
    StepParams step{};
    step.count = particles->count;
    grid->fill(step);
    device->limitMemory(device->bytesAllocated());
    for (int k = 0; k < 3; ++k) {
        const Status built = grid->build(step, *particles);
        ASSERT_FALSE(built) << "build " << k << " has no memory for its lists";
        EXPECT_EQ(built.error().fault, Fault::failed);
        EXPECT_EQ(device->readAll<uint32_t>(particles->id, particles->count), start.id);
    }
    device->limitMemory(SIZE_MAX);
    EXPECT_TRUE(grid->build(step, *particles));
}

class OutOfMemoryOf : public ::testing::TestWithParam<const char*> {};

TEST_P(OutOfMemoryOf, AWorldStopsReportsItAndContinuesLater) {
    for (const bool periodic : {false, true}) {
        if (periodic && std::string_view(GetParam()) == "wcsph_thesis") continue;
        auto device = cpu();
        auto world = makeWorld(*device, packed(GetParam(), periodic));
        ASSERT_TRUE(world);
        const State start = stateOf(*world);
        device->limitMemory(device->bytesAllocated());
        for (int k = 0; k < 3; ++k) {
            world->step({}, 1.0 / 60);
            const Status stepped = world->lastStep();
            ASSERT_FALSE(stepped) << GetParam();
            EXPECT_TRUE(stepped.error().memory && stepped.error().message.starts_with("not enough memory for the neighbour lists: "));
        }
        const std::vector<std::string>& limited = world->stats().limited;
        EXPECT_TRUE(std::any_of(limited.begin(), limited.end(), [](const std::string& s) {
            return s.starts_with("not enough memory for the neighbour lists: ");
        })) << GetParam();
        EXPECT_EQ(world->time() + world->pending() + world->dropped(), 0) << "a step that failed was not asked for";
        EXPECT_TRUE(world->savable()) << "the world is whole";
        const State now = stateOf(*world);
        EXPECT_EQ(now.id, start.id);
        for (size_t i = 0; i < start.id.size(); ++i) {
            ASSERT_LT(glm::distance(vec3(now.position[i]), vec3(start.position[i])), 1.0e-6F) << GetParam() << ' ' << i;
            ASSERT_LT(glm::distance(vec3(now.velocity[i]), vec3(start.velocity[i])), 1.0e-3F) << GetParam() << ' ' << i;
        }
        device->limitMemory(SIZE_MAX);
        for (int k = 0; k < 2; ++k) world->step({}, 1.0 / 60);
        EXPECT_TRUE(world->lastStep());
        EXPECT_GT(world->time(), 0);
        EXPECT_EQ(world->stats().nan, 0U);
        EXPECT_EQ(world->stats().particles, start.id.size());
    }
}
INSTANTIATE_TEST_SUITE_P(Methods, OutOfMemoryOf, ::testing::Values("pbf", "dfsph", "wcsph", "wcsph_thesis"));

// So many particles in one cell that the sum of their candidates exceeds 2^32 by less than the lists hold.
TEST(OutOfMemory, ListsAreCountedIn64Bits) {
    constexpr uint32_t kCount = 185'360;
    auto device = cpu();
    const Bounds box{vec3(0.0F), vec3(1.0F)};
    Result<NeighborGrid> grid = NeighborGrid::create(*device, box, 0.1F, kCount);
    Result<Particles> particles = Particles::create(*device, kCount);
    ASSERT_TRUE(grid && particles);
    std::vector<uint32_t> id(kCount);
    for (uint32_t k = 0; k < kCount; ++k) id[k] = k;
    device->writeAll<vec4>(particles->positionNext, std::vector<vec4>(kCount, vec4(0.51F, 0.51F, 0.51F, 1.0F)));
    device->writeAll<uint32_t>(particles->id, id);
    StepParams step{};
    step.count = kCount;
    step.spacing = 0.05F;
    grid->fill(step);
    const Status built = grid->build(step, *particles);
    ASSERT_FALSE(built) << "the lists do not fit";
    EXPECT_NE(built.error().message.find("packed so closely"), std::string::npos) << built.error().message;
    EXPECT_EQ(device->readAll<uint32_t>(particles->id, kCount), id);
}

// Refuses one allocation, by its number, and counts all.
struct Refusal {
    Device& device;
    int asked = 0, refused = -1;
    explicit Refusal(Device& d) : device(d) {
        device.onAllocate([this](size_t) { return asked++ != refused; });
    }
    ~Refusal() { device.onAllocate({}); }
    Refusal(const Refusal&) = delete;
    Refusal& operator=(const Refusal&) = delete;
};

struct Kind {
    const char* name;
    FluidParams params;
    Sources sources = {};
};

std::vector<Kind> kinds() {
    FluidParams plain;
    plain.spacing = 0.06F;
    plain.maxSubsteps = 3;
    plain.foam.most = 100;
    plain.maxParticles = 200;
    plain.blocks = {{.min = vec3(0.1F), .max = vec3(0.4F), .velocity = vec3(0.5F, 0.0F, 0.0F), .jitter = 0}};
    std::vector<Kind> all;
    for (const char* method : {"pbf", "dfsph", "wcsph"}) {
        all.push_back({method, plain});
        all.back().params.method = method;
    }
    all.push_back({"sleep", plain});
    all.back().params.sleep.on = true;
    all.push_back({"window", plain});
    all.back().params.box.max = vec3(60.0F);
    all.back().params.blocks[0].min = vec3(30.0F);
    all.back().params.blocks[0].max = vec3(30.3F);
    // Particles of the host: a start that is not corrected.
    all.push_back({"packed", packed("pbf")});
    all.back().params.blocks.clear();
    all.back().params.maxSubsteps = all.back().params.pbf.iterations = 1;
    for (int k = 0; k < 2500; ++k)
        all.back().sources.particles.push_back(
            {vec3(0.02F) + 0.04F * vec3(k % 5, k / 5 % 5, k / 25 % 5) + 1.0e-4F * static_cast<float>(k / 125)});
    return all;
}

// What a run needs memory for beyond its start: lists, forces, ellipsoids, states to draw between, probes, volumes, questions. What fails
// is asked for again, once, and succeeds.
class Passage {
  public:
    int failures = 0;
    bool cut = false;  // a frame failed behind its first substep

    void go(FluidWorld& world) {
        FluidParams p = world.params();
        for (int f = 0; f < 7; ++f) {
            if (f == 2) {
                p.forces.tension = 0.07F;
                p.forces.normals = "gradient";
                p.forces.viscosity = "implicit";
                p.viscosity = 0.01F;
                ask([&] { return world.setParams(p); });
            }
            if (f == 3) {
                p.ellipsoids = true;
                p.fixedStep = 1.0F / 120;
                p.probes = {{.name = "floor", .face = "-y"}};
                ask([&] { return world.setParams(p); });
            }
            if (f == 5) {
                const std::vector<Volume> volumes = {{.id = 3, .position = vec3(0.2F), .size = vec3(0.3F)}};
                ask([&] { return world.setVolumes(volumes); });
                const std::vector<vec3> places(100, vec3(0.2F));
                ask([&] {
                    auto answer = world.sample(places);
                    return answer ? ok() : Status(answer.error());
                });
            }
            const double until = (f + 1) / 60.0;
            ask([&] {
                const double before = world.time();
                world.step({}, until - before - world.pending());
                const Status stepped = world.lastStep();
                cut = cut || (!stepped && world.time() > before);
                return stepped;
            });
        }
    }

  private:
    void ask(const std::function<Status()>& work) {
        Status done = work();
        if (!done) {
            ++failures;
            EXPECT_TRUE(done.error().memory) << done.error().message;
            EXPECT_EQ(done.error().fault, Fault::failed);
            done = work();
        }
        EXPECT_TRUE(done) << done.error().message;
    }
};

std::map<std::string, WorldState::Bytes> saved(FluidWorld& world) {
    WorldState state;
    world.save(state);
    auto sections = state.sections();
    sections.erase("world.limited");  // what was reported
    return sections;
}

TEST(OutOfMemory, EachAllocationOfARunMayFailAndTheRunStaysTheSame) {
    for (const Kind& kind : kinds()) {
        std::map<std::string, WorldState::Bytes> expected;
        int failed = 0, all = 1;
        for (int k = -1; k < all; ++k) {
            const std::vector<CpuKernelRow> rows = cpuKernels();
            auto device = makeCpuDevice(rows, {.threads = 1});  // foam takes slots in the order of threads
            auto made = FluidWorld::create(*device, kind.params, {}, {}, kind.sources);
            ASSERT_TRUE(made);
            FluidWorld* world = made->get();
            Refusal refusal(*device);
            refusal.refused = k;
            Passage passage;
            passage.go(*world);
            ASSERT_TRUE(world->savable()) << kind.name << ' ' << k;
            if (k < 0) {
                all = refusal.asked;
                expected = saved(*world);
                EXPECT_EQ(passage.failures, 0);
                continue;
            }
            failed += passage.failures;
            EXPECT_EQ(world->stats().nan + world->stats().lost, 0U) << kind.name << ' ' << k;
            if (passage.cut) continue;
            for (const auto& [name, bytes] : saved(*world))
                EXPECT_TRUE(bytes == expected[name]) << kind.name << ": allocation " << k << " of " << all << ", " << name;
        }
        EXPECT_GT(failed, 8) << kind.name;
        std::printf("%s: %d allocations\n", kind.name, all);
    }
}

TEST(OutOfMemory, EachAllocationOfACreationMayFail) {
    for (const Kind& kind : kinds()) {
        int all = 1;
        for (int k = -1; k < all; ++k) {
            auto device = cpu();
            Refusal refusal(*device);
            refusal.refused = k;
            {
                const auto world = FluidWorld::create(*device, kind.params, {}, {}, kind.sources);
                if (k < 0) {
                    ASSERT_TRUE(world);
                    all = refusal.asked;
                    continue;
                }
                ASSERT_FALSE(world) << kind.name << ' ' << k;
                EXPECT_TRUE(world.error().memory) << world.error().message;
            }
            EXPECT_EQ(device->bytesAllocated(), 0U);
        }
        EXPECT_GT(all, 20);
    }
}

// A restored state may need memory that the world has not used yet.
TEST(OutOfMemory, ARestoreThatFailsChangesNothing) {
    const FluidParams p = kinds()[0].params;
    auto device = cpu();
    auto watched = makeWorld(*device, p), other = makeWorld(*device, p);
    ASSERT_TRUE(watched->setVolumes(std::vector<Volume>{{.id = 3, .position = vec3(0.2F), .size = vec3(0.3F)}}));
    for (int k = 0; k < 3; ++k) watched->step({}, 1.0 / 60);
    other->step({}, 1.0 / 60);
    const auto before = saved(*other);
    for (const bool allowed : {false, true}) {
        WorldState state;
        watched->save(state);
        device->limitMemory(allowed ? SIZE_MAX : device->bytesAllocated());
        const Status restored = other->restore(state);
        EXPECT_EQ(static_cast<bool>(restored), allowed);
        if (!allowed) EXPECT_TRUE(restored.error().memory) << restored.error().message;
        EXPECT_TRUE(saved(*other) == (allowed ? saved(*watched) : before));
    }
}

// A function of the host that throws, or does not return, leaves the world incomplete: it says so, and a reset makes it whole.
TEST(OutOfMemory, AWorldThatWasLeftWithinAStepRefusesToGoOn) {
    struct Host {
        bool throws = false;
    } host;
    Solids solids;
    Body body;
    body.shape = {.samples = {vec3(0.02F, 0, 0), vec3(-0.02F, 0, 0)}, .mass = 0.1F, .inertia = vec3(1.0e-4F), .volume = 1.0e-4F};
    body.state.pose.position = vec3(0.7F);
    solids.bodies = {body};
    solids.bodyHost.self = &host;
    solids.bodyHost.advance = [](void* self, std::span<const BodyLoad>, const vec3&, double, std::span<BodyState>) {
        if (static_cast<Host*>(self)->throws) throw std::runtime_error("no");
    };
    solids.bodyHost.reset = [](void*, std::span<const BodyState>) {};
    solids.bodyHost.remembersNothing = true;
    FluidParams p = kinds()[0].params;
    auto device = cpu();
    auto world = makeWorld(*device, p, solids), reference = makeWorld(*device, p, solids);
    world->step({}, 1.0 / 60);
    host.throws = true;
    EXPECT_THROW(world->step({}, 1.0 / 60), std::runtime_error);
    host.throws = false;
    const double time = world->time();
    world->step({}, 1.0 / 60);
    EXPECT_EQ(world->time(), time);
    for (const Status& refused : {world->lastStep(), world->savable()}) {
        ASSERT_FALSE(refused);
        EXPECT_NE(refused.error().message.find("reset or restore"), std::string::npos) << refused.error().message;
    }
    EXPECT_FALSE(world->sample(std::vector<vec3>{vec3(0.2F)}));
    world->reset();
    EXPECT_TRUE(world->lastStep());
    world->step({}, 1.0 / 60);
    reference->step({}, 1.0 / 60);
    EXPECT_TRUE(saved(*world) == saved(*reference));
}

}  // namespace
}  // namespace rivulet::memory_test
