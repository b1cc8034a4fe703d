// The distance band stores the direction to the point and the surface number of the nearest wall.
#include "fluid/voxel/distance_band.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>

#include "fluid/voxel/voxel_field.h"
#include "tests/unit/voxel_kernels.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::voxel_band_test {
namespace {

using test::Mesh;

vec3 unpack(uint32_t code) {
    vec3 n;
    test::unpackWall(code, &n.x);
    return n;
}

// rad; by the chord, which is accurate for small angles.
double angle(const dvec3& a, const dvec3& b) { return 2.0 * std::asin(0.5 * glm::length(glm::normalize(a) - glm::normalize(b))); }

TEST(VoxelBand, PackedDirectionsAreWithinTheStatedAngle) {
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
        ASSERT_LT(glm::length(n - unpackNormal(code)), 1e-6F) << "the host unpacks what kernels do";
        worst = std::max(worst, angle(d, dvec3(n)));
    }
    std::printf("worst error of a stored direction: %.3g rad\n", worst);
    EXPECT_LT(worst, 1.73e-4 + 3e-7);  // the bound of the header, and unpacking in floats
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

TEST(VoxelBand, EachPointStoresTheSurfaceOfTheNearestWall) {
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
                // Distances by each solid's formula; the sphere is a polyhedron, slightly smaller.
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

// The sieve in floats must not lose the nearest triangle. The tests above compare with brute force on this machine's instruction set.
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

// Reverses every face.
Mesh inverted(Mesh mesh) {
    for (size_t k = 0; k + 2 < mesh.indices.size(); k += 3) std::swap(mesh.indices[k + 1], mesh.indices[k + 2]);
    return mesh;
}

// Merges vertices that rounding separated, at seams and poles.
Mesh welded(Mesh mesh) {
    for (vec3& p : mesh.positions) p = glm::round(p * 16384.0F) / 16384.0F;
    return mesh;
}

std::vector<MeshView> viewsOf(const std::vector<Mesh>& meshes) {
    std::vector<MeshView> views(meshes.size());
    std::transform(meshes.begin(), meshes.end(), views.begin(), [](const Mesh& mesh) { return mesh.view(); });
    return views;
}

Mesh joined(const std::vector<Mesh>& meshes) {
    Mesh all;
    for (const Mesh& mesh : meshes) {
        for (uint32_t i : mesh.indices) all.indices.push_back(i + static_cast<uint32_t>(all.positions.size()));
        all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
    }
    return all;
}

// The winding number of the mesh at p, by solid angles (van Oosterom and Strackee 1983).
double winding(const Mesh& mesh, const dvec3& p) {
    double sum = 0;
    for (size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
        const dvec3 a = dvec3(mesh.positions[mesh.indices[k]]) - p, b = dvec3(mesh.positions[mesh.indices[k + 1]]) - p,
                    c = dvec3(mesh.positions[mesh.indices[k + 2]]) - p;
        const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
        sum +=
            2.0 * std::atan2(glm::dot(a, glm::cross(b, c)), la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
    }
    return sum / (4.0 * 3.14159265358979323846);
}

// Compares with `inside` at every grid point further than `margin` (voxels) from the surface.
void expectSigns(const std::vector<Mesh>& meshes, int resolution, const char* name, const std::function<bool(const dvec3&)>& inside) {
    const std::vector<MeshView> views = viewsOf(meshes);
    const Result<VoxelField> field = bakeVoxelField(views, {.resolution = resolution});
    ASSERT_TRUE(field);
    EXPECT_TRUE(field->closed) << name;
    const VoxelGrid& grid = field->surface;
    size_t wrong = 0, within = 0, k = 0;
    for (int z = 0; z <= grid.size.z; ++z) {
        for (int y = 0; y <= grid.size.y; ++y) {
            for (int x = 0; x <= grid.size.x; ++x, ++k) {
                const float d = field->distance[k];
                if (std::abs(d) < 1e-4F * grid.voxel) continue;
                wrong += inside(dvec3(grid.origin) + static_cast<double>(grid.voxel) * dvec3(x, y, z)) != (d < 0.0F) ? 1 : 0;
                within += d < 0.0F ? 1 : 0;
            }
        }
    }
    EXPECT_EQ(wrong, 0U) << name;
    EXPECT_GT(within, 100U) << name;
}

TEST(VoxelBand, NegativeInsideClosedMeshes) {
    const Mesh ball = welded(test::makeSphere(vec3(0.1F, 0, 0), 0.5F, 10));
    const auto windsRound = [](const Mesh& mesh) { return [&mesh](const dvec3& p) { return std::abs(winding(mesh, p)) > 0.5; }; };
    expectSigns({ball}, 20, "ball", windsRound(ball));
    const Mesh out = inverted(ball);
    expectSigns({out}, 20, "ball inside out", windsRound(out));
    const Mesh shell = welded(joined({test::makeSphere(vec3(0), 1.0F, 9), inverted(test::makeSphere(vec3(0.1F), 0.6F, 9))}));
    expectSigns({shell}, 20, "shell", windsRound(shell));
    // Two overlapping meshes, one of them inverted: each has its own inside.
    const Mesh box = inverted(test::makeBox(vec3(0.2F, -0.3F, -0.2F), vec3(0.9F, 0.3F, 0.4F)));
    expectSigns({ball, box}, 20, "ball and box",
                [&](const dvec3& p) { return std::abs(winding(ball, p)) > 0.5 || std::abs(winding(box, p)) > 0.5; });
    const Mesh cup = test::readObj(test::testMesh("generated/thin_wall_cup.obj"));
    expectSigns({cup}, 24, "cup", windsRound(cup));
}

TEST(VoxelBand, UnsignedUnlessAllMeshesAreClosed) {
    Mesh open = welded(test::makeSphere(vec3(0), 0.5F, 10));
    open.indices.resize(open.indices.size() - 3);
    const Mesh ball = welded(test::makeSphere(vec3(1.2F, 0, 0), 0.5F, 10)), sheet = test::makeSheet(vec3(0), vec3(0, 1, 0), 1.0F);
    for (const std::vector<Mesh>& meshes : {std::vector<Mesh>{open}, {ball, open}, {sheet, ball}}) {
        const std::vector<MeshView> views = viewsOf(meshes);
        const Result<VoxelField> field = bakeVoxelField(views, {.resolution = 20});
        ASSERT_TRUE(field);
        EXPECT_FALSE(field->closed);
        EXPECT_GE(*std::min_element(field->distance.begin(), field->distance.end()), 0.0F);
    }
}

// Kernels and clearance read the distance from either side: the sign changes nothing for them.
TEST(VoxelBand, TheSignDoesNotChangeTheDistanceOfKernelsAndClearance) {
    const Mesh ball = welded(test::makeSphere(vec3(0), 0.5F, 12));
    const MeshView view = ball.view();
    const Result<VoxelField> field = bakeVoxelField(std::span(&view, 1), {.resolution = 30});
    ASSERT_TRUE(field && field->closed);
    VoxelField plain = *field;
    for (float& d : plain.distance) d = std::abs(d);
    const FieldParams params = fieldParams(*field, {});
    std::mt19937 random(2);
    std::uniform_real_distribution<float> at(-0.7F, 0.7F);
    size_t far = 0;
    for (int k = 0; k < 20000; ++k) {
        const vec3 p(at(random), at(random), at(random)), q = p + 0.05F * vec3(at(random), at(random), at(random));
        EXPECT_EQ(field->clearance(p), plain.clearance(p));
        vec3 gradient, plainGradient;
        EXPECT_EQ(test::fieldAt(&params, field->distance.data(), &p.x, &gradient.x),
                  test::fieldAt(&params, plain.distance.data(), &p.x, &plainGradient.x));
        EXPECT_EQ(gradient, plainGradient);
        const bool isFar = test::farFromField(&params, field->distance.data(), &p.x, &q.x);
        EXPECT_EQ(isFar, test::farFromField(&params, plain.distance.data(), &p.x, &q.x));
        far += isFar ? 1 : 0;
    }
    EXPECT_GT(far, 1000U);
}

// A tube without ends about `axis`, through the origin.
Mesh makeTube(const vec3& axis, float radius, float length, int sides) {
    const vec3 u = glm::normalize(glm::cross(axis, vec3(0, 0, 1))), v = glm::cross(glm::normalize(axis), u);
    const vec3 half = glm::normalize(axis) * (0.5F * length);
    const auto at = [&](int k) {
        const float angle = 2.0F * kPi * static_cast<float>(k) / static_cast<float>(sides);
        return radius * (u * std::cos(angle) + v * std::sin(angle));
    };
    Mesh m;
    for (int k = 0; k < sides; ++k) m.quad(at(k) - half, at(k + 1) - half, at(k + 1) + half, at(k) + half);
    return m;
}

struct Angles {
    double mean = 0, p95 = 0;
};

// At contact distance, outside and inside. `surface` gives a random point of the true surface and its normal there.
template <class Surface>
std::array<Angles, 2> normalErrors(const Mesh& mesh, int resolution, const Surface& surface) {
    const MeshView view = mesh.view();
    const Result<VoxelField> field = bakeVoxelField(std::span(&view, 1), {.resolution = resolution});
    EXPECT_TRUE(field);
    const FieldParams params = fieldParams(*field, {});
    std::mt19937 random(static_cast<unsigned>(resolution));
    std::array<Angles, 2> out;
    for (size_t inside = 0; inside < 2; ++inside) {
        const float side = inside == 0 ? 1.0F : -1.0F;
        std::vector<double> angles;
        for (int k = 0; k < 5000; ++k) {
            vec3 point, normal, gradient;
            surface(random, point, normal);
            const vec3 p = point + side * params.contact * normal;
            test::fieldAt(&params, field->distance.data(), &p.x, &gradient.x);
            angles.push_back(angle(dvec3(gradient), dvec3(side * normal)) * 180.0 / 3.14159265358979323846);
        }
        std::sort(angles.begin(), angles.end());
        for (double x : angles) out[inside].mean += x / static_cast<double>(angles.size());
        out[inside].p95 = angles[angles.size() * 95 / 100];
    }
    return out;
}

// accuracy.md, wall normals: the gradient of the interpolated distance where particles rest, compared with the true surfaces that the
// meshes approximate. The error of the facets is included: 0.5 degrees at most for the ball, 0.35 for the tube.
TEST(VoxelBand, WallNormals) {
    std::normal_distribution<float> bell;
    std::uniform_real_distribution<float> even(-0.5F, 0.5F);
    const Mesh ball = test::makeSphere(vec3(0), 0.5F, 120);
    const auto onBall = [&](std::mt19937& random, vec3& point, vec3& normal) {
        normal = glm::normalize(vec3(bell(random), bell(random), bell(random)));
        point = 0.5F * normal;
    };
    const vec3 axis = glm::normalize(vec3(0.3F, 1, 0.2F));
    const Mesh tube = makeTube(axis, 0.3F, 1.0F, 512);
    const auto onTube = [&](std::mt19937& random, vec3& point, vec3& normal) {
        const vec3 out(bell(random), bell(random), bell(random));
        normal = glm::normalize(out - axis * glm::dot(out, axis));
        point = 0.3F * normal + axis * (0.9F * even(random));
    };
    const float slope = 7.0F * kPi / 180.0F;
    const vec3 up(std::sin(slope), std::cos(slope), 0.0F);
    const Mesh plane = test::makeSheet(vec3(0), up, 1.0F);
    const auto onPlane = [&](std::mt19937& random, vec3& point, vec3& normal) {
        const vec3 p(even(random), even(random), even(random));
        normal = up;
        point = 0.6F * (p - up * glm::dot(p, up));
    };
    std::printf("wall normals at contact distance, degrees: mean, 95 %%\n");
    for (const int resolution : {32, 64, 128}) {
        const auto b = normalErrors(ball, resolution, onBall), t = normalErrors(tube, resolution, onTube),
                   p = normalErrors(plane, resolution, onPlane);
        for (size_t side = 0; side < 2; ++side) {
            std::printf("%4d voxels, %s  sphere %.3f %.3f  cylinder %.3f %.3f  plane at 7 degrees %.4f %.4f\n", resolution,
                        side == 0 ? "outside" : "inside ", b[side].mean, b[side].p95, t[side].mean, t[side].p95, p[side].mean, p[side].p95);
            for (const Angles& a : {b[side], t[side], p[side]}) {
                EXPECT_TRUE(resolution < 64 || a.mean < 1.0) << resolution;
                EXPECT_TRUE(resolution < 64 || a.p95 < 3.0) << resolution;
            }
            EXPECT_LT(p[side].p95, 0.01) << "a plane has no second wall to blend with";
        }
    }
}

}  // namespace
}  // namespace rivulet::voxel_band_test
