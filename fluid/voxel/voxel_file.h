// .rvox: voxels in a file. Bits always; labels and the distance band where there are any.
//
// Numbers are in the byte order of the machine that wrote them, which is named in the header; 80 bytes of header, 40 a section, then the
// sections one after the other with no gap, each one zstd frame of its arrays (packed_array.h). XXH3 checks the header with the table of
// sections, and each section. Layout: voxel_file.cpp.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/result.h"
#include "fluid/voxel/labels.h"
#include "fluid/voxel/voxel_grid.h"
#include "fluid/voxel/voxelize.h"

namespace rivulet {

// At the grid's (size + 1) points an axis, x fastest: as VoxelField holds it.
struct VoxelBand {
    float band = 0;                // m, > 0
    bool closed = false;           // negative distances are inside; else there are none
    std::vector<float> distance;   // m, |distance| <= band
    std::vector<uint32_t> normal;  // packNormal of distance_band.h
};

struct VoxelFile {
    VoxelMode mode = VoxelMode::surface;
    VoxelGrid bits;
    std::optional<VoxelLabels> labels;  // of the same size
    std::optional<VoxelBand> band;
};

// The whole file as bytes. Error (failed): out of memory.
Result<std::string> packVoxelFile(const VoxelFile& file);

// Exactly what was packed. `name` is what errors call the file. Whatever the bytes are, the answer is a VoxelFile that keeps every
// promise of its types, or an Error (badInput: what is wrong, at which byte or section, and what to do; failed: out of memory).
// No more than `memoryLimit` bytes are taken for the result, and nothing large before the bytes that fill it were seen.
Result<VoxelFile> unpackVoxelFile(std::span<const std::byte> bytes, std::string_view name, size_t memoryLimit = size_t{4} << 30U);

// As above, to and from a file; appears whole under its name or not at all. The bytes written. Error also: not writable, not readable.
Result<size_t> writeVoxelFile(const std::string& path, const VoxelFile& file);
Result<VoxelFile> readVoxelFile(const std::string& path, size_t memoryLimit = size_t{4} << 30U);

}  // namespace rivulet
