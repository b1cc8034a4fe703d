// fluid.grid linked_list: the thesis's lists hold the right particles, and its four dispatches give the results of the sorted grid's
// kernels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "fluid/session/run_stats.h"
#include "fluid/session/session.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/surface/ellipsoids.h"
#include "shaders/fluid/grid/linked_list.h"
#include "shaders/fluid/world/stats_row.h"
#include "tests/parity/devices.h"

namespace rivulet::linked_list_test {
namespace {

constexpr float kSpacing = 0.03F, kReach = 2 * kSpacing;
constexpr uint32_t kNaN = 100, kBelow = 200, kFar = 201, kFree = 300;  // particles that no list may hold
const Bounds kBox{vec3(-0.2F, 0.3F, 1.0F), vec3(0.4F, 0.7F, 1.5F)};

struct Cloud {
    std::vector<vec4> position, velocity;
    std::vector<uint32_t> id;
    bool inside(uint32_t i) const { return i != kNaN && i != kBelow && i != kFar && i != kFree; }
};

// Random positions in a box of (10, 6.7, 8.3) support radii: about five a cell, in some none.
Cloud jittered() {
    Cloud cloud;
    std::mt19937 random(11);
    const auto uniform = [&](float lo, float hi) { return lo + (hi - lo) * static_cast<float>(random() >> 8U) * 0x1p-24F; };
    for (uint32_t i = 0; i < 3000; ++i) {
        cloud.position.emplace_back(uniform(-0.2F, 0.4F), uniform(0.3F, 0.7F), uniform(1.0F, 1.5F), 1.0F);
        cloud.velocity.emplace_back(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), 0.0F);
        cloud.id.push_back(i);
    }
    cloud.position[kNaN].x = std::numeric_limits<float>::quiet_NaN();
    cloud.position[kBelow].y = 0.1F;
    cloud.position[kFar].z = 1.0e9F;
    cloud.position[kFree].w = -1.0F;
    return cloud;
}

// The buffers of a world in thesis mode, without the world.
struct Bench {
    Device& device;
    FluidParams params;
    Cloud cloud = jittered();
    PairTraits traits;
    std::unique_ptr<Method> method;
    std::unique_ptr<NeighborGrid> grid;
    Particles particles;
    StepParams step{};
    Buffer planes;

    Bench(Device& on, bool linked, uint32_t workGroup = 0) : device(on) {
        const auto count = static_cast<uint32_t>(cloud.id.size());
        params.method = "wcsph_thesis";
        params.spacing = kSpacing;
        params.viscosity = 1.0e-3F;
        traits.linked = linked;
        traits.workGroup = workGroup;
        auto made = methods().find("wcsph_thesis")->make(device, {params, count, traits});
        EXPECT_TRUE(made) << (made ? "" : made.error().message);
        auto newGrid = NeighborGrid::create(device, kBox, kReach, count, traits);
        EXPECT_TRUE(newGrid) << (newGrid ? "" : newGrid.error().message);
        auto arrays = Particles::create(device, count);
        EXPECT_TRUE(arrays);
        if (!made || !newGrid || !arrays) return;
        method = std::move(*made);
        grid = std::make_unique<NeighborGrid>(std::move(*newGrid));
        particles = std::move(*arrays);
        planes = std::move(*device.allocate(2 * sizeof(vec4)));
        step.gravity = vec4(params.gravity, 0.0F);
        step.boxMin = vec4(kBox.min, 1.0F);
        step.boxMax = vec4(kBox.max, 0.0F);
        step.count = count;
        step.h = kReach;
        step.invH = 1 / step.h;
        step.dt = 2.0e-4F;
        step.mass = 1000 * kSpacing * kSpacing * kSpacing;
        step.restDensity = 1000;
        step.viscosity = params.viscosity;
        step.contact = 0.1F * kSpacing;
        step.spacing = kSpacing;
        step.maxSpeed = 100;
        grid->fill(step);
        method->fill(params, 1.0F, step);
        device.writeAll<vec4>(particles.positionNext, cloud.position);
        device.writeAll<vec4>(particles.velocityNext, cloud.velocity);
        device.writeAll<uint32_t>(particles.id, cloud.id);
    }
    void run() {
        SolveFigures solve;
        const Buffer stats = std::move(*device.allocate(16));
        StepContext context{.device = device,
                            .fluid = params,
                            .params = step,
                            .grid = *grid,
                            .particles = particles,
                            .solve = solve,
                            .stats = stats,
                            .build = [&](bool) { return static_cast<bool>(grid->build(step, particles)); },
                            .pushSamples = [](const Buffer&, const Buffer&, float, const vec3&) {},
                            .planes = planes,
                            .nearWalls = [](const Buffer&) {},
                            .forces = [] {}};
        method->step(context);
    }
    template <class T>
    std::vector<T> byId(const Buffer& buffer) {
        const std::vector<T> values = device.readAll<T>(buffer, step.count);
        const std::vector<uint32_t> id = device.readAll<uint32_t>(particles.id, step.count);
        std::vector<T> sorted(values.size());
        for (size_t i = 0; i < id.size(); ++i) sorted[id[i]] = values[i];
        return sorted;
    }
    std::vector<StatsRow> stats() {
        const std::vector<Define> defines = traits.linked ? std::vector<Define>{{"LINKED_LIST", "1"}} : std::vector<Define>{};
        Buffer rows = std::move(*device.allocate(STATS_THREADS * sizeof(StatsRow)));
        device.run(*device.kernel("fluid/world/stats", defines), step,
                   {&grid->cellStart(), &particles.positionNext, &particles.velocityNext, &rows}, STATS_THREADS);
        return device.readAll<StatsRow>(rows, STATS_THREADS);
    }
};

class LinkedList : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        gpu = makeTestGpu(GetParam());
        if (!gpu) GTEST_SKIP() << gpu.error().message;
    }
    Result<TestGpu> gpu = failed("not opened");
};

// Cells of the reference: floor of the place over h, in double, from the box's corner.
ivec3 referenceCell(const vec4& x) {
    ivec3 cell;
    for (int k = 0; k < 3; ++k) cell[k] = static_cast<int>(std::floor((double{x[k]} - double{kBox.min[k]}) / double{kReach}));
    return cell;
}

TEST_P(LinkedList, EveryParticleIsInTheListOfItsCellOnce) {
    Bench b(*gpu->device, true);
    ASSERT_TRUE(b.grid);
    for (int again = 0; again < 2; ++again) {  // lists are cleared
        b.device.writeAll<vec4>(b.particles.positionNext, b.cloud.position);
        ASSERT_TRUE(b.grid->build(b.step, b.particles));
        const uint32_t cells = b.step.cellCount, count = b.step.count;
        const auto lists = b.device.readAll<uint32_t>(b.grid->cellStart(), NEXT_OF(cells, count));
        const auto counts = b.device.readAll<uint32_t>(b.grid->cellCounts(), cells);
        EXPECT_EQ(lists[cells], count);
        std::multiset<uint32_t> found;
        for (uint32_t cell = 0; cell < cells; ++cell) {
            const ivec3 at(cell % static_cast<uint32_t>(b.step.cellsX),
                           cell / static_cast<uint32_t>(b.step.cellsX) % static_cast<uint32_t>(b.step.cellsY),
                           cell / static_cast<uint32_t>(b.step.cellsX * b.step.cellsY));
            uint32_t length = 0;
            for (uint32_t i = lists[cell]; i != LIST_END; i = lists[NEXT_OF(cells, i)]) {
                ASSERT_LT(i, count) << "no end in cell " << cell;
                ASSERT_LE(++length, count) << "the list is cyclic";
                found.insert(i);
                // Padded by a cell; on a cell's face float and double may round to different cells.
                const vec3 off = glm::abs(vec3(at - ivec3(1) - referenceCell(b.cloud.position[i])));
                if (off != vec3(0.0F)) {
                    const vec3 in = (vec3(b.cloud.position[i]) - kBox.min) / kReach;
                    EXPECT_LT(glm::length(glm::abs(in - glm::round(in)) * off), 1.0e-4F) << i;
                }
            }
            EXPECT_EQ(length, counts[cell]) << "cell " << cell;
        }
        for (uint32_t i = 0; i < count; ++i) EXPECT_EQ(found.count(i), b.cloud.inside(i) ? 1U : 0U) << i;
    }
}

TEST_P(LinkedList, TheListsAroundAParticleHoldAllWithinReach) {
    Bench b(*gpu->device, true);
    ASSERT_TRUE(b.grid);
    ASSERT_TRUE(b.grid->build(b.step, b.particles));
    const uint32_t cells = b.step.cellCount, count = b.step.count;
    const auto lists = b.device.readAll<uint32_t>(b.grid->cellStart(), NEXT_OF(cells, count));
    size_t pairs = 0;
    for (uint32_t i = 0; i < count; ++i) {
        if (!b.cloud.inside(i)) continue;
        std::set<uint32_t> around;
        const ivec3 home = referenceCell(b.cloud.position[i]) + 1;
        for (int k = 0; k < 27; ++k) {
            const ivec3 c = home + ivec3(k % 3, k / 3 % 3, k / 9) - 1;
            for (uint32_t j = lists[static_cast<size_t>((c.z * b.step.cellsY + c.y) * b.step.cellsX + c.x)]; j != LIST_END;
                 j = lists[NEXT_OF(cells, j)])
                around.insert(j);
        }
        for (uint32_t j = 0; j < count; ++j)
            if (b.cloud.inside(j) && glm::length(dvec3(b.cloud.position[i]) - dvec3(b.cloud.position[j])) < double{kReach} * (1 - 1.0e-6)) {
                ++pairs;
                ASSERT_EQ(around.count(j), 1U) << i << " and " << j;
            }
    }
    EXPECT_GT(pairs, 15000U) << "the cloud is dense enough for the test";
}

// Density by brute force, in double: (3) with poly6.
TEST_P(LinkedList, DensityIsTheSumOverAllPairs) {
    Bench b(*gpu->device, true);
    ASSERT_TRUE(b.grid);
    b.run();
    const std::vector<float> density = b.byId<float>(b.particles.density);
    const double h = double{kReach}, factor = 315 / (64 * 3.14159265358979323846 * std::pow(h, 9)) * double{b.step.mass} / 1000;
    for (uint32_t i = 0; i < b.step.count; ++i) {
        if (!b.cloud.inside(i)) continue;
        double sum = 0;
        for (uint32_t j = 0; j < b.step.count; ++j) {
            if (!b.cloud.inside(j)) continue;
            const dvec3 d = dvec3(b.cloud.position[i]) - dvec3(b.cloud.position[j]);
            sum += std::pow(std::max(h * h - glm::dot(d, d), 0.0), 3);
        }
        ASSERT_NEAR(static_cast<double>(density[i]) / (sum * factor), 1.0, 1.0e-5) << i;
    }
}

TEST_P(LinkedList, AStepIsTheSortedGridsToOnePartInAHundredThousand) {
    Bench sorted(*gpu->device, false), linked(*gpu->device, true);
    ASSERT_TRUE(sorted.grid && linked.grid);
    sorted.run();
    linked.run();
    const auto close = [&](const char* what, const auto& a, const auto& b, auto of) {
        double worst = 0, largest = 0;
        for (uint32_t i = 0; i < linked.step.count; ++i) {
            if (!linked.cloud.inside(i)) continue;
            worst = std::max(worst, double{glm::length(of(a[i], i) - of(b[i], i))});
            largest = std::max(largest, double{glm::length(of(b[i], i))});
        }
        EXPECT_GT(largest, 0.0) << what;
        EXPECT_LT(worst / largest, 1.0e-5) << what;
    };
    const auto scalar = [](float v, uint32_t) { return vec3(v, 0, 0); };
    close("density", linked.byId<float>(linked.particles.density), sorted.byId<float>(sorted.particles.density), scalar);
    close("pressure", linked.byId<float>(linked.particles.pressure), sorted.byId<float>(sorted.particles.pressure), scalar);
    // The change in one step, so that forces are visible.
    const auto change = [&](const vec4& v, uint32_t i) { return vec3(v - linked.cloud.velocity[i]); };
    const auto moved = [&](const vec4& x, uint32_t i) { return vec3(x - linked.cloud.position[i]); };
    const auto ratio = [](const vec4& x, uint32_t) { return vec3(x.w, 0, 0); };
    const auto at = linked.byId<vec4>(linked.particles.positionNext), then = sorted.byId<vec4>(sorted.particles.positionNext);
    close("velocity", linked.byId<vec4>(linked.particles.velocityNext), sorted.byId<vec4>(sorted.particles.velocityNext), change);
    close("density ratio", at, then, ratio);
    const auto float3 = [&](const auto& values, uint32_t i) { return moved(values[i], i); };
    double worst = 0;
    for (uint32_t i = 0; i < linked.step.count; ++i)
        if (linked.cloud.inside(i)) worst = std::max(worst, double{glm::length(float3(at, i) - float3(then, i))});
    EXPECT_LT(worst, 3.0e-7) << "places are floats of up to 1.5 m";
    // Particles in no list do not change.
    for (const uint32_t i : {kBelow, kFar, kFree}) {
        EXPECT_EQ(at[i], linked.cloud.position[i]) << i;
        EXPECT_EQ(linked.byId<vec4>(linked.particles.velocityNext)[i], linked.cloud.velocity[i]) << i;
    }
    EXPECT_TRUE(std::isnan(at[kNaN].x));
    // The statistics count the same particles.
    double sums[2][7] = {};
    for (Bench* b : {&sorted, &linked})
        for (const StatsRow& r : b->stats()) {
            const double row[7] = {double{r.centre.x}, double{r.centre.w}, double{r.compression}, double{r.speed2Sum},
                                   double{r.inside},   double{r.lost},     double{r.nans}};
            for (int k = 0; k < 7; ++k) sums[b == &linked][k] += row[k];
        }
    for (int k = 0; k < 7; ++k) EXPECT_NEAR(sums[1][k], sums[0][k], 1.0e-5 * std::abs(sums[0][k])) << k;
    EXPECT_EQ(sums[1][4], linked.step.count - 4.0);
    EXPECT_EQ(sums[1][5], 3.0) << "lost";
    EXPECT_EQ(sums[1][6], 1.0) << "of them NaN";
}

// The neighbour search for drawing uses the lists too.
TEST_P(LinkedList, EllipsoidsAreTheSortedGrids) {
    std::array<std::vector<vec4>, 3> found[2];
    for (const bool linked : {false, true}) {
        Bench b(*gpu->device, linked);
        ASSERT_TRUE(b.grid);
        ASSERT_TRUE(b.grid->build(b.step, b.particles));
        Ellipsoids ellipsoids;
        const Status ready = ellipsoids.prepare(b.device, b.traits, b.step.count);
        ASSERT_TRUE(ready) << ready.error().message;
        ellipsoids.find(b.device, b.step, *b.grid, b.particles);
        for (size_t k = 0; k < 3; ++k) found[linked][k] = b.byId<vec4>(*ellipsoids.buffers()[k]);
    }
    const Cloud cloud = jittered();
    for (uint32_t i = 0; i < cloud.id.size(); ++i)
        for (size_t k = 0; k < 3 && cloud.inside(i); ++k)
            ASSERT_LT(glm::length(found[1][k][i] - found[0][k][i]), 1.0e-4F) << "of particle " << i << ", part " << k;
}

// On the sorted grid the order of all sums is fixed: the bits are the same for work groups of any size.
TEST_P(LinkedList, AnyWorkGroupGivesTheSameStep) {
    Bench usual(*gpu->device, false);
    ASSERT_TRUE(usual.grid);
    usual.run();
    const std::vector<vec4> expected = usual.byId<vec4>(usual.particles.velocityNext);
    for (const uint32_t size : {32U, 128U, 256U, 512U}) {
        Bench b(*gpu->device, false, size);
        ASSERT_TRUE(b.grid);
        b.run();
        const std::vector<vec4> got = b.byId<vec4>(b.particles.velocityNext);
        for (uint32_t i = 0; i < b.step.count; ++i)
            if (i != kNaN) ASSERT_EQ(got[i], expected[i]) << "particle " << i << ", work groups of " << size;
        Bench lists(*gpu->device, true, size);
        ASSERT_TRUE(lists.grid);
        lists.run();
        const std::vector<float> density = lists.byId<float>(lists.particles.density), here = usual.byId<float>(usual.particles.density);
        for (uint32_t i = 0; i < b.step.count; ++i)
            if (lists.cloud.inside(i)) ASSERT_NEAR(density[i] / here[i], 1.0F, 1.0e-5F) << "work groups of " << size;
    }
    const std::vector<std::string> made = gpu->device->kernels();
    EXPECT_NE(std::find(made.begin(), made.end(), "fluid/methods/wcsph_forces;LINKED_LIST=1;LOCAL_SIZE=256;MOVES=1;THESIS=1"), made.end());
}

FluidParams fallingBlock(const char* grid) {
    FluidParams p;
    p.method = "wcsph_thesis";
    p.grid = grid;
    p.spacing = 0.04F;
    p.viscosity = 1.0e-3F;
    p.box.max = vec3(1.0F, 0.8F, 0.4F);
    p.blocks = {{vec3(0.0F, 0.04F, 0.0F), vec3(0.4F, 0.56F, 0.4F), vec3(0.0F)}};
    p.maxParticles = 1400;  // free slots among them
    return p;
}

struct Bulk {
    dvec3 centre{0.0};
    double kinetic = 0, density = 0;
    size_t particles = 0;
};

// Computed from the data that a host reads, by the code of `--stats`.
Bulk bulkOf(FluidWorld& world) {
    const HostParticles all = readParticles(world);
    Bulk b;
    b.particles = all.position.size();
    for (size_t i = 0; i < b.particles; ++i) {
        b.centre += dvec3(all.position[i]) / static_cast<double>(b.particles);
        b.kinetic += 0.5 * glm::dot(dvec3(all.velocity[i]), dvec3(all.velocity[i]));
        b.density += double{all.position[i].w} / static_cast<double>(b.particles);
    }
    return b;
}

TEST_P(LinkedList, After200StepsTheWaterIsWhereTheSortedGridsIs) {
    Bulk bulk[2];
    for (const char* name : {"sorted", "linked_list"}) {
        const FluidParams p = fallingBlock(name);
        auto world = FluidWorld::create(*gpu->device, p, {}, {});
        ASSERT_TRUE(world) << world.error().message;
        for (int k = 0; k < 200; ++k) {
            (*world)->step({.gravity = p.gravity}, 1.0e-3);
            ASSERT_EQ((*world)->lastSubsteps(), 1);
        }
        gpu->device->finish();
        gpu->device->poll();
        const FluidStats& stats = (*world)->stats();
        Bulk& b = bulk[p.grid == "linked_list"];
        b = bulkOf(**world);
        EXPECT_EQ(b.particles, 1300U);
        EXPECT_EQ(stats.particles, 1300U) << name;
        EXPECT_EQ(stats.lost, 0U) << name;
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(stats.centreOfMass[k], b.centre[k], 1.0e-5) << name;
    }
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(bulk[1].centre[k] / bulk[0].centre[k], 1.0, 0.01) << k;
    EXPECT_NEAR(bulk[1].kinetic / bulk[0].kinetic, 1.0, 0.02);
    EXPECT_NEAR(bulk[1].density / bulk[0].density, 1.0, 0.01);
}

TEST_P(LinkedList, ASavedWorldContinues) {
    const FluidParams p = fallingBlock("linked_list");
    auto first = FluidWorld::create(*gpu->device, p, {}, {}), second = FluidWorld::create(*gpu->device, p, {}, {});
    ASSERT_TRUE(first && second);
    for (int k = 0; k < 21; ++k) (*first)->step({.gravity = p.gravity}, 1.0e-3);
    WorldState state;
    (*first)->save(state);
    const Status done = (*second)->restore(state);
    ASSERT_TRUE(done) << done.error().message;
    for (int k = 0; k < 5; ++k)
        for (FluidWorld* w : {first->get(), second->get()}) w->step({.gravity = p.gravity}, 1.0e-3);
    const std::vector<vec3> here = positions(**first), there = positions(**second);
    ASSERT_EQ(here.size(), there.size());
    // Particles keep their slots; the order of sums differs from run to run.
    for (size_t i = 0; i < here.size(); ++i) ASSERT_LT(glm::length(here[i] - there[i]), 1.0e-5F) << i;
    const FluidParams other = fallingBlock("sorted");
    auto sorted = FluidWorld::create(*gpu->device, other, {}, {});
    ASSERT_TRUE(sorted);
    (*first)->save(state);
    const Status refused = (*sorted)->restore(state);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("grid = linked_list"), std::string::npos) << refused.error().message;
}

TEST_P(LinkedList, NothingEntersASphereOfVoxels) {
    Result<SceneFile> scene = loadScene(std::string(RIVULET_SOURCE_DIR) + "/assets/scenes/sheet_on_sphere.json", {});
    ASSERT_TRUE(scene) << scene.error().message;
    scene->fluid.method = "wcsph_thesis";
    scene->fluid.grid = "linked_list";
    scene->fluid.blocks = {{vec3(0.3125F, 0.53125F, 0.3125F), vec3(0.6875F, 0.6015625F, 0.6875F), vec3(0.0F, -1.5F, 0.0F)}};
    auto session = Session::create(*scene, *gpu->device, {});
    ASSERT_TRUE(session) << session.error().message;
    FluidWorld& world = (*session)->world();
    const VoxelGrid& grid = (*session)->field().surface;
    float nearest = 1;
    for (int frame = 0; frame < 14; ++frame) {
        (*session)->step(1.0 / kFramesPerSecond, true);
        for (const vec4& x : readParticles(world).position) {
            ASSERT_FALSE(inSetVoxel(grid, x)) << "frame " << frame;
            nearest = std::min(nearest, glm::length(vec3(x) - vec3(0.5F, 0.28F, 0.5F)));
        }
    }
    EXPECT_LT(nearest, 0.225F + scene->fluid.spacing) << "the water reached the sphere";
    EXPECT_GT(nearest, 0.225F - 0.001F) << "and stayed outside";
    EXPECT_EQ(world.stats().lost, 0U);
}

INSTANTIATE_TEST_SUITE_P(Devices, LinkedList, testing::Values("gl", "cl"), [](const auto& row) { return std::string(row.param); });

// Features that linked lists do not support are refused with an error that names the key.
TEST(LinkedListRefusal, NamesTheKeyAndTheRemedy) {
    const auto sentence = [](Device& device, const FluidParams& p, const Sources& sources = {}) {
        const auto world = FluidWorld::create(device, p, {}, {}, sources);
        EXPECT_FALSE(world);
        return world ? std::string() : world.error().message;
    };
    const FluidParams good = fallingBlock("linked_list");
    const auto cpu = makeTestCpu();
    EXPECT_NE(sentence(*cpu, good).find("--backend gl"), std::string::npos);

    Result<TestGpu> gpu = makeTestGpu("gl");
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const auto refused = [&](const char* word, const Sources& sources, auto change) {
        FluidParams p = good;
        change(p);
        const std::string said = sentence(*gpu->device, p, sources);
        EXPECT_NE(said.find("linked_list"), std::string::npos) << said;
        EXPECT_NE(said.find(word), std::string::npos) << said;
        EXPECT_NE(said.find("choose"), std::string::npos) << said;
    };
    const auto asItIs = [](FluidParams&) {};
    for (const char* method : {"wcsph", "pbf", "dfsph"}) refused(method, {}, [&](FluidParams& p) { p.method = method; });
    Sources emitters, sinks, poured;
    emitters.emitters.emplace_back();
    sinks.sinks.emplace_back();
    poured.expectedDeposit = 1.0e-3;
    for (const Sources& s : {emitters, sinks, poured}) refused("emitters", s, asItIs);
    refused("fluid.foam.most", {}, [](FluidParams& p) { p.foam.most = 100; });
    refused("tension", {}, [](FluidParams& p) { p.forces.tension = 0.07F; });
    refused("normals", {}, [](FluidParams& p) { p.forces.normals = "gradient"; });
    refused("fluid.collision.walls", {}, [](FluidParams& p) { p.collision.walls = "no-slip"; });

    // A change of a live parameter: the refusal is reported, and the run continues.
    auto world = FluidWorld::create(*gpu->device, good, {}, {});
    ASSERT_TRUE(world) << world.error().message;
    FluidParams later = good;
    later.forces.vorticity = 1;
    later.grid = "sorted";  // takes effect in a new world
    ASSERT_TRUE((*world)->setParams(later));
    (*world)->step({.gravity = good.gravity}, 1.0e-3);
    ASSERT_EQ((*world)->stats().limited.size(), 1U);
    EXPECT_NE((*world)->stats().limited[0].find("vorticity"), std::string::npos);
    EXPECT_EQ((*world)->params().grid, "linked_list");
}

}  // namespace
}  // namespace rivulet::linked_list_test
