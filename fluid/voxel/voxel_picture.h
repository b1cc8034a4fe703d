// Pictures of voxels: slices, and a view from outside. All 8-bit sRGB with alpha 255, top row first, as a PNG takes them.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "fluid/voxel/labels.h"

namespace rivulet {

struct VoxelPicture {
    int width = 0, height = 0;
    std::vector<uint8_t> rgba;  // 4 * width * height
};

// What the pictures agree on, linear: what is outside, the surface where a slice shows it, and a material's colour (paler for a cavity).
vec3 labelColour(const VoxelLabels& labels, uint32_t label);

// `linear`, 0..1, as sRGB bytes with alpha.
uint32_t srgbBytes(const vec3& linear);  // r in the lowest byte

// Which axes go right and up in a slice across `axis`. x: (2, 1), y: (0, 2), z: (0, 1).
ivec2 sliceAxes(int axis);

// The voxels c with c[axis] = `at`, one pixel each.
VoxelPicture drawSlice(const VoxelLabels& labels, int axis, int at);

// The same cut through the distance band, amid those voxels, three pixels a voxel: pale far off, deep near the mesh, a line of equal
// distance every fifth of the band; negative distances in a second hue. `distance` and `band` as VoxelField has them, of a grid of `size`
// voxels.
VoxelPicture drawBandSlice(std::span<const float> distance, float band, const ivec3& size, int axis, int at);

// A sheet of up to 4 x 4 slices across z, evenly from the first to the last that is not all outside, from the left and the top on; the
// line under each shows where it lies. `distance` (empty: none) adds lines of equal distance every fifth of `band`.
VoxelPicture drawSlices(const VoxelLabels& labels, std::span<const float> distance = {}, float band = 0);

struct VoxelViewOptions {
    int width = 1024, height = 768;
    int samples = 4;                       // rays a pixel, more at edges; 1..64
    bool cutOpen = true;                   // without the quarter that is nearest, so that what is inside can be seen
    std::function<void(double)> progress;  // the share that is done, 0..1; from any thread, one at a time
};

// The voxels on a pale ground, seen from three quarters and above, under a bright sky; materials in their colours where they are cut.
// Cavities are hollow. More than 512 voxels a side are drawn as blocks of several.
VoxelPicture drawVoxels(const VoxelLabels& labels, const VoxelViewOptions& options = {});

}  // namespace rivulet
