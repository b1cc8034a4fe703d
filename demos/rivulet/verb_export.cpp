#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "demos/rivulet/asked_device.h"
#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "demos/rivulet/run_options.h"
#include "engine/app/capture.h"
#include "engine/core/json.h"
#include "fluid/bridge/run_stats.h"
#include "fluid/bridge/takeover.h"
#include "fluid/io/marching_cubes.h"
#include "fluid/io/mesh_file.h"

namespace rivulet {

namespace {

constexpr int kMostEvery = 100'000;

struct ExportRequest {
    std::string scene, surface, backend, device, out = "out", preset;
    std::vector<std::string> assignments;
    std::optional<int> every, cells;
    std::optional<double> seconds;
};

Status checkRequest(ExportRequest& request) {
    if (request.surface.empty()) return badInput(fmt::format("say what to write: --surface {}", fmt::join(meshFormats().names(), " or ")));
    if (Status known = checkWord("surface format", request.surface, meshFormats().names()); !known) return known;
    return settleBackend(request.backend, "auto", request.device);
}

int exportAs(const ExportRequest& request, const SceneFile& scene) {
    const Log log = stderrLog();
    const Result<int> frames = framesOf(request.seconds.value_or(scene.duration), scene, request.seconds ? "--seconds" : "duration");
    if (!frames) return report(frames.error());
    const MeshFormat& format = *meshFormats().find(request.surface);
    const std::filesystem::path folder = request.out;
    const std::string name = fileNameOf(scene.name);
    if (Status made = makeFolder(request.out); !made) return report(made.error());
    const std::string first = (folder / fmt::format("{}_0000.{}", name, format.name)).string();
    if (Status writable = checkWritable(first); !writable) return report(writable.error());
    AskedDevice asked = askedDevice(request.backend, log, request.device);
    auto opened = openSession(scene, *asked.device, log);
    if (!opened) return report(opened.error());
    if (opened->instead) asked.device = std::move(opened->instead);
    const std::unique_ptr<Session> session = std::move(opened->session);

    const Graceful graceful;
    const int every = request.every.value_or(1);
    size_t files = 0, triangles = 0;
    int dry = 0;
    Progress progress(session->scene().name);
    for (int f = 0; f < *frames && !graceful.interrupted(); ++f) {
        session->step(frameSeconds(session->scene()), true);
        if (const Result<bool> moved = keepRunning(*session, asked.device, log); !moved) return report(moved.error());
        progress.show(static_cast<double>(f + 1) / *frames, fmt::format("{:.2f} s", session->world().time()));
        if (f % every != 0) continue;
        const HostParticles particles = readParticles(session->world());
        const Result<IsoSurface> surface = IsoSurface::create(particles.position, session->world().params().spacing);
        if (!surface) return report(surface.error());
        if (surface->count() == 0) {
            ++dry;
            continue;
        }
        const Result<SurfaceMesh> mesh = marchingCubes(*surface, request.cells.value_or(2));
        if (!mesh) return report(mesh.error());
        const std::string path = (folder / fmt::format("{}_{:04}.{}", name, f, format.name)).string();
        if (Status written = writeFileAtomic(path, format.write(mesh->view())); !written) return report(written.error());
        ++files;
        triangles += mesh->view().triangleCount();
    }
    if (graceful.interrupted()) return kInterrupted;
    if (files == 0)
        return report(failed(fmt::format("{} has no particles within {:.3g} s, so there is no surface to write: ask for more --seconds",
                                         session->scene().name, session->world().time())));
    if (dry > 0) log.notice(fmt::format("{} frames without particles were left out", dry));
    fmt::print("{} {} {}_*.{}, {} triangles on average\n", files, files == 1 ? "surface" : "surfaces", (folder / name).string(),
               format.name, triangles / files);
    return kDone;
}

}  // namespace

int exportVerb(const Arguments& arguments) {
    ArgumentReader reader("export", "Runs a scene without pictures, and writes its water's surface as meshes: metres, +Y up.");
    ExportRequest request;
    std::string formats;
    for (const MeshFormat& row : meshFormats().rows) formats += fmt::format("\n  {:<10}{}", row.name, row.doc);
    reader.footer("Surfaces:" + formats);
    reader.positional("SCENE.json", "the scene", request.scene, true);
    reader.option("--surface", "FORMAT", fmt::format("{}", fmt::join(meshFormats().names(), " or ")), request.surface);
    reader.option("--every", "N", "a mesh every so many frames, 60 a second that is shown; default: 1", request.every, 1, kMostEvery);
    reader.option("--seconds", "S", "how long, simulated; default: the scene's duration", request.seconds, 0,
                  static_cast<double>(kMostFrames) / kFramesPerSecond);
    reader.option("--cells", "N", "cells along a particle spacing: how fine the mesh is; default: 2", request.cells, 1,
                  kMaxCellsPerSpacing);
    reader.option("--out", "DIR", "folder that the meshes go to: NAME_0000.obj, by frame; default: out", request.out);
    reader.option("--backend", "NAME", "what simulates: auto, cpu, gl or cl", request.backend);
    reader.option("--device", "TEXT", "which OpenCL device: a part of its name, or its number in 'list devices'", request.device);
    reader.option("--preset", "NAME", "one of the scene's sets of values, before any --set", request.preset);
    reader.option("--set", "PATH=VALUE", "change a parameter: --set fluid.spacing=0.02; as often as you like", request.assignments);
    if (std::optional<int> code = reader.read(arguments)) return *code;
    if (Status sense = checkRequest(request); !sense) return report(sense.error());
    Result<SceneFile> scene = loadScene(request.scene, request.assignments, request.preset);
    if (!scene) return report(scene.error());
    return exportAs(request, *scene);
}

}  // namespace rivulet
