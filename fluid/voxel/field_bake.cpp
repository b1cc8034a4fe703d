#include "fluid/voxel/field_bake.h"

#include <new>
#include <utility>

#include "engine/core/background.h"

namespace rivulet {

struct FieldBake::State {
    std::vector<BakedMesh> meshes;
    VoxelFieldOptions options;
    std::unique_ptr<Background<VoxelField>> run;

    Result<VoxelField> bake() {
        std::vector<MeshView> views;
        std::vector<uint8_t> surfaces;
        views.reserve(meshes.size());
        surfaces.reserve(meshes.size());
        for (const BakedMesh& mesh : meshes) {
            views.push_back({.positions = mesh.positions, .indices = mesh.indices, .normals = {}, .uvs = {}});
            surfaces.push_back(mesh.surface);
        }
        options.surfaces = surfaces;
        try {
            return bakeVoxelField(views, options);
        } catch (const std::bad_alloc&) {
            return noMemory("there is not enough memory to bake a mesh; lower its resolution");
        }
    }
};

FieldBake::FieldBake(std::vector<BakedMesh> meshes, const VoxelFieldOptions& options, const Jobs& jobs)
    : state_(std::make_unique<State>()) {
    state_->meshes = std::move(meshes);
    state_->options = options;
    state_->run = std::make_unique<Background<VoxelField>>([state = state_.get()] { return state->bake(); }, jobs);
}

FieldBake::~FieldBake() = default;

bool FieldBake::done() const { return state_->run->done(); }

Result<VoxelField> FieldBake::take() { return state_->run->take(); }

}  // namespace rivulet
