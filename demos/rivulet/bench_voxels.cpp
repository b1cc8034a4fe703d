// Benchmarks of voxels: voxelising meshes of 70,000 triangles, baking their distance fields, and the cost of collision with one.
#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "demos/rivulet/bench_cases.h"
#include "engine/compute/device_cpu.h"
#include "engine/core/wall_clock.h"
#include "engine/scene/import_model.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/voxel/voxel_field.h"
#include "fluid/voxel/voxelize.h"

namespace rivulet {

namespace {

// A closed ball with dents, of 70,688 triangles, about as many as the Stanford bunny has: for machines without the bunny.
Mesh dentedBall() {
    constexpr int kRings = 188;
    constexpr uint32_t kSides = 188;
    Mesh mesh;
    mesh.name = "dented ball";
    const auto at = [](double polar, double round) {
        const double r = 1 + 0.08 * std::sin(7 * polar) * std::cos(9 * round) + 0.03 * std::sin(31 * polar + 5 * round);
        return vec3(static_cast<float>(r * std::sin(polar) * std::cos(round)), static_cast<float>(r * std::cos(polar)),
                    static_cast<float>(r * std::sin(polar) * std::sin(round)));
    };
    mesh.positions.push_back(at(0, 0));
    for (int ring = 1; ring <= kRings; ++ring)
        for (uint32_t side = 0; side < kSides; ++side) mesh.positions.push_back(at(kPiD * ring / (kRings + 1), 2 * kPiD * side / kSides));
    mesh.positions.push_back(at(kPiD, 0));
    const auto last = static_cast<uint32_t>(mesh.positions.size()) - 1;
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) { mesh.indices.insert(mesh.indices.end(), {a, b, c}); };
    for (uint32_t side = 0; side < kSides; ++side) {
        const uint32_t next = (side + 1) % kSides;
        add(0, 1 + next, 1 + side);
        for (uint32_t ring = 0; ring + 1 < kRings; ++ring) {
            const uint32_t above = 1 + ring * kSides, below = above + kSides;
            add(above + side, above + next, below + next);
            add(above + side, below + next, below + side);
        }
        add(1 + (kRings - 1) * kSides + side, 1 + (kRings - 1) * kSides + next, last);
    }
    return mesh;
}

// The bunny, if a folder of RIVULET_ASSETS has it, and the ball.
std::vector<Mesh> benchMeshes(const Log& log) {
    std::vector<Mesh> meshes;
    Result<std::string> path = findAsset("bunny_zipper_open.obj", "");
    if (path) {
        Result<Mesh> bunny = importMesh(*path);
        if (bunny) {
            bunny->name = "bunny";
            meshes.push_back(std::move(*bunny));
        }
    }
    if (meshes.empty()) log.notice("no folder of RIVULET_ASSETS has bunny_zipper_open.obj: only the dented ball is measured");
    meshes.push_back(dentedBall());
    return meshes;
}

// Reports one row: the time of `once`, ms. The first error ends it.
Status reportTime(const BenchContext& context, const std::string& name, const std::function<Result<double>()>& once) {
    Status status = ok();
    const Spread spread = repeat(context, [&] {
        if (!status) return 0.0;
        Result<double> ms = once();
        if (ms) return *ms;
        status = ms.error();
        return 0.0;
    });
    if (status) context.report({.name = name, .unit = "ms", .value = spread, .passes = {}});
    return status;
}

}  // namespace

Status benchVoxels(const BenchContext& context) {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    auto device = makeCpuDevice(rows);
    struct Wanted {
        VoxelMode mode;
        const char* name;
        int resolution;
        bool thesisOrder = false;
    };
    for (const Mesh& mesh : benchMeshes(context.log)) {
        const MeshView view = mesh.view();
        for (const Wanted& w : {Wanted{VoxelMode::solid, "solid", 256}, Wanted{VoxelMode::surface, "surface", 256},
                                Wanted{VoxelMode::solid, "solid", 512}, Wanted{VoxelMode::surface, "surface", 512},
                                Wanted{VoxelMode::depth, "depth", 128}, Wanted{VoxelMode::depth, "depth, the thesis's order", 128, true}}) {
            const VoxelizeOptions options{.mode = w.mode, .resolution = w.resolution, .thesisOrder = w.thesisOrder, .progress = {}};
            const std::string name =
                fmt::format("{} {}^3, {}, {}k triangles, cpu", w.name, w.resolution, mesh.name, mesh.indices.size() / 3000);
            Status done = reportTime(context, name, [&]() -> Result<double> {
                Result<VoxelModel> model = voxelizeMesh(*device, std::span(&view, 1), options);
                if (!model) return model.error();
                return model->milliseconds;
            });
            if (!done) return done;
        }
        Status done = reportTime(context, fmt::format("field 256, {}, cpu", mesh.name), [&]() -> Result<double> {
            const auto start = std::chrono::steady_clock::now();
            Result<VoxelField> field = bakeVoxelField(std::span(&view, 1), {.resolution = 256});
            if (!field) return field.error();
            return msSince(start);
        });
        if (!done) return done;
    }
    return ok();
}

// A column of 16,384 particles falls onto Spot, voxels of a quarter of the spacing: the share of a step that collision takes.
Status benchCollide(const BenchContext& context) {
    Result<SceneFile> scene = loadScene("scenes/column_over_spot.json", {});
    if (!scene) return scene.error();
    scene->fluid.blocks = {{vec3(0.2F, 0.55F, 0.2F), vec3(0.6F, 0.75F, 0.6F), vec3(0.0F)}};
    scene->colliders[0].resolution = 0;
    const std::vector<CpuKernelRow> rows = cpuKernels();
    auto device = makeCpuDevice(rows);
    std::map<std::string, double> passes;
    double collide = 0;
    Status status = ok();
    const Spread spread = repeat(context, [&] {
        auto session = Session::create(*scene, *device, {});
        if (!session) {
            status = session.error();
            return 0.0;
        }
        device->finish();
        device->takeTimes();
        constexpr int kFrames = 36;  // the column falls, hits and runs off
        for (int frame = 0; frame < kFrames; ++frame) (*session)->step(1.0 / kFramesPerSecond, true);
        double all = 0;
        passes.clear();
        for (const PassTime& t : device->takeTimes()) {
            all += t.ms;
            passes[t.name] = t.ms / kFrames;
        }
        collide = passes["fluid/solids/collide"] * kFrames;
        return 100 * collide / all;
    });
    if (!status) return status;
    context.report(
        {.name = "collision's share of a step, 16,384 particles onto Spot, cpu", .unit = "%", .value = spread, .passes = passes});
    return ok();
}

}  // namespace rivulet
