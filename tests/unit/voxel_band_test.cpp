// What the distance band stores beside the distance: the direction to the point, and whose wall is nearest.
#include "fluid/voxel/distance_band.h"

#include <gtest/gtest.h>

#include "fluid/voxel/voxel_field.h"
#include "tests/unit/voxel_kernels.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet {
namespace {

using test::Mesh;

vec3 unpack(uint32_t code) {
    vec3 n;
    test::unpackWall(code, &n.x);
    return n;
}

// rad; by the chord, which small angles do not drown in rounding.
double angle(const dvec3& a, const dvec3& b) { return 2.0 * std::asin(0.5 * glm::length(glm::normalize(a) - glm::normalize(b))); }

TEST(VoxelBand, DirectionsKeepTheirWord) {
    std::mt19937 random(3);
    std::normal_distribution<double> at;
    double worst = 0;
    for (int k = 0; k < 400000; ++k) {
        // Everywhere; near the eight diagonals, where the octahedron stretches most; near its edges and corners.
        dvec3 d(at(random), at(random), at(random));
        if (k % 4 == 1) d = glm::sign(d) + 1e-3 * dvec3(at(random), at(random), at(random));
        if (k % 4 == 2) d[k / 4 % 3] *= 1e-4;
        if (k % 4 == 3) d *= glm::mix(dvec3(1e-4), dvec3(1.0), dvec3(k / 4 % 3 == 0, k / 4 % 3 == 1, k / 4 % 3 == 2));
        const uint32_t surface = static_cast<uint32_t>(k) & 15U;
        const uint32_t code = packNormal(d, surface);
        vec3 n;
        ASSERT_EQ(test::unpackWall(code, &n.x), surface);
        worst = std::max(worst, angle(d, dvec3(n)));
    }
    std::printf("worst error of a stored direction: %.3g rad\n", worst);
    EXPECT_LT(worst, 1.73e-4 + 3e-7);  // what the header says, and unpacking in floats
    EXPECT_GT(worst, 1e-4);
    for (int axis = 0; axis < 3; ++axis) {
        for (double side : {-2.0, 1e-3}) {
            dvec3 d(0.0);
            d[axis] = side;
            EXPECT_LT(angle(d, dvec3(unpack(packNormal(d, 5)))), 2e-7) << axis << ' ' << side;
        }
    }
    EXPECT_EQ(packNormal(dvec3(0.0), 9) >> 28U, 9U);
    EXPECT_NEAR(glm::length(unpack(packNormal(dvec3(0.0), 9))), 1.0F, 1e-6F);
}

TEST(VoxelBand, EachPointKnowsWhoseWallIsNearest) {
    const Mesh meshes[] = {test::makeSphere(vec3(-0.6F, 0, 0), 0.5F, 12), test::makeBox(vec3(0.1F, -0.4F, -0.4F), vec3(0.9F, 0.4F, 0.4F)),
                           test::makeSheet(vec3(0, 0.7F, 0), vec3(0, 1, 0), 1.5F)};
    const MeshView views[] = {meshes[0].view(), meshes[1].view(), meshes[2].view()};
    const uint8_t surfaces[] = {3, 15, 0};
    const Result<VoxelField> all = bakeVoxelField(views, {.resolution = 40, .surfaces = surfaces});
    ASSERT_TRUE(all);
    size_t counted[3] = {};
    size_t k = 0;
    for (int z = 0; z <= all->surface.size.z; ++z) {
        for (int y = 0; y <= all->surface.size.y; ++y) {
            for (int x = 0; x <= all->surface.size.x; ++x, ++k) {
                if (!(all->distance[k] < all->band)) continue;
                const vec3 p = all->surface.origin + all->surface.voxel * vec3(x, y, z);
                // What each solid is said to be by its own formula; the sphere is a polyhedron, a little smaller.
                const vec3 q = glm::abs(p - vec3(0.5F, 0, 0)) - 0.4F;
                const float box = std::abs(glm::length(glm::max(q, vec3(0.0F))) + std::min(0.0F, std::max(q.x, std::max(q.y, q.z))));
                const vec3 s = glm::max(glm::abs(p - vec3(0, 0.7F, 0)) - vec3(0.75F, 0, 0.75F), vec3(0.0F));
                const float ways[] = {std::abs(glm::length(p - vec3(-0.6F, 0, 0)) - 0.5F), box, glm::length(s)};
                const size_t nearest = ways[0] < ways[1] ? (ways[0] < ways[2] ? 0 : 2) : (ways[1] < ways[2] ? 1 : 2);
                float second = all->band * 4;
                for (size_t m = 0; m < 3; ++m) second = m == nearest ? second : std::min(second, ways[m]);
                if (second - ways[nearest] < 0.03F) continue;
                ASSERT_EQ(all->normal[k] >> 28U, surfaces[nearest]) << x << ' ' << y << ' ' << z;
                ++counted[nearest];
            }
        }
    }
    for (size_t m = 0; m < 3; ++m) EXPECT_GT(counted[m], 1000U);

    const auto errorOf = [&](std::span<const uint8_t> list) {
        const Result<VoxelField> field = bakeVoxelField(views, {.resolution = 10, .surfaces = list});
        return field ? std::string("no error") : field.error().message;
    };
    const uint8_t tooMany[] = {0, 16, 2};
    EXPECT_NE(errorOf(tooMany).find("Surface 16 of mesh 2"), std::string::npos) << errorOf(tooMany);
    EXPECT_NE(errorOf(std::span(surfaces, 2)).find("2 surfaces for 3 meshes"), std::string::npos);
    EXPECT_EQ(errorOf({}), "no error");
}

// Floats only sieve; what they may not do is lose the nearest. Distances above are against brute force on this machine's instruction set.
TEST(VoxelBand, SameForAnyInstructionSet) {
    Mesh mesh = test::makeJumble(21, 140);
    for (const vec3& p : test::makeSphere(vec3(0.3F), 0.6F, 16).positions) mesh.positions.push_back(p);
    for (size_t k = mesh.indices.size(); k < mesh.positions.size(); ++k) mesh.indices.push_back(static_cast<uint32_t>(k));
    mesh.triangle(vec3(-900, -900, 0.2F), vec3(900, -800, 0.1F), vec3(10, 1000, 0.3F));  // far beyond the grid
    const MeshView view = mesh.view();
    VoxelGrid grid;
    grid.size = ivec3(49, 51, 46);
    grid.origin = vec3(-1.25F);
    grid.voxel = 0.05F;
    const GridTriangles list(std::span(&view, 1), grid);
    const size_t points = size_t{50} * 52 * 47;
    const auto bake = [&](Isa isa, std::vector<float>& distance, std::vector<uint32_t>& normal, std::vector<uint32_t>& nearest) {
        distance.assign(points, 0.27F);
        normal.assign(points, 0);
        nearest.assign(points, kNoTriangle);
        DistanceBand(grid, 0.27F, isa).bake(list, {}, {}, {}, {}, {distance, normal, nearest});
    };
    std::vector<float> distance, otherDistance;
    std::vector<uint32_t> normal, nearest, otherNormal, otherNearest;
    bake(Isa::generic, distance, normal, nearest);
    EXPECT_GT(std::count(nearest.begin(), nearest.end(), kNoTriangle), 1000);
    for (const Isa isa : {Isa::avx2, Isa::avx512}) {
        if (isa > bestIsa()) continue;
        bake(isa, otherDistance, otherNormal, otherNearest);
        EXPECT_TRUE(distance == otherDistance) << isaName(isa);
        EXPECT_TRUE(normal == otherNormal) << isaName(isa);
        EXPECT_TRUE(nearest == otherNearest) << isaName(isa);
    }
}

}  // namespace
}  // namespace rivulet
