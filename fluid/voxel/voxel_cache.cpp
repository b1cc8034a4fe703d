#include "fluid/voxel/voxel_cache.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <new>

#include "engine/compute/disk_cache.h"
#include "engine/core/private_file.h"
#include "fluid/voxel/voxel_file.h"

namespace rivulet {

extern const char kBakerVersion[];  // made by baker_version.cmake

namespace {

namespace fs = std::filesystem;

constexpr const char* kEnding = ".rvox";

// 32 hexadecimal digits: a hash of everything that can change a field.
std::string keyOf(std::span<const MeshView> meshes, const VoxelFieldOptions& options) {
    const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(), XXH3_freeState);
    if (!state) throw std::bad_alloc();
    (void)XXH3_128bits_reset(state.get());
    const auto take = [&state](auto items) { (void)XXH3_128bits_update(state.get(), items.data(), items.size_bytes()); };
    const auto takeOne = [&take](auto value) { take(std::span(&value, 1)); };
    take(std::span(std::string_view(kBakerVersion)));
    takeOne(options.resolution);
    takeOne(options.band);
    takeOne(options.padding);
    takeOne(options.memoryLimit);
    takeOne(options.surfaces.size());
    take(options.surfaces);
    takeOne(meshes.size());
    for (const MeshView& mesh : meshes) {
        takeOne(mesh.positions.size());
        takeOne(mesh.indices.size());
        take(mesh.positions);
        take(mesh.indices);
    }
    const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

VoxelFile fileOf(VoxelField field, const std::string& key) {
    return {VoxelMode::surface, std::move(field.surface), std::nullopt,
            VoxelBand{field.band, field.closed, std::move(field.distance), std::move(field.normal)}, key};
}

VoxelField fieldOf(VoxelFile file) {
    return {std::move(file.bits), std::move(file.band->distance), std::move(file.band->normal), file.band->band, file.band->closed};
}

// True if the file has a band as wide as the options and the kernels require; the file may come from anywhere.
bool isFieldFor(const VoxelFile& file, const VoxelFieldOptions& options) {
    return file.band && file.band->band >= options.band && file.band->band >= 0.999F * kBandVoxels * file.bits.voxel;
}

// The field at `path`; empty if there is no valid file of this key.
std::optional<VoxelField> readField(const fs::path& path, const std::string& key, const VoxelFieldOptions& options, const Log& log) {
    std::error_code ignored;
    if (!fs::exists(path, ignored)) return std::nullopt;
    const auto again = [&log](const std::string& why) {
        log.notice(fmt::format("the cached voxels are baked again: {}", why));
        return std::nullopt;
    };
    if (Status trusted = checkPrivateFile(path.string()); !trusted) return again(trusted.error().message);
    Result<VoxelFile> file = readVoxelFile(path.string(), options.memoryLimit);
    if (!file) return again(file.error().message);
    if (file->key != key) return again(fmt::format("{} holds the voxels of another mesh or of other parameters", path.string()));
    if (!isFieldFor(*file, options)) return again(fmt::format("the content of {} does not match its name", path.string()));
    fs::last_write_time(path, fs::file_time_type::clock::now(), ignored);  // marks it as used, so trimCache keeps it longer
    return fieldOf(std::move(*file));
}

// Writes the field to the disk if possible, and returns it unchanged.
VoxelField writeField(const fs::path& path, const std::string& key, VoxelField field, const Log& log) {
    VoxelFile file = fileOf(std::move(field), key);
    const Result<std::string> bytes = packVoxelFile(file);
    Status written = bytes ? makePrivateFolder(path.parent_path().string()) : Status(bytes.error());
    if (written) written = writePrivateFile(path.string(), *bytes);
    if (!written)
        log.notice(fmt::format("the voxels of the scene's meshes are not stored for the next start: {}", written.error().message));
    if (written) trimCache(path.parent_path().string(), kEnding, SIZE_MAX, kVoxelCacheBytes);
    return fieldOf(std::move(file));
}

}  // namespace

std::string voxelCacheFolder() { return cacheFolder("voxels"); }

Result<VoxelField> cachedVoxelField(std::span<const MeshView> meshes, const VoxelFieldOptions& options, const Log& log) {
    const std::string folder = voxelCacheFolder();
    if (folder.empty()) return bakeVoxelField(meshes, options);
    if (Status trusted = checkPrivateFolder(folder); !trusted) {
        log.notice(fmt::format("the voxels of the scene's meshes are not cached: {}", trusted.error().message));
        return bakeVoxelField(meshes, options);
    }
    const std::string key = keyOf(meshes, options);
    const fs::path path = fs::path(folder) / (key + kEnding);
    if (std::optional<VoxelField> field = readField(path, key, options, log)) return std::move(*field);
    Result<VoxelField> field = bakeVoxelField(meshes, options);
    if (!field) return field;
    return writeField(path, key, std::move(*field), log);
}

}  // namespace rivulet
