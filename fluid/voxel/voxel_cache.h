// Baked fields on the disk: the second start of a scene reads the field that the first one baked.
#pragma once

#include <span>
#include <string>

#include "engine/core/log.h"
#include "engine/core/mesh_view.h"
#include "fluid/voxel/voxel_field.h"

namespace rivulet {

// $XDG_CACHE_HOME/rivulet/voxels, else ~/.cache/rivulet/voxels; "" if neither variable is an absolute path: then nothing is stored.
std::string voxelCacheFolder();

// Limit of the folder; the least recently used file is removed first.
inline constexpr size_t kVoxelCacheBytes = size_t{1} << 30U;

// Returns bakeVoxelField(meshes, options), bit for bit, from the disk if an intact file exists. The key is a hash of the meshes, the
// options and the sources of the bakers; it is the name of the file and stands in it. A file with another key, or one that others may have
// written, is baked again with a notice; a folder that others may write to is not used (private_file.h). Errors are those of
// bakeVoxelField: a cache that is broken, full or not writable causes at most a notice. Any number of programs may use the folder at once.
Result<VoxelField> cachedVoxelField(std::span<const MeshView> meshes, const VoxelFieldOptions& options, const Log& log);

}  // namespace rivulet
