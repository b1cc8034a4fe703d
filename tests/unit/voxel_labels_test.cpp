// Labels against a flood fill, voxel by voxel.
#include "fluid/voxel/labels.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <set>

#include "engine/core/jobs.h"

namespace rivulet::voxel_labels_test {
namespace {

VoxelGrid emptyGrid(const ivec3& size, float voxel = 0.5F) {
    VoxelGrid grid{size, vec3(1, 2, 3), voxel, {}};
    grid.bits.assign((grid.count() + 31) / 32 * 4, 0);
    return grid;
}

VoxelGrid randomGrid(const ivec3& size, double share, unsigned seed) {
    VoxelGrid grid = emptyGrid(size);
    std::mt19937 random(seed);
    std::bernoulli_distribution set(share);
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x)
                if (set(random)) grid.set({x, y, z});
    return grid;
}

template <class Body>
void forEach(const ivec3& size, const Body& body) {
    for (int z = 0; z < size.z; ++z)
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x) body(ivec3(x, y, z));
}

struct Flood {
    std::vector<uint32_t> label;
    std::vector<VoxelMaterial> materials;
    size_t outside = 0, surface = 0;
};

// Regions one by one, in order of their first voxel.
Flood flood(const VoxelGrid& surface, const VoxelGrid* inside) {
    Flood f;
    constexpr uint32_t kUnknown = 0xFFFFFFFF;
    f.label.assign(surface.count(), kUnknown);
    const auto within = [&](const ivec3& c) { return inside != nullptr && inside->test(c); };
    forEach(surface.size, [&](const ivec3& start) {
        if (surface.test(start)) {
            f.label[surface.index(start)] = kInsideSurface;
            ++f.surface;
            return;
        }
        if (f.label[surface.index(start)] != kUnknown) return;
        std::vector<ivec3> region{start};
        f.label[surface.index(start)] = kOutside;
        bool border = false;
        for (size_t k = 0; k < region.size(); ++k) {
            for (int axis = 0; axis < 3; ++axis) {
                for (int way : {-1, 1}) {
                    ivec3 c = region[k];
                    c[axis] += way;
                    if (!surface.contains(c)) border = true;
                    if (!surface.contains(c) || surface.test(c) || within(c) != within(start) || f.label[surface.index(c)] != kUnknown)
                        continue;
                    f.label[surface.index(c)] = kOutside;
                    region.push_back(c);
                }
            }
        }
        if (border && !within(start)) {
            f.outside += region.size();
            return;
        }
        VoxelMaterial material{region.size(), 0.125 * static_cast<double>(region.size()), start, start, inside == nullptr || within(start)};
        for (const ivec3& c : region) {
            f.label[surface.index(c)] = kFirstMaterial + static_cast<uint32_t>(f.materials.size());
            material.low = glm::min(material.low, c);
            material.high = glm::max(material.high, c);
        }
        f.materials.push_back(material);
    });
    return f;
}

void expectSame(const VoxelGrid& surface, const VoxelGrid* inside) {
    const Flood expected = flood(surface, inside);
    const VoxelLabels labels = labelRegions(surface, inside);
    ASSERT_EQ(labels.size, surface.size);
    EXPECT_EQ(labels.outside, expected.outside);
    EXPECT_EQ(labels.surface, expected.surface);
    ASSERT_EQ(labels.materials.size(), expected.materials.size());
    for (size_t k = 0; k < labels.materials.size(); ++k) {
        const VoxelMaterial &a = labels.materials[k], &b = expected.materials[k];
        EXPECT_EQ(a.voxels, b.voxels) << k;
        EXPECT_DOUBLE_EQ(a.volume, b.volume) << k;
        EXPECT_EQ(a.low, b.low) << k;
        EXPECT_EQ(a.high, b.high) << k;
        EXPECT_EQ(a.solid, b.solid) << k;
    }
    const VoxelGrid solid = solidBits(labels, surface);
    EXPECT_EQ(solid.bits.size(), surface.bits.size());
    EXPECT_EQ(solid.origin, surface.origin);
    size_t wrong = 0;
    forEach(surface.size, [&](const ivec3& c) {
        const uint32_t label = expected.label[surface.index(c)];
        wrong += labels.at(c) != label || solid.test(c) != (label != kOutside) ? 1 : 0;
    });
    EXPECT_EQ(wrong, 0U);
    if (inside == nullptr) {
        const std::vector<uint8_t> reached = reachableFromBorder(surface);
        for (size_t k = 0; k < reached.size(); ++k) ASSERT_EQ(reached[k] != 0, expected.label[k] == kOutside) << k;
    }
    for (size_t row = 0; row + 1 < labels.rowStart.size(); ++row) {
        ASSERT_EQ(labels.runs[labels.rowStart[row]].x, 0U);
        for (uint32_t k = labels.rowStart[row] + 1; k < labels.rowStart[row + 1]; ++k) {
            ASSERT_LT(labels.runs[k - 1].x, labels.runs[k].x);
            ASSERT_NE(labels.runs[k - 1].label, labels.runs[k].label);
        }
    }
}

TEST(VoxelLabels, AreTheRegionsOfAFloodFill) {
    unsigned seed = 1;
    for (const ivec3& size : {ivec3(1, 1, 1), ivec3(3, 1, 1), ivec3(1, 5, 7), ivec3(8, 8, 8), ivec3(9, 13, 40), ivec3(63, 5, 3),
                              ivec3(64, 4, 4), ivec3(65, 7, 35), ivec3(130, 11, 19), ivec3(200, 3, 2)}) {
        for (double share : {0.0, 0.05, 0.3, 0.45, 0.6, 0.95, 1.0}) {
            SCOPED_TRACE(seed);
            const VoxelGrid surface = randomGrid(size, share, ++seed);
            expectSame(surface, nullptr);
            const VoxelGrid inside = randomGrid(size, 0.4, ++seed);  // surface voxels too
            expectSame(surface, &inside);
        }
    }
}

// Set where the distance from the middle is one of `radii`, to within a voxel's diagonal.
VoxelGrid shells(int edge, const std::vector<double>& radii) {
    VoxelGrid grid = emptyGrid(ivec3(edge));
    forEach(grid.size, [&](const ivec3& c) {
        const double r = glm::length(dvec3(c) + 0.5 - 0.5 * edge);
        for (double radius : radii)
            if (std::abs(r - radius) < 0.87) grid.set(c);
    });
    return grid;
}

TEST(VoxelLabels, NestedShellsAndCavities) {
    const VoxelGrid surface = shells(48, {22.0, 16.0, 9.0, 4.0});
    expectSame(surface, nullptr);
    const VoxelLabels labels = labelRegions(surface, nullptr);
    ASSERT_EQ(labels.materials.size(), 4U);
    for (size_t k = 1; k < 4; ++k) EXPECT_LT(labels.materials[k].voxels, labels.materials[k - 1].voxels) << "the outer ones come first";

    // A thick wall with a cavity, and within it a ball: inside as in mode solid.
    VoxelGrid inside = emptyGrid(surface.size);
    forEach(surface.size, [&](const ivec3& c) {
        const double r = glm::length(dvec3(c) + 0.5 - 24.0);
        if ((r < 22.0 && r > 16.0) || r < 9.0) inside.set(c);
    });
    expectSame(surface, &inside);
    const VoxelLabels kinds = labelRegions(surface, &inside);
    ASSERT_EQ(kinds.materials.size(), 4U);
    EXPECT_TRUE(kinds.materials[0].solid);
    EXPECT_FALSE(kinds.materials[1].solid) << "the cavity";
    EXPECT_TRUE(kinds.materials[2].solid);
    EXPECT_EQ(kinds.at({-1, 3, 3}), kOutside);
    EXPECT_EQ(kinds.at({3, 3, 48}), kOutside);
}

// An open hole connects regions, however long the path is; a diagonal gap does not.
TEST(VoxelLabels, OneOpenVoxelConnectsADiagonalDoesNot) {
    VoxelGrid box = emptyGrid(ivec3(20));
    forEach(box.size, [&](const ivec3& c) {
        const ivec3 far = glm::abs(2 * c - ivec3(19));
        if (std::max(far.x, std::max(far.y, far.z)) == 15) box.set(c);  // the shell 2..17
    });
    EXPECT_EQ(labelRegions(box, nullptr).materials.size(), 1U);
    const auto clear = [](VoxelGrid grid, const ivec3& c) {
        const size_t i = grid.index(c);
        grid.bits[i >> 3U] = static_cast<uint8_t>(grid.bits[i >> 3U] & ~(1U << (i & 7U)));
        return grid;
    };
    EXPECT_EQ(labelRegions(clear(box, {2, 17, 9}), nullptr).materials.size(), 1U) << "an edge of the shell is open to outside only";
    EXPECT_EQ(labelRegions(clear(box, {17, 9, 11}), nullptr).materials.size(), 0U);
}

TEST(VoxelLabels, SameForAnyNumberOfThreads) {
    const VoxelGrid surface = randomGrid(ivec3(70, 60, 90), 0.68, 11), inside = randomGrid(ivec3(70, 60, 90), 0.5, 12);
    const VoxelLabels many = labelRegions(surface, &inside);
    const Workers one(1);
    const JobsScope scope(one.jobs());
    const VoxelLabels alone = labelRegions(surface, &inside);
    EXPECT_EQ(many.rowStart, alone.rowStart);
    ASSERT_EQ(many.runs.size(), alone.runs.size());
    for (size_t k = 0; k < many.runs.size(); ++k) ASSERT_EQ(many.runs[k].label, alone.runs[k].label);
    EXPECT_EQ(many.materials.size(), alone.materials.size());
}

TEST(VoxelLabels, ColoursHaveOneLightnessAndNeighboursDiffer) {
    std::vector<vec3> colours;
    for (uint32_t k = 0; k < 64; ++k) {
        const vec3 c = materialColour(k);
        colours.push_back(c);
        EXPECT_EQ(c, materialColour(k));
        for (int channel = 0; channel < 3; ++channel) {
            EXPECT_GT(c[channel], 0.0F) << k;
            EXPECT_LT(c[channel], 1.0F) << k;
        }
        const float luminance = 0.2126F * c.x + 0.7152F * c.y + 0.0722F * c.z;
        EXPECT_NEAR(luminance, 0.42F, 0.06F) << k;
        for (size_t before = colours.size() >= 5 ? colours.size() - 5 : 0; before + 1 < colours.size(); ++before)
            EXPECT_GT(glm::length(c - colours[before]), 0.1F) << k << " and " << before;
    }
}

}  // namespace
}  // namespace rivulet::voxel_labels_test
