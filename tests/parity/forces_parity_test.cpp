// Every row of forces() gives the same result on cl and gl as on the cpu, for each particle and each form of its kernels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "fluid/sim/forces/force.h"
#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/methods/smoothing.h"
#include "tests/parity/devices.h"

namespace rivulet::forces_parity_test {
namespace {

constexpr float kSpacing = 0.03F;
constexpr int kSide = 12;

struct Case {
    const char* device;
    const char* row;
    bool matter, periodic;
    void (*set)(FluidParams&);
};

void calm(FluidParams&) {}
void implicitly(FluidParams& p) {
    p.forces.viscosity = "implicit";
    p.forces.viscosityIterations = 5;
    p.forces.viscosityTolerance = 1.0e-5F;
}
void explicitly(FluidParams& p) { p.forces.viscosity = "explicit"; }
void thesisNormals(FluidParams& p) { p.forces.normals = "thesis"; }
void gradientNormals(FluidParams& p) { p.forces.normals = "gradient"; }

std::vector<vec4> byId(const std::vector<uint32_t>& id, const std::vector<vec4>& values) {
    std::vector<vec4> sorted(values.size());
    for (size_t i = 0; i < id.size(); ++i) sorted[id[i]] = values[i];
    return sorted;
}

// Accelerations (or normals) by id, of a jittered block that moves at random, its last 100 particles samples on a body.
std::vector<vec4> result(Device& device, const Case& c, float dt = 2.0e-3F) {
    FluidParams p;
    p.method = "dfsph";
    p.spacing = kSpacing;
    p.viscosity = 0.01F;
    p.collision.walls = "no-slip";
    p.forces.tension = 0.5F;
    p.forces.adhesion = 0.5F;
    p.forces.thesisTension = -5.0F;
    p.forces.vorticity = 2.0F;
    p.forces.airDrag = 0.5F;
    p.forces.wind = vec3(3.0F, 0.0F, 1.0F);
    c.set(p);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> jitter(-0.15F, 0.15F), speed(-1.0F, 1.0F);
    std::vector<vec4> position, velocity, matter;
    std::vector<uint32_t> id;
    for (int z = 0; z < kSide; ++z)
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const vec3 cell(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
                position.emplace_back((cell + 0.55F + vec3(jitter(random), jitter(random), jitter(random))) * kSpacing, 1.0F);
                velocity.emplace_back(speed(random), speed(random), speed(random), 0.0F);
                matter.emplace_back(1.0F, y < 6 ? 1.0F : 1.25F, y < 6 ? 10.0F : 2.0F, y < 6 ? 0.0F : 1.0F);
                id.push_back(static_cast<uint32_t>(id.size()));
            }
    const uint32_t count = static_cast<uint32_t>(id.size());
    PairTraits traits;
    traits.matter = c.matter;
    traits.samples = c.matter ? 100 : 0;
    for (uint32_t k = count - 100; c.matter && k < count; ++k) matter[k] = vec4(0.7F, 0.0F, 1.0F, -1.0F);
    position[50] = vec4(0.5F, 0.7F, 0.5F, 1.0F);  // spray
    if (c.periodic) {
        traits.periodic.x = true;
        p.box.max.x = kSide * kSpacing;
    }
    auto grid = NeighborGrid::create(device, Bounds{p.box.min, p.box.max}, 2 * kSpacing, count, traits);
    auto particles = Particles::create(device, count, c.matter);
    if (!grid || !particles) return {};
    Buffer planes = std::move(*device.allocate(2 * sizeof(vec4)));
    const vec4 slope[2] = {vec4(0.0F, std::cos(0.2F), std::sin(0.2F), -0.01F), vec4(0.3F, 0.4F, 0.0F, 0.0F)};
    device.writeAll<vec4>(planes, slope);
    device.writeAll<vec4>(particles->positionNext, position);
    device.writeAll<vec4>(particles->velocityNext, velocity);
    device.writeAll<uint32_t>(particles->id, id);
    if (c.matter) device.writeAll<vec4>(particles->matterOf, matter);

    StepParams s{};
    s.gravity = vec4(p.gravity, 0.0F);
    s.boxMin = vec4(p.box.min, 1.0F);
    s.boxMax = vec4(p.box.max, 0.0F);
    if (c.periodic) {
        s.boxMin.x = -1.0e15F;
        s.boxMax.x = 1.0e15F;
    }
    s.count = count;
    s.h = 2 * kSpacing;
    s.invH = 1 / s.h;
    s.dt = dt;
    s.mass = 1000 * kSpacing * kSpacing * kSpacing;
    s.restDensity = 1000;
    s.viscosity = p.viscosity;
    s.contact = 0.5F * kSpacing;
    s.spacing = kSpacing;
    s.planeCount = 1;
    s.firstSample = count - traits.samples;
    grid->fill(s);
    fillSmoothing(p, s);
    s.firstSample = count - traits.samples;
    EXPECT_TRUE(grid->build(s, *particles));
    const std::vector<uint32_t> order = device.readAll<uint32_t>(particles->id, count);
    const std::vector<vec4> sorted = device.readAll<vec4>(particles->position, count);
    const float lowest = std::min_element(sorted.begin(), sorted.end(), [](const vec4& a, const vec4& b) { return a.y < b.y; })->y;
    std::vector<float> density(count);
    std::vector<vec4> sortedMatter(count), nearWalls(4 * size_t{count}, vec4(0.0F));
    for (uint32_t i = 0; i < count; ++i) {
        density[i] = 0.6F + 0.001F * static_cast<float>(order[i] % 500);
        sortedMatter[i] = matter[order[i]];
        // One wall, below the block; the further two entries are out of reach.
        nearWalls[i] = vec4(0.0F, 1.0F, 0.0F, sorted[i].y - lowest + 0.3F * s.spacing);
        nearWalls[i + count] = nearWalls[i + 2 * size_t{count}] = vec4(0.0F, 1.0F, 0.0F, 4.0F * s.h);
    }
    device.writeAll<float>(particles->density, density);
    device.writeAll<vec4>(particles->nearWalls, nearWalls);
    if (c.matter) device.writeAll<vec4>(particles->matter, sortedMatter);
    auto kernel = [&](const char* path) {
        Result<Kernel> found = device.kernel(path);
        EXPECT_TRUE(found) << (found ? "" : found.error().message);
        return found ? *found : Kernel{};
    };
    const Kernel friction = kernel("fluid/forces/wall_friction"), adhesion = kernel("fluid/forces/wall_adhesion");
    SolveFigures solve;
    StepContext context{
        .device = device,
        .fluid = p,
        .params = s,
        .grid = *grid,
        .particles = *particles,
        .solve = solve,
        .stats = planes,
        .build = {},
        .pushSamples = {},
        .planes = planes,
        .nearWalls = {},
        .forces = {},
        .wallFriction =
            [&](const Buffer& at, Buffer& into) {
                device.run(friction, s, {&grid->cellStart(), &at, &planes, &into}, count);
                // As a moving wall would.
                std::vector<vec4> moving = device.readAll<vec4>(into, count);
                for (vec4& f : moving) f = vec4(0.3F * f.w, 0.1F * f.w, 0.0F, f.w);
                device.writeAll<vec4>(into, moving);
            },
        .wallAdhesion =
            [&](const StepParams& with) {
                device.run(adhesion, with, {&grid->cellStart(), &particles->position, &planes, &particles->acceleration}, count);
            }};
    const ForceRow* row = forces().find(c.row);
    EXPECT_NE(row, nullptr);
    if (row == nullptr) return {};
    EXPECT_TRUE(row->on(p, false));
    Result<ForcePass> pass = row->make(device, {p, count, traits});
    EXPECT_TRUE(pass) << (pass ? "" : pass.error().message);
    if (!pass) return {};
    (*pass)(context);
    const bool normals = std::string_view(c.row) == "normals";
    std::vector<vec4> values = device.readAll<vec4>(normals ? particles->normal : particles->acceleration, count);
    // Spray is left out: its value would be the largest by far.
    for (vec4& v : values)
        if (normals && v.w == 2.0F) v *= 1.0e-4F;
    return byId(order, values);
}

class ForcesParity : public testing::TestWithParam<std::tuple<const char*, Case>> {};

TEST_P(ForcesParity, ARowAgreesWithTheCpuToOnePartInAHundredThousand) {
    Case c = std::get<1>(GetParam());
    c.device = std::get<0>(GetParam());
    Result<TestGpu> gpu = makeTestGpu(c.device);
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    auto cpu = makeTestCpu();
    for (bool matter : {false, true})
        for (bool periodic : {false, true}) {
            c.matter = matter;
            c.periodic = periodic;
            const std::vector<vec4> expected = result(*cpu, c), got = result(*gpu->device, c);
            ASSERT_EQ(expected.size(), got.size());
            ASSERT_FALSE(expected.empty());
            double worst = 0, largest = 0;
            for (size_t i = 0; i < expected.size(); ++i)
                for (int k = 0; k < 4; ++k) {
                    ASSERT_TRUE(std::isfinite(expected[i][k]) && std::isfinite(got[i][k])) << i;
                    worst = std::max(worst, std::abs(double{expected[i][k]} - double{got[i][k]}));
                    largest = std::max(largest, std::abs(double{expected[i][k]}));
                }
            EXPECT_GT(largest, 0.0);
            EXPECT_LT(worst, 1.0e-5 * largest) << (matter ? "matter " : "") << (periodic ? "periodic" : "");
        }
}

INSTANTIATE_TEST_SUITE_P(Rows, ForcesParity,
                         testing::Combine(testing::Values("cl", "gl"),
                                          testing::Values(Case{"", "viscosity", false, false, explicitly},
                                                          Case{"implicit", "viscosity", false, false, implicitly},
                                                          Case{"thesis", "normals", false, false, thesisNormals},
                                                          Case{"gradient", "normals", false, false, gradientNormals},
                                                          Case{"", "thesis_tension", false, false, calm},
                                                          Case{"", "tension", false, false, calm},
                                                          Case{"", "vorticity", false, false, calm}, Case{"", "air", false, false, calm})),
                         [](const auto& row) {
                             const Case& c = std::get<1>(row.param);
                             return std::string(std::get<0>(row.param)) + "_" + c.row + (*c.device != 0 ? std::string("_") + c.device : "");
                         });

TEST(ForcesParity, ImplicitViscosityIsTheExplicitOneInShortSteps) {
    auto cpu = makeTestCpu();
    for (bool matter : {false, true})
        for (bool periodic : {false, true}) {
            const float dt = 1.0e-5F;
            const std::vector<vec4> a = result(*cpu, {"", "viscosity", matter, periodic, explicitly}, dt);
            const std::vector<vec4> b = result(*cpu, {"", "viscosity", matter, periodic, implicitly}, dt);
            double worst = 0, largest = 0;
            for (size_t i = 0; i < a.size(); ++i) {
                worst = std::max(worst, double{glm::length(vec3(a[i] - b[i]))});
                largest = std::max(largest, double{glm::length(vec3(a[i]))});
            }
            EXPECT_GT(largest, 1.0);
            EXPECT_LT(worst, 5.0e-3 * largest) << (matter ? "matter " : "") << (periodic ? "periodic" : "");
        }
}

}  // namespace
}  // namespace rivulet::forces_parity_test
