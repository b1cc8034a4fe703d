// The benchmark of flow on a skin: all drops move on a deforming head; the step and the drawing into maps are measured.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <random>

#include "demos/rivulet/bench_cases.h"
#include "engine/compute/device_cpu.h"
#include "engine/core/wall_clock.h"
#include "engine/scene/import_model.h"
#include "fluid/flow/flow_maps.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/cpu_kernels.h"

namespace rivulet {

namespace {

// The largest connected part of a mesh, by number of triangles: of the head its skin, without eyes and lashes.
Mesh largestPart(Mesh mesh) {
    const Result<FlowMesh> whole = makeFlowMesh(mesh.view());
    if (!whole) return mesh;
    std::vector<bool> seen(whole->triangleCount(), false);
    std::vector<uint32_t> best;
    for (uint32_t start = 0; start < seen.size(); ++start) {
        if (seen[start]) continue;
        std::vector<uint32_t> part(1, start);
        seen[start] = true;
        for (size_t k = 0; k < part.size(); ++k)
            for (size_t edge = 0; edge < 3; ++edge) {
                const uint32_t across = whole->across[3 * size_t{part[k]} + edge];
                if (across == FlowMesh::kOpen || seen[across / 4]) continue;
                seen[across / 4] = true;
                part.push_back(across / 4);
            }
        if (part.size() > best.size()) best.swap(part);
    }
    std::vector<uint32_t> indices;
    for (const uint32_t t : best)
        for (size_t k = 0; k < 3; ++k) indices.push_back(mesh.indices[3 * size_t{whole->source[t]} + k]);
    mesh.indices.swap(indices);
    return mesh;
}

// Drops of 1 to 2 microlitres at random places on the head. They do not adhere and hardly merge, so that all of them keep moving.
Result<SurfaceFlow> runningHead(Device& device, const Mesh& head, int drops) {
    SurfaceFlowParams p;
    p.capacity = drops;
    p.hold = 0;
    p.touch = 0.1F;
    p.adhesion = 10;
    Result<FlowMesh> skin = makeFlowMesh(head.view());
    if (!skin) return skin.error();
    Result<SurfaceFlow> flow = SurfaceFlow::create(device, std::move(*skin), p);
    if (!flow) return flow.error();
    std::mt19937 random(1);
    std::uniform_int_distribution<uint32_t> triangle(0, static_cast<uint32_t>(flow->mesh().triangleCount()) - 1),
        picolitres(1000000, 2000000);
    for (int k = 0; k < drops; ++k) flow->add({triangle(random), 0.3F, 0.3F}, picolitres(random));
    return flow;
}

constexpr int kEdge = 1024;  // texels, width and height of the maps

struct FlowBytes {
    size_t flow, maps, coarse;  // coarse: maps of half the edge
};

// Reports the memory per triangle and per texel, and from these the memory of a head of kAim triangles, for which the aim is stated.
void reportMemory(const BenchContext& context, int drops, const FlowBytes& bytes, size_t triangles) {
    constexpr double kTexels = double{kEdge} * kEdge, kAim = 34000;
    const double texel = static_cast<double>(bytes.maps - bytes.coarse) / (0.75 * kTexels);
    const double triangle = (static_cast<double>(bytes.flow + bytes.maps) - texel * kTexels) / static_cast<double>(triangles);
    const auto row = [&](std::string what, const char* unit, double value) {
        context.report({.name = fmt::format("flow, memory of {}", what), .unit = unit, .value = spreadOf({value}), .passes = {}});
    };
    row(fmt::format("{} drops on {} triangles", drops, triangles), "MB", static_cast<double>(bytes.flow) / 1.0e6);
    row(fmt::format("{0} drops, {1} x {1} maps", drops, kEdge), "MB", static_cast<double>(bytes.flow + bytes.maps) / 1.0e6);
    row(fmt::format("{} drops and maps, per triangle", drops), "B", triangle);
    row(fmt::format("{} drops and maps, per texel", drops), "B", texel);
    row(fmt::format("{} drops and maps, for {} triangles", drops, kAim), "MB", (triangle * kAim + texel * kTexels) / 1.0e6);
}

}  // namespace

Status benchFlow(const BenchContext& context) {
    Result<std::string> path = findAsset("meshes/head/head.glb", "");
    if (!path) return path.error();
    Result<Mesh> whole = importMesh(*path);
    if (!whole) return whole.error();
    const Mesh head = largestPart(std::move(*whole));
    std::vector<std::vector<vec3>> poses(8, head.positions);
    for (size_t pose = 0; pose < poses.size(); ++pose)
        for (vec3& x : poses[pose]) x.y += 1.0e-3F * std::sin(40 * x.x + 0.785398F * static_cast<float>(pose));
    const std::vector<CpuKernelRow> rows = cpuKernels();
    for (const int drops : {512, 4096}) {
        auto device = makeCpuDevice(rows);
        Result<SurfaceFlow> flow = runningHead(*device, head, drops);
        if (!flow) return flow.error();
        const size_t before = device->bytesAllocated();
        size_t coarse = 0;
        {
            const Result<FlowMaps> half = FlowMaps::create(*flow, cornerUvs(flow->mesh(), head.view()), kEdge / 2);
            if (!half) return half.error();
            coarse = device->bytesAllocated() - before;
        }
        Result<FlowMaps> maps = FlowMaps::create(*flow, cornerUvs(flow->mesh(), head.view()), kEdge);
        if (!maps) return maps.error();
        constexpr int kFrames = 20;
        Status status = ok();
        double drawing = 0;
        BenchRow row{.name = fmt::format("flow, {} drops on a deforming head, cpu", drops), .unit = "ms/frame", .value = {}, .passes = {}};
        row.value = repeat(context, [&] {
            device->takeTimes();
            drawing = 0;
            const auto start = std::chrono::steady_clock::now();
            for (int k = 0; k < kFrames && status; ++k) {
                status = flow->step({.positions = poses[static_cast<size_t>(k) % poses.size()]}, 1.0 / 240);
                const auto stepped = std::chrono::steady_clock::now();
                maps->draw(*flow);
                drawing += msSince(stepped) / kFrames;
            }
            const double ms = msSince(start) / kFrames;
            row.passes.clear();
            for (const PassTime& t : device->takeTimes()) row.passes[t.name] = t.ms / kFrames;
            row.passes["drawing"] = drawing;
            return ms;
        });
        if (!status) return status;
        context.report(row);
        reportMemory(context, drops, {.flow = before, .maps = device->bytesAllocated() - before, .coarse = coarse},
                     flow->mesh().triangleCount());
    }
    return ok();
}

}  // namespace rivulet
