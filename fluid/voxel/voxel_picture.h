// Pictures of voxels: slices, and a view from outside. All are 8-bit sRGB with alpha 255, top row first, as in a PNG.
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

// Linear colours of all pictures: outside, the surface in a slice, and each material (paler for a cavity).
vec3 labelColour(const VoxelLabels& labels, uint32_t label);

// `linear`, 0..1, as sRGB bytes with alpha.
uint32_t srgbBytes(const vec3& linear);  // r in the lowest byte

// The axes that point right and up in a slice across `axis`. x: (2, 1), y: (0, 2), z: (0, 1).
ivec2 sliceAxes(int axis);

// The voxels c with c[axis] = `at`, one pixel each.
VoxelPicture drawSlice(const VoxelLabels& labels, int axis, int at);

// The same slice of the distance band, through the centres of those voxels, three pixels per voxel: pale far from the mesh, deep near it,
// with an iso-line at every fifth of the band; negative distances have a second hue. `distance` and `band` as in VoxelField, for a grid of
// `size` voxels.
VoxelPicture drawBandSlice(std::span<const float> distance, float band, const ivec3& size, int axis, int at);

// A sheet of up to 4 x 4 slices across z, evenly spaced from the first to the last slice that is not all outside, in reading order; the
// line under each slice shows its z. `distance` (empty: none) adds iso-lines at every fifth of `band`.
VoxelPicture drawSlices(const VoxelLabels& labels, std::span<const float> distance = {}, float band = 0);

struct VoxelViewOptions {
    int width = 1024, height = 768;
    int samples = 4;                       // rays per pixel, more at edges; 1..64
    bool cutOpen = true;                   // removes the nearest quarter, so that the inside is visible
    std::function<void(double)> progress;  // share done, 0..1; called from any thread, one call at a time
};

// The voxels on a pale ground under a bright sky, in three-quarter view from above; cut faces show the colours of the materials. Cavities
// are hollow. Above 512 voxels per side, several voxels are drawn as one block.
VoxelPicture drawVoxels(const VoxelLabels& labels, const VoxelViewOptions& options = {});

}  // namespace rivulet
