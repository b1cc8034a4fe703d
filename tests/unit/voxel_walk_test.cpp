// The walk against a brute-force oracle: every set voxel that the exact segment touches. And the band's samples and normals.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <thread>

#include "fluid/voxel/voxel_field.h"
#include "tests/unit/voxel_kernels.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::voxel_walk_test {
namespace {

// The fraction t of the path at which a + d t enters the box low..high grown by `grow`, all in double; 2 if it misses.
double entry(const dvec3& a, const dvec3& d, const dvec3& low, double grow) {
    double from = 0, to = 1;
    for (int k = 0; k < 3; ++k) {
        const double l = low[k] - grow, h = low[k] + 1 + grow;
        if (d[k] == 0) {
            if (a[k] < l || a[k] > h) return 2;
        } else {
            const double one = (l - a[k]) / d[k], other = (h - a[k]) / d[k];
            from = std::max(from, std::min(one, other));
            to = std::min(to, std::max(one, other));
        }
    }
    return from <= to ? from : 2;
}

struct Grid {
    VoxelGrid voxels;
    alignas(16) FieldParams params{};
    std::vector<ivec3> set;

    explicit Grid(const ivec3& size) {
        voxels.size = size;
        voxels.voxel = 1;
        voxels.bits.assign((voxels.count() + 31) / 32 * 4, 0);
        params.origin = vec4(0, 0, 0, 1);
        params.sizeX = size.x;
        params.sizeY = size.y;
        params.sizeZ = size.z;
        params.voxel = 1;
        params.nudge = 1e-4F + 1e-6F * static_cast<float>(size.x + size.y + size.z);
    }
    void add(const ivec3& c) {
        if (!voxels.contains(c) || voxels.test(c)) return;
        voxels.set(c);
        set.push_back(c);
    }
    float walk(const vec3& a, const vec3& b) const {
        return test::walkVoxels(&params, reinterpret_cast<const uint32_t*>(voxels.bits.data()), &a.x, &b.x);
    }
    float walkThesis(const vec3& a, const vec3& b) const {
        return test::walkThesis(&params, reinterpret_cast<const uint32_t*>(voxels.bits.data()), &a.x, &b.x);
    }
};

struct Tally {
    size_t segments = 0, hits = 0, crossed = 0, imagined = 0, late = 0;
};

// Crossed: the exact segment touches a set voxel and the walk does not report it, or reports it only further on.
// Imagined: the walk reports a voxel that is further than the rounding allowance from the segment.
void tally(const Grid& grid, const vec3& a, const vec3& b, Tally& t) {
    const dvec3 from(a), way = dvec3(b) - from;
    const auto nudge = static_cast<double>(grid.params.nudge);
    const dvec3 low = glm::min(from, from + way) - 1.01, high = glm::max(from, from + way) + 0.01;
    double touched = 2, nearly = 2;
    for (const ivec3& c : grid.set) {
        const dvec3 corner(c);
        if (corner.x < low.x || corner.y < low.y || corner.z < low.z || corner.x > high.x || corner.y > high.y || corner.z > high.z)
            continue;
        touched = std::min(touched, entry(from, way, corner, 0));
        nearly = std::min(nearly, entry(from, way, corner, 2 * nudge));
    }
    const auto walked = static_cast<double>(grid.walk(a, b));
    ++t.segments;
    t.hits += touched <= 1 ? 1 : 0;
    t.crossed += touched <= 1 && walked > 1 ? 1 : 0;
    // Beyond the entry by at most the rounding error, which for a grazing segment is at most one voxel.
    t.late += touched <= 1 && walked <= 1 && (walked - touched) * glm::length(way) > 1.8 ? 1 : 0;
    t.imagined += walked <= 1 && nearly > 1 ? 1 : 0;
}

void expectTight(const Tally& t) {
    EXPECT_EQ(t.crossed, 0U) << "of " << t.segments << " segments, " << t.hits << " of which touch a set voxel";
    EXPECT_EQ(t.imagined, 0U);
    EXPECT_EQ(t.late, 0U);
    EXPECT_GT(t.hits, t.segments / 50);
    EXPECT_LT(t.hits, t.segments);
}

// A wall one voxel thick. Full: every voxel that a plane pierces. Else as thin as a wall can be: voxels that meet at edges and corners, but
// through whose faces no path leads.
Grid wall(const vec3& normal, float offset, bool full) {
    Grid g(ivec3(66));
    const vec3 n = glm::normalize(normal);
    const vec3 size = glm::abs(n);
    const float thick = 0.5F * (full ? size.x + size.y + size.z : std::max(size.x, std::max(size.y, size.z)));
    for (int z = 0; z < 66; ++z) {
        for (int y = 0; y < 66; ++y) {
            for (int x = 0; x < 66; ++x) {
                if (std::abs(glm::dot(n, vec3(x, y, z) + 0.5F - 33.0F) - offset) <= thick) g.add({x, y, z});
            }
        }
    }
    return g;
}

struct Passed {
    size_t tried = 0, through = 0, crossed = 0, crossedThesis = 0;
};

// Segments up to 64 voxels long through the middle of a wall, of which those that start on one side of it and end on the other count.
Passed throughWall(int tilt, int segments) {
    std::mt19937 random(static_cast<unsigned>(tilt) + 42);
    std::uniform_real_distribution<float> at(-1.0F, 1.0F);
    const vec3 special[] = {vec3(1, 0, 0),  vec3(0, 1, 0), vec3(0, 0, 1), vec3(1, 1, 0),
                            vec3(0, 1, -1), vec3(1, 0, 1), vec3(1, 1, 1), vec3(-1, 1, 1)};
    const vec3 normal = glm::normalize(tilt < 8 ? special[tilt] : vec3(at(random), at(random), at(random)));
    const float offset = at(random);
    const Grid g = wall(normal, offset, tilt % 4 >= 2);
    const vec3 along = glm::normalize(glm::cross(normal, std::abs(normal.x) < 0.8F ? vec3(1, 0, 0) : vec3(0, 1, 0)));
    Passed p;
    for (int k = 0; k < segments; ++k) {
        const vec3 middle = vec3(33) + 20.0F * vec3(at(random), at(random), at(random));
        vec3 half = glm::normalize(vec3(at(random), at(random), at(random))) * (16.0F * (1.0F + at(random)));
        if (k % 3 == 0) half = glm::round(half);                                // along diagonals and axes: ties
        if (k % 7 == 0) half = 30.0F * along + 3.0F * at(random) * normal;      // grazing
        const vec3 a = k % 5 == 0 ? glm::round(middle - half) : middle - half;  // from corners
        const vec3 b = a + 2.0F * half;
        ++p.tried;
        const vec3 ca = glm::floor(a), cb = glm::floor(b);
        if (!g.voxels.contains(ivec3(ca)) || !g.voxels.contains(ivec3(cb)) || g.voxels.test(ivec3(ca)) || g.voxels.test(ivec3(cb)))
            continue;
        const float sideA = glm::dot(normal, ca + 0.5F - 33.0F), sideB = glm::dot(normal, cb + 0.5F - 33.0F);
        if ((sideA > offset) == (sideB > offset)) continue;
        ++p.through;
        p.crossed += g.walk(a, b) > 1.0F ? 1 : 0;
        p.crossedThesis += g.walkThesis(a, b) > 1.0F ? 1 : 0;
    }
    return p;
}

// No segment passes walls one voxel thick: 1e7 segments, 40 tilts, on both cores. The thesis's walk, which takes one rounded sample per
// step of the longest axis, passes through their corners.
TEST(VoxelWalk, NoSegmentPassesAWallAtAnyTilt) {
    constexpr int kTilts = 40, kSegments = 250000;
    std::array<Passed, kTilts> tilts;
    const auto half = [&](int first) {
        for (int tilt = first; tilt < kTilts; tilt += 2) tilts[static_cast<size_t>(tilt)] = throughWall(tilt, kSegments);
    };
    std::thread other(half, 1);
    half(0);
    other.join();
    Passed all;
    double worst = 0;
    for (const Passed& p : tilts) {
        all.tried += p.tried;
        all.through += p.through;
        all.crossed += p.crossed;
        all.crossedThesis += p.crossedThesis;
        worst = std::max(worst, static_cast<double>(p.crossedThesis) / static_cast<double>(std::max<size_t>(p.through, 1)));
    }
    EXPECT_EQ(all.tried, 10000000U);
    EXPECT_GT(all.through, 1000000U);
    EXPECT_EQ(all.crossed, 0U);
    const double leaks = static_cast<double>(all.crossedThesis) / static_cast<double>(all.through);
    std::printf("of %zu segments from one side to the other the thesis's walk lets %zu pass: %.1f %%, %.1f %% at the worst tilt\n",
                all.through, all.crossedThesis, 100 * leaks, 100 * worst);
    EXPECT_GT(leaks, 0.01);
    EXPECT_GT(worst, 0.1);
}

// Scattered voxels, bars and single cells, 1e6 segments of every sort against the exact oracle.
TEST(VoxelWalk, AgreesWithBruteForce) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> at(0.0F, 1.0F);
    std::uniform_int_distribution<int> cell(0, 63);
    Tally t;
    for (int scene = 0; scene < 20; ++scene) {
        Grid g(ivec3(64, 60, 50));
        for (int k = 0; k < 40; ++k) g.add({cell(random), cell(random), cell(random)});
        for (int k = 0; k < 25; ++k) g.add({20 + k, 30, 25});
        for (int k = 0; k < 50000; ++k) {
            const auto corner = [&] { return vec3(cell(random), cell(random), cell(random)); };
            const vec3 target = vec3(g.set[static_cast<size_t>(random()) % g.set.size()]);
            vec3 a = vec3(64 * at(random), 60 * at(random), 50 * at(random));
            vec3 b = a;
            switch (k % 8) {
                case 0:
                    b = a + (64.0F * at(random)) * glm::normalize(vec3(at(random), at(random), at(random)) - 0.5F);
                    break;
                case 1:
                    a = corner();
                    b = corner();
                    break;  // lattice to lattice
                case 2:
                    b = 2.0F * (target + glm::round(vec3(at(random), at(random), at(random)))) - a;
                    break;  // by a voxel's corner
                case 3:
                    a.y = target.y;
                    b = vec3(64 * at(random), target.y, 50 * at(random));
                    break;  // in the plane of a face
                case 4:
                    a.y = target.y;
                    a.z = target.z + 1;
                    b = vec3(64 * at(random), a.y, a.z);
                    break;  // along an edge
                case 5:
                    a = target + vec3(1.5F * at(random)) - 0.25F;
                    b = a + 1e-3F * (vec3(at(random), at(random), at(random)) - 0.5F);
                    break;  // almost no motion
                case 6:
                    a = target - vec3(8) * at(random);
                    b = a + vec3(16) * at(random);
                    break;  // along diagonals
                default:
                    a = vec3(100, 70, -40) * (2 * at(random) - 0.5F);
                    b = target + vec3(at(random), at(random), at(random));
                    break;  // from outside the grid
            }
            tally(g, a, b, t);
        }
    }
    EXPECT_EQ(t.segments, 1000000U);
    expectTight(t);
}

// Without motion the walk samples the voxel of the point, or the voxels that meet there.
TEST(VoxelWalk, WithoutMotionSamplesItsOwnVoxel) {
    Grid g(ivec3(8));
    g.add({3, 4, 5});
    EXPECT_EQ(g.walk(vec3(3.5F, 4.5F, 5.5F), vec3(3.5F, 4.5F, 5.5F)), 0.0F);
    EXPECT_EQ(g.walk(vec3(4, 5, 6), vec3(4, 5, 6)), 0.0F);
    EXPECT_EQ(g.walk(vec3(4.01F, 4.5F, 5.5F), vec3(4.01F, 4.5F, 5.5F)), 2.0F);
    EXPECT_EQ(g.walk(vec3(2.5F, 4.5F, 5.5F), vec3(4.5F, 4.5F, 5.5F)), 0.25F);
}

struct Baked {
    VoxelField field;
    alignas(16) FieldParams params;
    float at(const vec3& p, vec3& gradient) const { return test::fieldAt(&params, field.distance.data(), &p.x, &gradient.x); }
};

Baked bake(const test::Mesh& mesh, int resolution, float band) {
    const MeshView view = mesh.view();
    VoxelFieldOptions options;
    options.resolution = resolution;
    options.band = band;
    Baked b{std::move(*bakeVoxelField(std::span(&view, 1), options)), {}};
    b.params = fieldParams(b.field, {});
    return b;
}

// accuracy.md: normals of a sphere and of a 7 degree plane, mean below 1 degree, 95 % below 3, from contact on.
TEST(VoxelBand, NormalsAreSmooth) {
    const Baked sphere = bake(test::makeSphere(vec3(0), 0.5F, 90), 64, 0.1F);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> at(-1.0F, 1.0F);
    std::vector<float> angles;
    for (int k = 0; k < 20000; ++k) {
        const vec3 out = glm::normalize(vec3(at(random), at(random), at(random)) + 1e-3F);
        const float away = sphere.params.contact * (1.0F + 0.5F * std::abs(at(random)));
        vec3 gradient;
        const float distance = sphere.at(out * (0.5F + away), gradient);
        EXPECT_NEAR(distance, away, 0.02F * sphere.params.voxel);
        angles.push_back(std::acos(std::min(1.0F, glm::dot(glm::normalize(gradient), out))) * 180.0F / kPi);
    }
    std::sort(angles.begin(), angles.end());
    double mean = 0;
    for (float a : angles) mean += static_cast<double>(a) / static_cast<double>(angles.size());
    EXPECT_LT(mean, 1.0);
    EXPECT_LT(angles[angles.size() * 95 / 100], 3.0F);

    const vec3 tilted(std::sin(7.0F * kPi / 180), std::cos(7.0F * kPi / 180), 0);
    const Baked plane = bake(test::makeSheet(vec3(0), tilted, 2.0F), 64, 0.2F);
    for (int k = 0; k < 1000; ++k) {
        const vec3 p = 0.5F * (vec3(at(random), at(random), at(random)) * (vec3(1) - tilted)) + tilted * plane.params.contact;
        const float height = glm::dot(p, tilted);
        if (height < plane.params.contact || height > 0.1F) continue;
        vec3 gradient;
        EXPECT_NEAR(plane.at(p, gradient), height, 1e-5F);
        EXPECT_GT(glm::dot(gradient, tilted), 0.99999F);
    }
}

// A point at kContactVoxels by the interpolated distance is in no set voxel, for any mesh.
TEST(VoxelBand, ContactIsOutsideEverySetVoxel) {
    const Baked b = bake(test::makeJumble(11, 35), 20, 0.0F);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> at(-1.3F, 1.3F);
    size_t inside = 0;
    for (int k = 0; k < 300000; ++k) {
        const vec3 p(at(random), at(random), at(random));
        vec3 gradient;
        if (b.at(p, gradient) < kContactVoxels * b.params.voxel) continue;
        inside += b.field.surface.test(b.field.surface.cellOf(p)) ? 1 : 0;
    }
    EXPECT_EQ(inside, 0U);
}

// The shortcut may be taken only where no wall is within contact.
TEST(VoxelBand, FarMeansFar) {
    const test::Mesh mesh = test::makeJumble(12, 21);
    const Baked b = bake(mesh, 24, 0.5F);
    std::mt19937 random(6);
    std::uniform_real_distribution<float> at(-2.0F, 2.0F);
    size_t far = 0;
    for (int k = 0; k < 20000; ++k) {
        const vec3 a(at(random), at(random), at(random));
        const vec3 z = a + 0.1F * vec3(at(random), at(random), at(random));
        if (!test::farFromField(&b.params, b.field.distance.data(), &a.x, &z.x)) continue;
        ++far;
        for (float t : {0.0F, 0.33F, 0.66F, 1.0F}) {
            vec3 gradient;
            const vec3 p = a + (z - a) * t;
            EXPECT_GE(b.at(p, gradient), b.params.contact);
            EXPECT_FALSE(b.field.surface.test(b.field.surface.cellOf(p)));
        }
    }
    EXPECT_GT(far, 5000U);
}

}  // namespace
}  // namespace rivulet::voxel_walk_test
