// Every kernel of a step gives the same result on cl and gl as on the cpu, for each particle.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>

#include "fluid/sim/grid/neighbor_grid.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/world/fluid_world.h"
#include "fluid/sim/world/particles.h"
#include "shaders/fluid/world/stats_row.h"
#include "tests/parity/devices.h"

namespace rivulet::sim_parity_test {
namespace {

constexpr float kSpacing = 0.03F;
constexpr int kSide = 14;

struct Input {
    std::vector<vec4> position, velocity;
    std::vector<uint32_t> id;
};

// A jittered block in a corner of the unit box, around a ball, moving at random; two particles are lost before it begins.
// `most`: of the jitter, in spacings. Particles nearer to the mesh than contact are moved up.
Input disturbedBlock(const VoxelField* field, float most) {
    Input in;
    const float contact = field != nullptr ? fieldParams(*field, {.spacing = kSpacing}).contact : 0.0F;
    std::mt19937 random(7);
    std::uniform_real_distribution<float> jitter(-most, most), speed(-1.0F, 1.0F);
    for (int z = 0; z < kSide; ++z)
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const vec3 cell(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
                in.position.emplace_back((cell + 0.55F + vec3(jitter(random), jitter(random), jitter(random))) * kSpacing, 1.0F);
                if (field != nullptr && field->clearance(in.position.back()) < contact) in.position.back().y += 0.45F;
                in.velocity.emplace_back(speed(random), speed(random), speed(random), 0.0F);
                in.id.push_back(static_cast<uint32_t>(in.id.size()));
            }
    in.position[100].x = std::numeric_limits<float>::quiet_NaN();
    in.position[200].y = 17.0F;
    return in;
}

// A ball of rings and segments: shape quality does not matter for the field.
VoxelField ball() {
    std::vector<vec3> points;
    std::vector<uint32_t> triangles;
    const int rings = 12, sides = 20;
    for (int r = 0; r <= rings; ++r)
        for (int s = 0; s < sides; ++s) {
            const float theta = kPi * static_cast<float>(r) / rings, phi = 2 * kPi * static_cast<float>(s) / sides;
            points.push_back(vec3(0.2F, 0.12F, 0.22F) +
                             0.1F * vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)));
        }
    for (uint32_t r = 0; r < rings; ++r)
        for (uint32_t s = 0; s < sides; ++s) {
            const uint32_t a = r * sides + s, b = r * sides + (s + 1) % sides;
            for (uint32_t i : {a, b, a + sides, b, b + sides, a + sides}) triangles.push_back(i);
        }
    const MeshView mesh{points, triangles, {}, {}};
    Result<VoxelField> field = bakeVoxelField(std::span(&mesh, 1), {.resolution = 40, .band = 0.08F, .padding = 0.1F});
    EXPECT_TRUE(field) << (field ? "" : field.error().message);
    return field ? std::move(*field) : VoxelField{};
}

// The state after one step, by particle id.
using Fields = std::map<std::string, std::vector<vec4>>;

std::vector<vec4> byId(const std::vector<uint32_t>& id, const std::vector<vec4>& values) {
    std::vector<vec4> sorted(values.size());
    for (size_t i = 0; i < id.size(); ++i) sorted[id[i]] = values[i];
    return sorted;
}

// `iterations`: of a solver, the same on every device.
Fields oneStep(Device& device, const char* methodName, const VoxelField* field, int iterations = 1) {
    FluidParams p{.method = "wcsph"};
    p.spacing = kSpacing;
    p.pbf.iterations = iterations;
    p.dfsph.maxIterations = iterations;
    p.dfsph.tolerance = 1.0e-9F;
    // Corrections in a step are small compared with the support. The cpu's lists and a GPU's cells differ only just beyond it, which then
    // matters little.
    const Input in = disturbedBlock(field, iterations > 1 ? 0.02F : 0.15F);
    const uint32_t count = static_cast<uint32_t>(in.id.size());
    Fields out;
    auto method = methods().find(methodName)->make(device, {p, count, {}});
    EXPECT_TRUE(method) << (method ? "" : method.error().message);
    auto grid = NeighborGrid::create(device, Bounds{p.box.min, p.box.max}, 2 * kSpacing, count);
    auto particles = Particles::create(device, count);
    std::vector<Define> defines;
    if (field != nullptr) defines.push_back({"FIELD", "1"});
    auto nearWalls = device.kernel("fluid/solids/near_walls", defines), follow = device.kernel("fluid/solids/follow_walls"),
         collide = device.kernel("fluid/solids/collide"), stats = device.kernel("fluid/world/stats");
    for (const Result<Kernel>* k : {&nearWalls, &follow, &collide, &stats}) {
        EXPECT_TRUE(*k) << (*k ? "" : k->error().message);
        if (!*k) return out;
    }
    if (!method || !grid || !particles) return out;
    Buffer planes = std::move(*device.allocate(2 * sizeof(vec4)));
    // The plane cuts into the block. A solver would move the particles behind it so far that their neighbours change; for solvers the plane
    // lies a little lower.
    const bool pbf = std::string_view(methodName) == "pbf", solver = pbf || std::string_view(methodName) == "dfsph";
    const vec4 slope[2] = {vec4(0.0F, std::cos(0.2F), std::sin(0.2F),
                                iterations > 1 ? 0.05F
                                : solver       ? -0.01F
                                               : -0.06F),
                           vec4(0.3F, 0.4F, 0.0F, 0.0F)};
    device.writeAll<vec4>(planes, slope);
    device.writeAll<vec4>(particles->positionNext, in.position);
    device.writeAll<vec4>(particles->velocityNext, in.velocity);
    device.writeAll<uint32_t>(particles->id, in.id);

    StepParams s{};
    s.gravity = vec4(p.gravity, 0.0F);
    s.boxMin = vec4(p.box.min, 1.0F);
    s.boxMax = vec4(p.box.max, 0.0F);
    s.count = count;
    s.h = 2 * kSpacing;
    s.invH = 1 / s.h;
    // PBF's velocities are differences of positions over dt, DFSPH's correct density errors over dt: rounding matters less in steps of the
    // usual length.
    s.dt = pbf ? 4.0e-3F : solver ? 2.0e-3F : 2.0e-4F;
    s.mass = 1000 * kSpacing * kSpacing * kSpacing;
    s.restDensity = 1000;
    s.viscosity = 1.0e-3F;
    s.contact = 0.5F * kSpacing;
    s.friction = 0.1F;
    s.restitution = 0.2F;
    s.spacing = kSpacing;
    s.maxSpeed = 1.5F;
    s.planeCount = 1;
    grid->fill(s);
    (*method)->fill(p, 1.0F, s);
    std::vector<uint32_t> id;
    auto keep = [&](const char* name, const Buffer& b, bool vector) {
        std::vector<vec4> values;
        if (vector)
            values = device.readAll<vec4>(b, count);
        else
            for (float f : device.readAll<float>(b, count)) values.emplace_back(f, 0, 0, 0);
        out[name] = byId(id, values);
    };
    Buffer block, bits, distance, normal;
    FieldParams fieldBlock{};
    if (field != nullptr) {
        fieldBlock = fieldParams(*field, {.spacing = kSpacing, .countIndex = s.cellCount});
        block = std::move(*device.allocate(sizeof(FieldParams)));
        bits = std::move(*device.allocate(field->surface.bits.size()));
        distance = std::move(*device.allocate(field->distance.size() * sizeof(float)));
        device.write(block, std::as_bytes(std::span(&fieldBlock, 1)));
        device.writeAll<uint8_t>(bits, field->surface.bits);
        std::vector<uint32_t> normals = field->normal;
        for (uint32_t word : surfaceWords({}, {0.1F, 0.2F})) normals.push_back(word);
        normal = std::move(*device.allocate(normals.size() * sizeof(uint32_t)));
        device.writeAll<float>(distance, field->distance);
        device.writeAll<uint32_t>(normal, normals);
    }
    SolveFigures solve;
    const Buffer statsRows = std::move(*device.allocate(STATS_THREADS * sizeof(StatsRow)));  // nothing moves
    StepContext context{
        .device = device,
        .fluid = p,
        .params = s,
        .grid = *grid,
        .particles = *particles,
        .solve = solve,
        .stats = statsRows,
        .build =
            [&](bool) {
                EXPECT_TRUE(grid->build(s, *particles));
                id = device.readAll<uint32_t>(particles->id, count);
                keep("reorder position", particles->position, true);
                keep("reorder velocity", particles->velocity, true);
                return true;
            },
        .pushSamples = [](const Buffer&, const Buffer&, float, const vec3&) {},
        .planes = planes,
        .nearWalls =
            [&](const Buffer& position) {
                if (field != nullptr)
                    device.run(*nearWalls, s, {&grid->cellStart(), &position, &planes, &particles->nearWalls, &block, &distance}, count);
                else
                    device.run(*nearWalls, s, {&grid->cellStart(), &position, &planes, &particles->nearWalls}, count);
            },
        .followWalls =
            [&](const Buffer& from, const Buffer& to) {
                device.run(*follow, s, {&grid->cellStart(), &from, &to, &particles->nearWalls}, count);
            },
        .forces = [] {}};
    (*method)->step(context);
    if (std::string_view(methodName) != "wcsph_thesis") keep("nearest wall", particles->nearWalls, true);
    keep("density", particles->density, false);
    keep("pressure", particles->pressure, false);
    if (!pbf) keep("acceleration", particles->acceleration, true);
    keep("integrate position", particles->positionNext, true);
    keep("integrate velocity", particles->velocityNext, true);
    if (field != nullptr) {
        device.run(
            *collide, fieldBlock,
            {&particles->position, &particles->positionNext, &particles->velocityNext, &grid->cellStart(), &bits, &distance, &normal},
            count);
        keep("collide position", particles->positionNext, true);
        keep("collide velocity", particles->velocityNext, true);
    }
    Buffer rows = std::move(*device.allocate(STATS_THREADS * sizeof(StatsRow)));
    device.run(*stats, s, {&grid->cellStart(), &particles->positionNext, &particles->velocityNext, &rows}, STATS_THREADS);
    vec4 sums[3] = {vec4(0), vec4(0), vec4(0)};
    for (const StatsRow& r : device.readAll<StatsRow>(rows, STATS_THREADS)) {
        sums[0] += r.centre;
        sums[1] += vec4(r.compression, r.speed2Sum, r.limited, r.nans);
        sums[2] = glm::max(sums[2], vec4(r.worst, r.speed2Max, 0, 0));
    }
    for (int k = 0; k < 3; ++k) out["stats " + std::to_string(k)] = {sums[k]};
    EXPECT_EQ(sums[0].w, static_cast<float>(count - 2)) << "two particles were lost from the start";
    EXPECT_EQ(sums[1].w, 1.0F) << "one of them is NaN";
    return out;
}

// Largest difference over the largest value, over all finite values; a value that is NaN on one device must be NaN on the other.
double difference(const std::vector<vec4>& a, const std::vector<vec4>& b) {
    double worst = 0, largest = 0;
    for (size_t i = 0; i < a.size(); ++i)
        for (int k = 0; k < 4; ++k) {
            if (std::isnan(a[i][k]) || std::isnan(b[i][k])) {
                if (std::isnan(a[i][k]) != std::isnan(b[i][k])) return 1;
                continue;
            }
            worst = std::max(worst, std::abs(double{a[i][k]} - double{b[i][k]}));
            largest = std::max(largest, std::abs(double{b[i][k]}));
        }
    return largest > 0 ? worst / largest : worst;
}

struct Case {
    const char* device;
    const char* method;
    bool field;
};

class SimParity : public testing::TestWithParam<Case> {};

TEST_P(SimParity, EveryKernelAgreesWithTheCpuToOnePartInAHundredThousand) {
    Result<TestGpu> gpu = makeTestGpu(GetParam().device);
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const VoxelField field = GetParam().field ? ball() : VoxelField{};
    const VoxelField* used = GetParam().field ? &field : nullptr;
    auto cpu = makeTestCpu();
    const Fields expected = oneStep(*cpu, GetParam().method, used), got = oneStep(*gpu->device, GetParam().method, used);
    ASSERT_GE(expected.size(), 9U);
    ASSERT_EQ(expected.size(), got.size());
    for (const auto& [name, values] : expected) {
        const double d = difference(got.at(name), values);
        EXPECT_LT(d, 1.0e-5) << name;
    }
}

class SolverParity : public SimParity {};

TEST_P(SolverParity, AWholeStepAgreesToOnePartInTenThousand) {
    Result<TestGpu> gpu = makeTestGpu(GetParam().device);
    if (!gpu) GTEST_SKIP() << gpu.error().message;
    const VoxelField field = GetParam().field ? ball() : VoxelField{};
    const VoxelField* used = GetParam().field ? &field : nullptr;
    auto cpu = makeTestCpu();
    const Fields expected = oneStep(*cpu, GetParam().method, used, 3), got = oneStep(*gpu->device, GetParam().method, used, 3);
    for (const auto& [name, values] : expected) EXPECT_LT(difference(got.at(name), values), 1.0e-4) << name;
}

std::string nameOf(const testing::TestParamInfo<Case>& row) {
    return std::string(row.param.device) + "_" + row.param.method + (row.param.field ? "_over_a_mesh" : "");
}
INSTANTIATE_TEST_SUITE_P(Devices, SimParity,
                         testing::Values(Case{"cl", "wcsph", false}, Case{"cl", "wcsph", true}, Case{"cl", "wcsph_thesis", false},
                                         Case{"cl", "pbf", false}, Case{"cl", "pbf", true}, Case{"cl", "dfsph", true},
                                         Case{"gl", "pbf", false}, Case{"gl", "pbf", true}, Case{"gl", "dfsph", true},
                                         Case{"gl", "wcsph", false}, Case{"gl", "wcsph", true}, Case{"gl", "wcsph_thesis", false}),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(Devices, SolverParity,
                         testing::Values(Case{"cl", "pbf", false}, Case{"cl", "pbf", true}, Case{"cl", "dfsph", true},
                                         Case{"gl", "pbf", false}, Case{"gl", "pbf", true}, Case{"gl", "dfsph", true}),
                         nameOf);

uint64_t hashOf(Device& device, const FluidWorld& world) {
    uint64_t hash = 1469598103934665603ULL;
    auto add = [&](const Buffer& b) {
        for (uint32_t word : device.readAll<uint32_t>(b, b.bytes() / 4)) hash = (hash ^ word) * 1099511628211ULL;
    };
    const ParticleView view = world.particles();
    add(*view.position);
    add(*view.velocity);
    add(*view.id);
    return hash;
}

TEST(SimSameness, ACpuRunIsBitwiseTheSameForAnyThreadsAndInstructionSet) {
    const VoxelField field = ball();
    uint64_t first = 0;
    struct Run {
        int threads;
        Isa isa;
    };
    for (Run run :
         {Run{1, bestIsa()}, Run{2, bestIsa()}, Run{2, bestIsa()}, Run{2, Isa::generic}, Run{2, std::min(bestIsa(), Isa::avx2)}}) {
        auto device = makeTestCpu(run.threads, run.isa);
        FluidParams p{.method = "wcsph"};
        p.spacing = kSpacing;
        p.blocks = {{vec3(0.0F, 0.3F, 0.0F), vec3(0.4F, 0.7F, 0.4F), vec3(0.0F)}};
        auto world = FluidWorld::create(*device, p, {.field = &field}, {});
        ASSERT_TRUE(world) << world.error().message;
        for (int frame = 0; frame < 12; ++frame) (*world)->step({.gravity = p.gravity}, 1.0 / 60);
        const uint64_t hash = hashOf(*device, **world);
        if (first == 0) first = hash;
        EXPECT_EQ(hash, first) << run.threads << " threads, " << isaName(run.isa);
    }
}

}  // namespace
}  // namespace rivulet::sim_parity_test
