#include "fluid/voxel/field_bake.h"

#include <condition_variable>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "engine/core/exception_error.h"

namespace rivulet {

struct FieldBake::State {
    std::vector<BakedMesh> meshes;
    VoxelFieldOptions options;
    std::atomic<bool> stop = false;
    std::mutex mutex;
    std::condition_variable ended;
    std::optional<Result<VoxelField>> result;
    std::atomic<bool> done = false;
    std::thread own;  // where the jobs have no start

    void bake() {
        std::optional<Result<VoxelField>> made;
        try {
            const JobsScope scope(aloneUntil(&stop));
            std::vector<MeshView> views;
            std::vector<uint8_t> surfaces;
            views.reserve(meshes.size());
            surfaces.reserve(meshes.size());
            for (const BakedMesh& mesh : meshes) {
                views.push_back({.positions = mesh.positions, .indices = mesh.indices, .normals = {}, .uvs = {}});
                surfaces.push_back(mesh.surface);
            }
            options.surfaces = surfaces;
            made = bakeVoxelField(views, options);
        } catch (const LoopStopped&) {
            made = failed("the bake was cancelled");
        } catch (const std::bad_alloc&) {
            made = noMemory("there is not enough memory to bake a mesh; lower its resolution");
        } catch (...) {
            made = errorOf(std::current_exception());
        }
        const std::scoped_lock lock(mutex);
        result = std::move(made);
        done = true;
        ended.notify_all();
    }
    void wait() {
        if (own.joinable()) own.join();
        std::unique_lock lock(mutex);
        ended.wait(lock, [this] { return done.load(); });
    }
};

FieldBake::FieldBake(std::vector<BakedMesh> meshes, const VoxelFieldOptions& options, const Jobs& jobs)
    : state_(std::make_unique<State>()) {
    state_->meshes = std::move(meshes);
    state_->options = options;
    const auto function = [](void* state) { static_cast<State*>(state)->bake(); };
    if (jobs.start != nullptr)
        jobs.start(jobs.user, function, state_.get());
    else
        state_->own = std::thread(function, state_.get());
}

FieldBake::~FieldBake() {
    state_->stop = true;
    state_->wait();
}

bool FieldBake::done() const { return state_->done; }

Result<VoxelField> FieldBake::take() {
    state_->wait();
    return std::move(*state_->result);
}

}  // namespace rivulet
