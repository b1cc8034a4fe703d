// Pictures of voxels: a pixel shows what its voxel is.
#include "fluid/voxel/voxel_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace rivulet::voxel_picture_test {
namespace {

// A closed box of surface voxels, one thick, in a grid with `air` voxels around it; all within is one material.
VoxelLabels makeShell(const ivec3& size, int air) {
    VoxelGrid grid;
    grid.size = size;
    grid.voxel = 1;
    grid.bits.assign((grid.count() + 31) / 32 * 4, 0);
    for (int z = air; z < size.z - air; ++z)
        for (int y = air; y < size.y - air; ++y)
            for (int x = air; x < size.x - air; ++x)
                if (x == air || y == air || z == air || x == size.x - air - 1 || y == size.y - air - 1 || z == size.z - air - 1)
                    grid.set({x, y, z});
    return labelRegions(grid, nullptr);
}

VoxelLabels makeNothing(const ivec3& size) {
    VoxelGrid grid;
    grid.size = size;
    grid.voxel = 1;
    grid.bits.assign((grid.count() + 31) / 32 * 4, 0);
    return labelRegions(grid, nullptr);
}

ivec3 rgbAt(const VoxelPicture& p, int x, int y) {
    const size_t at = 4 * (static_cast<size_t>(y) * static_cast<size_t>(p.width) + static_cast<size_t>(x));
    return {p.rgba[at], p.rgba[at + 1], p.rgba[at + 2]};
}

ivec3 rgbOf(const vec3& linear) {
    const uint32_t bytes = srgbBytes(linear);
    return {static_cast<int>(bytes & 255U), static_cast<int>((bytes >> 8U) & 255U), static_cast<int>((bytes >> 16U) & 255U)};
}

int brightness(const ivec3& rgb) { return rgb.x + rgb.y + rgb.z; }
// How far a colour is from grey.
int colourfulness(const ivec3& rgb) { return std::max(rgb.x, std::max(rgb.y, rgb.z)) - std::min(rgb.x, std::min(rgb.y, rgb.z)); }

TEST(VoxelPicture, ASlicesPixelsAreItsVoxels) {
    std::mt19937 random(11);
    VoxelGrid grid;
    grid.size = {23, 14, 9};
    grid.voxel = 1;
    grid.bits.assign((grid.count() + 31) / 32 * 4, 0);
    for (int k = 0; k < 1800; ++k)
        grid.set({static_cast<int>(random() % 23), static_cast<int>(random() % 14), static_cast<int>(random() % 9)});
    const VoxelLabels labels = labelRegions(grid, nullptr);
    ASSERT_GT(labels.materials.size(), 3U);
    for (int axis = 0; axis < 3; ++axis) {
        const ivec2 axes = sliceAxes(axis);
        EXPECT_TRUE(axes.x != axis && axes.y != axis && axes.x != axes.y);
        for (int at = 0; at < grid.size[axis]; ++at) {
            const VoxelPicture picture = drawSlice(labels, axis, at);
            ASSERT_EQ(picture.width, grid.size[axes.x]);
            ASSERT_EQ(picture.height, grid.size[axes.y]);
            for (int v = 0; v < picture.height; ++v) {
                for (int u = 0; u < picture.width; ++u) {
                    ivec3 c;
                    c[axis] = at;
                    c[axes.x] = u;
                    c[axes.y] = v;
                    ASSERT_EQ(rgbAt(picture, u, picture.height - 1 - v), rgbOf(labelColour(labels, labels.at(c))));
                }
            }
        }
    }
}

TEST(VoxelPicture, TheBandDarkensTowardsTheMesh) {
    // A plane at x = 8 of 16 voxels; the band is 5 wide.
    const ivec3 size(16, 6, 4);
    std::vector<float> distance(size_t{17} * 7 * 5);
    for (size_t k = 0; k < distance.size(); ++k) distance[k] = std::min(5.0F, std::abs(static_cast<float>(k % 17) - 8.0F));
    const VoxelPicture picture = drawBandSlice(distance, 5, size, 2, 1);
    ASSERT_EQ(picture.width, 48);
    ASSERT_EQ(picture.height, 18);
    const int y = picture.height / 2;
    EXPECT_LT(brightness(rgbAt(picture, 24, y)), brightness(rgbAt(picture, 31, y)));
    EXPECT_LT(brightness(rgbAt(picture, 31, y)), brightness(rgbAt(picture, 47, y)));
    EXPECT_EQ(rgbAt(picture, 0, y), rgbAt(picture, 47, y)) << "both ends are beyond the band";
    // A line of equal distance at 3 voxels, two pixels of three away from its neighbours.
    EXPECT_GT(brightness(rgbAt(picture, 33, y)), brightness(rgbAt(picture, 34, y)));
}

TEST(VoxelPicture, TheSheetShowsEverySixteenthOfTheMesh) {
    const VoxelLabels labels = makeShell({40, 30, 64}, 3);
    ASSERT_EQ(labels.materials.size(), 1U);
    const VoxelPicture sheet = drawSlices(labels);
    ASSERT_EQ(sheet.rgba.size(), 4 * static_cast<size_t>(sheet.width) * static_cast<size_t>(sheet.height));
    const ivec3 paper = rgbAt(sheet, 0, 0), surface = rgbOf(labelColour(labels, kInsideSurface)), inside = rgbOf(labelColour(labels, 2));
    const auto count = [&](const ivec3& rgb) {
        size_t n = 0;
        for (int y = 0; y < sheet.height; ++y)
            for (int x = 0; x < sheet.width; ++x) n += rgbAt(sheet, x, y) == rgb ? 1 : 0;
        return static_cast<double>(n);
    };
    EXPECT_EQ(rgbAt(sheet, sheet.width - 1, sheet.height - 1), paper);
    // 14 slices are a ring of surface around the material, the first and the last are surface alone.
    const double voxelPixels = (340.0 / 40) * (340.0 / 40), ring = 2 * 34 + 2 * 22, within = 32 * 22, whole = 34 * 24;
    EXPECT_NEAR(count(inside) / voxelPixels, 14 * within, 0.02 * 14 * within);
    EXPECT_NEAR(count(surface) / voxelPixels, 14 * ring + 2 * whole, 0.08 * (14 * ring + 2 * whole));
}

TEST(VoxelPicture, LinesOfEqualDistanceAreDrawn) {
    const VoxelLabels labels = makeNothing({32, 32, 4});
    std::vector<float> distance(size_t{33} * 33 * 5);
    for (size_t k = 0; k < distance.size(); ++k) distance[k] = std::abs(static_cast<float>(k % 33) - 16.0F);
    const VoxelPicture with = drawSlices(labels, distance, 10), without = drawSlices(labels);
    size_t changed = 0;
    for (int x = 0; x < with.width; ++x) changed += rgbAt(with, x, 100) != rgbAt(without, x, 100) ? 1 : 0;
    EXPECT_NEAR(static_cast<double>(changed), 4 * 8 * 2, 4 * 8) << "eight lines in each of four slices, two pixels each";
}

TEST(VoxelPicture, TheViewShowsTheShellAndCutOpenTheMaterial) {
    const VoxelLabels labels = makeShell({40, 40, 40}, 2);
    VoxelViewOptions options;
    options.width = 160;
    options.height = 120;
    options.samples = 8;
    options.cutOpen = false;
    const VoxelPicture closed = drawVoxels(labels, options);
    options.cutOpen = true;
    const VoxelPicture open = drawVoxels(labels, options);
    const ivec3 sky = rgbAt(open, 2, 2), shell = rgbAt(closed, 80, 60), cut = rgbAt(open, 80, 60);
    EXPECT_GT(brightness(sky), 640);
    EXPECT_LT(colourfulness(shell), 45);
    EXPECT_LT(brightness(shell), brightness(sky));
    // Its colour, under whatever light: the same order of red, green and blue.
    const ivec3 material = rgbOf(labelColour(labels, kFirstMaterial));
    EXPECT_GT(colourfulness(cut), 50);
    EXPECT_EQ(cut.x > cut.y, material.x > material.y);
    EXPECT_EQ(cut.y > cut.z, material.y > material.z);
    EXPECT_TRUE(drawVoxels(labels, options).rgba == open.rgba) << "the same every time";
    // A shadow lies on the ground to the right of it, away from the sun.
    EXPECT_LT(brightness(rgbAt(open, 125, 75)), brightness(rgbAt(open, 20, 110)) - 15);
}

TEST(VoxelPicture, GridsOfAnyShape) {
    VoxelViewOptions options;
    options.width = 64;
    options.height = 48;
    options.samples = 2;
    for (const ivec3& size : {ivec3(1, 1, 1), ivec3(1, 300, 1), ivec3(1400, 3, 3), ivec3(5, 5, 700)}) {
        for (const VoxelLabels& labels : {makeNothing(size), makeShell(size, 0)}) {
            const VoxelPicture sheet = drawSlices(labels), view = drawVoxels(labels, options);
            EXPECT_EQ(view.rgba.size(), size_t{4} * 64 * 48);
            EXPECT_EQ(sheet.rgba.size(), 4 * static_cast<size_t>(sheet.width) * static_cast<size_t>(sheet.height));
            EXPECT_LT(sheet.width, 2000);
        }
    }
}

}  // namespace
}  // namespace rivulet::voxel_picture_test
