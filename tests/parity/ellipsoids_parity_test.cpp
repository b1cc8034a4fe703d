// Ellipsoids about particles equal a reference in double precision on every device.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "fluid/sim/surface/ellipsoids.h"
#include "shaders/fluid/surface/anisotropy_params.h"
#include "tests/parity/devices.h"

namespace rivulet::ellipsoids_parity_test {
namespace {

using glm::dmat3;
using glm::dvec3;

constexpr float kSpacing = 0.03F;

struct Found {
    std::vector<vec4> centre, spread, slant;  // by id
};

// A jittered slab, four layers thick, a chain of particles, and a lone particle; with `samples` the last 20 are on a body.
std::vector<vec4> somePositions() {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> jitter(-0.2F, 0.2F);
    std::vector<vec4> all;
    for (int z = 0; z < 10; ++z)
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 10; ++x)
                all.emplace_back((vec3(x, y, z) + 3.0F + vec3(jitter(random), jitter(random), jitter(random))) * kSpacing, 1.0F);
    for (int k = 0; k < 6; ++k) all.emplace_back(vec3(5.0F + 0.9F * static_cast<float>(k), 15.0F, 5.0F) * kSpacing, 1.0F);
    all.emplace_back(vec3(20.0F) * kSpacing, 1.0F);
    return all;
}

Found foundBy(Device& device, const std::vector<vec4>& position, uint32_t samples) {
    const uint32_t count = static_cast<uint32_t>(position.size());
    PairTraits traits;
    traits.matter = samples > 0;
    traits.samples = samples;
    auto grid = NeighborGrid::create(device, Bounds{vec3(0.0F), vec3(1.0F)}, 2 * kSpacing, count, traits);
    auto particles = Particles::create(device, count, traits.matter);
    EXPECT_TRUE(grid && particles);
    if (!grid || !particles) return {};
    std::vector<uint32_t> id(count);
    for (uint32_t i = 0; i < count; ++i) id[i] = i;
    device.writeAll<vec4>(particles->positionNext, position);
    device.writeAll<vec4>(particles->velocityNext, std::vector<vec4>(count));
    device.writeAll<uint32_t>(particles->id, id);
    StepParams s{};
    s.boxMin = vec4(vec3(0.0F), 1.0F);
    s.boxMax = vec4(vec3(1.0F), 0.0F);
    s.count = count;
    s.h = 2 * kSpacing;
    s.invH = 1 / s.h;
    s.spacing = kSpacing;
    s.firstSample = count - samples;
    grid->fill(s);
    s.firstSample = count - samples;
    std::vector<vec4> matter(count, vec4(1.0F, 1.0F, 1.0F, 0.0F));
    for (uint32_t k = count - samples; k < count; ++k) matter[k] = vec4(0.7F, 0.0F, 1.0F, -1.0F);
    if (traits.matter) device.writeAll<vec4>(particles->matterOf, matter);
    EXPECT_TRUE(grid->build(s, *particles));
    const std::vector<uint32_t> order = device.readAll<uint32_t>(particles->id, count);
    if (traits.matter) {
        std::vector<vec4> sorted(count);
        for (uint32_t i = 0; i < count; ++i) sorted[i] = matter[order[i]];
        device.writeAll<vec4>(particles->matter, sorted);
    }
    Ellipsoids ellipsoids;
    EXPECT_EQ(ellipsoids.buffers()[0], nullptr);
    const Status ready = ellipsoids.prepare(device, traits, count);
    EXPECT_TRUE(ready) << (ready ? "" : ready.error().message);
    ellipsoids.find(device, s, *grid, *particles);
    Found found{std::vector<vec4>(count), std::vector<vec4>(count), std::vector<vec4>(count)};
    std::vector<vec4>* into[] = {&found.centre, &found.spread, &found.slant};
    for (size_t k = 0; k < 3; ++k) {
        const std::vector<vec4> sorted = device.readAll<vec4>(*ellipsoids.buffers()[k], count);
        for (uint32_t i = 0; i < count; ++i) (*into[k])[order[i]] = sorted[i];
    }
    return found;
}

// The formulas of anisotropy_params.h in double precision, with eigenvectors by angles. The squared half axes as a matrix, and the centre.
std::pair<dmat3, dvec3> exact(const std::vector<vec4>& position, size_t i, size_t fluid) {
    const double support = std::min(double{ANISOTROPY_SUPPORT}, 2.0) * double{kSpacing};
    double all = 0;
    dvec3 mean(0.0);
    dmat3 m(0.0), axes(1.0);
    for (size_t j = 0; j < fluid; ++j) {
        const dvec3 d = dvec3(position[j]) - dvec3(position[i]);
        const double w = std::max(1 - std::pow(glm::length(d) / support, 3), 0.0);
        all += w;
        mean += w * d;
        m += w * glm::outerProduct(d, d);
    }
    mean /= all;
    m = (m / all - glm::outerProduct(mean, mean)) / (double{ANISOTROPY_FULL} * support * support);
    for (int sweep = 0; sweep < 30; ++sweep)
        for (const auto& [p, q] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
            const double angle = 0.5 * std::atan2(2 * m[p][q], m[q][q] - m[p][p]);
            dmat3 turn(1.0);
            turn[p][p] = turn[q][q] = std::cos(angle);
            turn[q][p] = std::sin(angle);
            turn[p][q] = -turn[q][p];
            m = glm::transpose(turn) * m * turn;
            axes = axes * turn;
        }
    dvec3 half = glm::sqrt(glm::max(dvec3(m[0][0], m[1][1], m[2][2]), 0.0));
    half = glm::max(half, std::max({half.x, half.y, half.z}) / double{ANISOTROPY_RATIO});
    const double share = all / (double{ANISOTROPY_CROWD} * std::pow(support / double{kSpacing}, 3));
    const double kept = std::clamp((share - double{ANISOTROPY_FEW}) / double{ANISOTROPY_MANY - ANISOTROPY_FEW}, 0.0, 1.0);
    half = half * kept + double{ANISOTROPY_ALONE} * (1 - kept);
    dmat3 squares(0.0);
    for (int k = 0; k < 3; ++k) squares += half[k] * half[k] * glm::outerProduct(axes[k], axes[k]);
    return {squares, mean * double{ANISOTROPY_SMOOTHING}};
}

class EllipsoidsParity : public testing::TestWithParam<const char*> {};

TEST_P(EllipsoidsParity, theyEqualThoseOfAnEigensolverInDouble) {
    std::unique_ptr<Device> cpu = makeTestCpu();
    Result<TestGpu> gpu = failed("not asked for");
    Device* device = cpu.get();
    if (std::string_view(GetParam()) != "cpu") {
        gpu = makeTestGpu(GetParam());
        if (!gpu) GTEST_SKIP() << gpu.error().message;
        device = gpu->device.get();
    }
    const std::vector<vec4> position = somePositions();
    for (const uint32_t samples : {0U, 20U}) {
        const Found found = foundBy(*device, position, samples);
        ASSERT_EQ(found.centre.size(), position.size());
        for (size_t i = 0; i < position.size() - samples; ++i) {
            const auto [squares, centre] = exact(position, i, position.size() - samples);
            const vec4 d = found.spread[i], o = found.slant[i];
            const double got[] = {double{d.x}, double{d.y}, double{d.z}, double{o.x}, double{o.y}, double{o.z}};
            const double wanted[] = {squares[0][0], squares[1][1], squares[2][2], squares[1][2], squares[2][0], squares[0][1]};
            for (int k = 0; k < 6; ++k) EXPECT_NEAR(got[k], wanted[k], 2.0e-4) << i << " " << k << " of " << samples;
            for (int k = 0; k < 3; ++k) EXPECT_NEAR(double{found.centre[i][k]}, centre[k], 1.0e-5 * double{kSpacing} * 10) << i;
        }
    }
    // A lone particle is a ball of half the size; in a chain the longest axis lies along the chain.
    const Found found = foundBy(*device, position, 0);
    const size_t alone = position.size() - 1, chain = alone - 3;
    EXPECT_NEAR(found.spread[alone].x, ANISOTROPY_ALONE * ANISOTROPY_ALONE, 1.0e-5F);
    EXPECT_GT(found.spread[chain].x, 1.2F * found.spread[chain].y);
}

INSTANTIATE_TEST_SUITE_P(Devices, EllipsoidsParity, testing::Values("cpu", "cl", "gl"),
                         [](const auto& row) { return std::string(row.param); });

}  // namespace
}  // namespace rivulet::ellipsoids_parity_test
