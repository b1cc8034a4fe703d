// Baked fields kept on the disk: the second start of a scene reads what the first one made.
#pragma once

#include <span>
#include <string>

#include "engine/core/log.h"
#include "engine/core/mesh_view.h"
#include "fluid/voxel/voxel_field.h"

namespace rivulet {

// $XDG_CACHE_HOME/rivulet/voxels, else ~/.cache/rivulet/voxels; "" where neither variable holds an absolute path: nothing is kept then.
std::string voxelCacheFolder();

// As much as the folder keeps; who was used longest ago goes first.
inline constexpr size_t kVoxelCacheBytes = size_t{1} << 30U;

// bakeVoxelField(meshes, options), bit for bit, from the disk where it is there and intact. Known by the content of the meshes, the options
// and the sources of the bakers. Errors are bakeVoxelField's alone: a cache that is broken, full or not writable is a notice at most.
// Any number of programs may do so at once.
Result<VoxelField> cachedVoxelField(std::span<const MeshView> meshes, const VoxelFieldOptions& options, const Log& log);

}  // namespace rivulet
