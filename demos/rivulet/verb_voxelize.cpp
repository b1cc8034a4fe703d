#include <fmt/format.h>
#include <json/json.h>

#include <chrono>
#include <filesystem>

#include "demos/rivulet/asked_device.h"
#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "demos/rivulet/outputs.h"
#include "engine/app/capture.h"
#include "engine/core/file.h"
#include "engine/core/input_file.h"
#include "engine/core/json_text.h"
#include "engine/core/message_line.h"
#include "engine/core/readable_bytes.h"
#include "engine/scene/import_model.h"
#include "fluid/render/backend.h"
#include "fluid/session/cpu_fallback.h"
#include "fluid/voxel/distance_band.h"
#include "fluid/voxel/mesh_check.h"
#include "fluid/voxel/voxel_field.h"
#include "fluid/voxel/voxel_file.h"
#include "fluid/voxel/voxel_picture.h"
#include "fluid/voxel/voxelize.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

struct VoxelizeRequest {
    std::string mesh, out, mode = "solid", backend, device, stats, slices, picture;
    std::optional<int> resolution;
    bool thesisOrder = false, labels = false, band = false;
};

Status checkEnding(const char* option, const std::string& path, const char* ending) {
    if (path.empty() || fs::path(path).extension() == ending) return ok();
    return badInput(fmt::format("{} must be a file name that ends in {}, but is '{}'", option, ending, path));
}

// Refuses invalid combinations and files that cannot be written, before the work starts.
Status checkRequest(VoxelizeRequest& request) {
    if (Status known = checkWord("mode", request.mode, voxelModes().names()); !known) return known;
    if (Status sense = settleBackend(request.backend, "auto", request.device); !sense) return sense;
    if (request.thesisOrder && request.mode != "depth")
        return badInput("--thesis-order applies to --mode depth only; add --mode depth, or leave it out");
    if (request.out.empty()) request.out = fs::path(request.mesh).stem().string() + ".rvox";
    if (Status right = checkEnding("--out", request.out, ".rvox"); !right) return right;
    if (Status right = checkEnding("--slices", request.slices, ".png"); !right) return right;
    if (Status right = checkEnding("--picture", request.picture, ".png"); !right) return right;
    const NamedFile outputs[] = {
        {"--out", request.out}, {"--stats", request.stats}, {"--slices", request.slices}, {"--picture", request.picture}};
    const NamedFile inputs[] = {{"MESH", request.mesh}};
    if (Status apart = checkOutputs(outputs, inputs); !apart) return apart;
    std::error_code none;
    for (const NamedFile& file : outputs) {
        if (fs::is_directory(file.path, none)) return badInput(fmt::format("the output '{}' is a folder; choose a file name", file.path));
    }
    if (Status readable = checkInput(request.mesh); !readable) return readable;
    for (const NamedFile& file : outputs) {
        if (file.path.empty()) continue;
        if (Status writable = checkWritable(file.path); !writable) return writable;
    }
    return ok();
}

VoxelBand bandAround(const MeshView& mesh, const VoxelGrid& grid) {
    VoxelBand band;
    band.band = kBandVoxels * grid.voxel;
    const auto points = static_cast<size_t>(grid.size.x + 1) * static_cast<size_t>(grid.size.y + 1) * static_cast<size_t>(grid.size.z + 1);
    band.distance.assign(points, band.band);
    band.normal.assign(points, 0);
    DistanceBand(grid, band.band).bake(GridTriangles({&mesh, 1}, grid), {}, {}, {}, {}, {band.distance, band.normal, {}});
    return band;
}

Status writeStats(const VoxelizeRequest& request, const VoxelModel& model, size_t bytes) {
    Json::Value v(Json::objectValue);
    v["mesh"] = request.mesh;
    v["mode"] = request.mode;
    for (int k = 0; k < 3; ++k) v["resolution"].append(model.bits.size[k]);
    v["voxel"] = model.bits.voxel;
    v["surface"] = Json::UInt64(model.labels.surface);
    v["outside"] = Json::UInt64(model.labels.outside);
    v["materials"] = Json::Value(Json::arrayValue);
    for (size_t k = 0; k < model.labels.materials.size(); ++k) {
        Json::Value& m = v["materials"].append(Json::objectValue);
        m["id"] = Json::UInt64(k);
        m["voxels"] = Json::UInt64(model.labels.materials[k].voxels);
        m["volume"] = model.labels.materials[k].volume;
    }
    v["watertight"] = model.defects.watertight;
    v["badEdges"] = Json::UInt64(model.defects.badEdges());
    v["ms"] = model.milliseconds;
    v["bytes"] = Json::UInt64(bytes);
    return writeFileAtomic(request.stats, jsonText(v, 9));
}

constexpr int kColumn = 14;  // characters: "material 11" and a margin

void printMaterials(const std::vector<VoxelMaterial>& materials) {
    constexpr size_t kMost = 12;
    for (size_t k = 0; k < std::min(kMost, materials.size()); ++k) {
        const VoxelMaterial& m = materials[k];
        fmt::print("{:<{}}{} voxels, volume {:.6g}{}\n", fmt::format("material {}", k), kColumn, m.voxels, m.volume,
                   m.solid ? "" : ", a cavity");
    }
    if (materials.size() <= kMost) return;
    double volume = 0;
    size_t voxels = 0;
    for (size_t k = kMost; k < materials.size(); ++k) {
        voxels += materials[k].voxels;
        volume += materials[k].volume;
    }
    fmt::print("{:<{}}{} more materials: {} voxels, volume {:.6g}\n", "", kColumn, materials.size() - kMost, voxels, volume);
}

void printFigures(const VoxelizeRequest& request, const VoxelModel& model, const VoxelFile& file, size_t bytes, const Device& device,
                  double wholeMs) {
    const ivec3& size = model.bits.size;
    fmt::print("{}\n", printable(request.out));
    fmt::print("{:<{}}{} x {} x {}, mode {}\n", "voxels", kColumn, size.x, size.y, size.z, request.mode);
    fmt::print("{:<{}}{:.6g} of the mesh's units\n", "edge", kColumn, model.bits.voxel);
    fmt::print("{:<{}}{} voxels\n", "surface", kColumn, model.labels.surface);
    fmt::print("{:<{}}{} voxels\n", "outside", kColumn, model.labels.outside);
    printMaterials(model.labels.materials);
    std::string memory = fmt::format("bits {}, labels {}", readableBytes(static_cast<double>(model.bits.bits.size())),
                                     readableBytes(static_cast<double>(model.labels.bytes())));
    if (file.band)
        memory += fmt::format(", band {}", readableBytes(static_cast<double>(file.band->distance.size() * sizeof(float) +
                                                                             file.band->normal.size() * sizeof(uint32_t))));
    fmt::print("{:<{}}{}; the file {}\n", "memory", kColumn, memory, readableBytes(static_cast<double>(bytes)));
    fmt::print("{:<{}}{:.1f} ms to voxelise on {}, {:.0f} ms in all\n", "time", kColumn, model.milliseconds, backendName(device.backend()),
               wholeMs);
}

// Writes the output files one after the other; after Ctrl-C no further file is started. Returns the size of the voxel file, bytes.
Result<size_t> writeAll(const VoxelizeRequest& request, const VoxelModel& model, const VoxelFile& file, const VoxelPicture& slices,
                        const VoxelPicture& picture, const Graceful& graceful) {
    Result<size_t> bytes = writeVoxelFile(request.out, file);
    if (!bytes) return bytes;
    for (const auto& [path, image] : {std::pair(&request.slices, &slices), std::pair(&request.picture, &picture)}) {
        if (path->empty() || graceful.interrupted()) continue;
        if (Status written = writePng(*path, image->rgba, image->width, image->height); !written) return written.error();
    }
    if (request.stats.empty() || graceful.interrupted()) return bytes;
    if (Status written = writeStats(request, model, *bytes); !written) return written.error();
    return bytes;
}

int voxelizeAs(const VoxelizeRequest& request) {
    const auto start = std::chrono::steady_clock::now();
    const Log log = stderrLog();
    Result<Mesh> mesh = importMesh(request.mesh);
    if (!mesh) return report(mesh.error());
    const AskedDevice asked = askedDevice(request.backend, log, request.device);
    const std::unique_ptr<Device>& device = asked.device;

    // Until the first file is written, Ctrl-C exits at once: there is nothing to close.
    const MeshView view = mesh->view();
    std::optional<Progress> bar(std::in_place, "voxelising");
    VoxelizeOptions options;
    options.mode = voxelModes().find(request.mode)->mode;
    options.resolution = request.resolution.value_or(options.resolution);
    options.thesisOrder = request.thesisOrder;
    options.progress = [&bar](double share) {
        bar->show(share);
        return true;
    };
    Result<VoxelModel> model = voxelizeMesh(*device, {&view, 1}, options);
    bar.reset();
    if (!model) return report(model.error());
    if (Status sound = stillWorks(*device); !sound) return report(sound.error());
    for (const std::string& sentence : {model->defects.sentence(), lostFeatures({&view, 1}, model->bits)})
        if (!sentence.empty()) log.warning(sentence);

    VoxelFile file;
    file.mode = model->mode;
    file.bits = model->bits;
    if (request.labels) file.labels = model->labels;
    if (request.band) file.band = bandAround(view, model->bits);
    VoxelPicture slices, picture;
    if (!request.slices.empty())
        slices = file.band ? drawSlices(model->labels, file.band->distance, file.band->band) : drawSlices(model->labels);
    if (!request.picture.empty()) {
        bar.emplace("drawing");
        VoxelViewOptions look;
        look.progress = [&bar](double share) { bar->show(share); };
        picture = drawVoxels(model->labels, look);
        bar.reset();
    }

    const Graceful graceful;
    const Result<size_t> bytes = writeAll(request, *model, file, slices, picture, graceful);
    if (!bytes) return report(bytes.error());
    if (graceful.interrupted()) return graceful.status();
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    printFigures(request, *model, file, *bytes, *device, ms);
    return kDone;
}

}  // namespace

int voxelizeVerb(const Arguments& arguments) {
    ArgumentReader reader("voxelize", "Converts a mesh to voxels and writes them to a file; on request also statistics and images.");
    VoxelizeRequest request;
    std::string modes, modeList;
    for (const VoxelModeRow& row : voxelModes().rows) {
        modes += fmt::format("{}{}", modes.empty() ? "" : ", ", row.name);
        modeList += fmt::format("\n  {:<10}{}", row.name, row.doc);
    }
    reader.footer("Modes:" + modeList);
    reader.positional("MESH", "a mesh file: OBJ, glTF, PLY, STL or another format of assimp", request.mesh, true);
    reader.option("--resolution", "N", "voxels along the mesh's longest side; default: 128", request.resolution, kMinVoxelResolution,
                  kMaxVoxelResolution, false);  // the voxeliser refuses a larger N and reports the memory that it would need
    reader.option("--out", "FILE.rvox", "voxel file; default: the mesh's name with the ending .rvox, in the current folder", request.out);
    reader.option("--mode", "NAME", fmt::format("{}; default: solid", modes), request.mode);
    reader.option("--backend", "NAME", "backend: auto, cpu, gl or cl; all give the same voxels; default: auto", request.backend);
    reader.option("--device", "TEXT", "OpenCL device: part of its name, or its number in 'rivulet list devices'", request.device);
    reader.flag("--thesis-order", "with --mode depth: process the voxels in the order of the thesis; the result is the same",
                request.thesisOrder);
    reader.flag("--labels", "also store the material of each voxel", request.labels);
    reader.flag("--band", "also store exact distances and directions in a band around the surface", request.band);
    reader.option("--stats", "FILE.json", "also write statistics", request.stats);
    reader.option("--slices", "FILE.png", "also write an image of all slices", request.slices);
    reader.option("--picture", "FILE.png", "also write an image of the voxels, cut open", request.picture);
    if (std::optional<int> code = reader.read(arguments)) return *code;
    if (Status sense = checkRequest(request); !sense) return report(sense.error());
    return voxelizeAs(request);
}

}  // namespace rivulet
