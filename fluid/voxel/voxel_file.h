// .rvox: voxels in a file: bits, and optionally labels and the distance band.
//
// Numbers have the byte order of the machine that wrote them, given in the header. The header has 80 bytes, the table 40 bytes per section.
// The sections follow without gaps, each one zstd frame of its arrays (packed_array.h). XXH3 checks the header with the table, and each
// section. Layout: voxel_file.cpp.
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

// At the grid's (size + 1) points per axis, x fastest, as in VoxelField.
struct VoxelBand {
    float band = 0;                // m, > 0
    bool closed = false;           // true: negative distances are inside; false: there are none
    std::vector<float> distance;   // m, |distance| <= band
    std::vector<uint32_t> normal;  // packNormal of distance_band.h
};

struct VoxelFile {
    VoxelMode mode = VoxelMode::surface;
    VoxelGrid bits;
    std::optional<VoxelLabels> labels;  // of the same size
    std::optional<VoxelBand> band;
    std::string key = {};  // what the voxels were made from (voxel_cache.cpp), at most 1,024 bytes; empty: the file states none
};

// The whole file as bytes. Error (failed): out of memory.
Result<std::string> packVoxelFile(const VoxelFile& file);

// Returns exactly what was packed. `name`: the file's name in errors. For any bytes the result is a VoxelFile that satisfies every
// invariant of its types, or an Error (badInput: the fault, its byte or section, and the remedy; failed: out of memory). The result takes
// at most `memoryLimit` bytes, and large arrays are allocated only as their bytes are read.
Result<VoxelFile> unpackVoxelFile(std::span<const std::byte> bytes, std::string_view name, size_t memoryLimit = size_t{4} << 30U);

// The same, to and from a file. A file appears complete under its name or not at all. Writing returns the number of bytes. Further errors:
// not writable, not readable.
Result<size_t> writeVoxelFile(const std::string& path, const VoxelFile& file);
Result<VoxelFile> readVoxelFile(const std::string& path, size_t memoryLimit = size_t{4} << 30U);

}  // namespace rivulet
