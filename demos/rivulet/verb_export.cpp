#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "demos/rivulet/asked_device.h"
#include "demos/rivulet/cli.h"
#include "demos/rivulet/data_set.h"
#include "demos/rivulet/interrupt.h"
#include "demos/rivulet/outputs.h"
#include "demos/rivulet/run_options.h"
#include "engine/app/capture.h"
#include "engine/core/file.h"
#include "engine/core/message_line.h"
#include "fluid/io/export.h"
#include "fluid/io/marching_cubes.h"
#include "fluid/io/mesh_file.h"
#include "fluid/scene/scene_inputs.h"
#include "fluid/session/cpu_fallback.h"
#include "fluid/session/replay.h"
#include "fluid/session/run_stats.h"

namespace rivulet {

namespace {

constexpr int kMostEvery = 100'000;

struct ExportRequest {
    std::string scene, format, surface, up = "y", backend, device, out = "out", preset;
    std::vector<std::string> assignments;
    std::optional<int> every, cells;
    std::optional<double> seconds;
};

std::vector<std::string> formatNames() {
    std::vector<std::string> names = particleFormats().names();
    for (std::string& name : dataSetFormats().names()) names.push_back(std::move(name));
    return names;
}

// What is refused of a recording: it is not simulated again, and holds neither masses nor pressures.
Status checkRecording(const ExportRequest& request) {
    if (dataSetFormats().find(request.format) == nullptr)
        return badInput(fmt::format("a recording can be written as {}; for {} export the scene",
                                    fmt::join(dataSetFormats().names(), " or "), request.format.empty() ? "surfaces" : request.format));
    for (const auto& [name, used] : {std::pair("--surface", !request.surface.empty()), std::pair("--seconds", request.seconds.has_value()),
                                     std::pair("--cells", request.cells.has_value()), std::pair("--backend", !request.backend.empty()),
                                     std::pair("--device", !request.device.empty()), std::pair("--preset", !request.preset.empty()),
                                     std::pair("--set", !request.assignments.empty())})
        if (used) return badInput(fmt::format("{} is a recording, which is not simulated again; leave {} out", request.scene, name));
    return ok();
}

Status checkRequest(ExportRequest& request) {
    if (request.surface.empty() && request.format.empty())
        return badInput(
            fmt::format("nothing to write was selected; add --format {} for particles, --surface {} for the water's surface, or both",
                        fmt::join(formatNames(), ", "), fmt::join(meshFormats().names(), " or ")));
    if (!request.format.empty())
        if (Status known = checkWord("particle format", request.format, formatNames()); !known) return known;
    if (const DataSetFormat* format = dataSetFormats().find(request.format); format != nullptr) {
        if (format->create == nullptr) return failed(format->missing);
        if (request.up != "y") return badInput(fmt::format("{} keeps the axes of the simulation, +Y up; leave --up out", format->name));
    }
    if (isRecording(request.scene))
        if (Status fits = checkRecording(request); !fits) return fits;
    if (!request.surface.empty())
        if (Status known = checkWord("surface format", request.surface, meshFormats().names()); !known) return known;
    const std::vector<std::string> axes = {"y", "z"};
    if (Status known = checkWord("axis", request.up, axes); !known) return known;
    return settleBackend(request.backend, "auto", request.device);
}

std::string dataSetPath(const ExportRequest& request, const std::string& name) {
    return (std::filesystem::path(request.out) / fmt::format("{}.{}", name, dataSetFormats().find(request.format)->ending)).string();
}

// The attributes of a whole data set: the scene, and how its particles were made.
std::vector<DataAttribute> attributesOf(SceneFile scene, const std::string& version, const std::string& device) {
    SceneFile none;
    const VisitFn defaults = [&none](ParamVisitor& v) { none.visit(v); };
    std::vector<DataAttribute> all = {{"title", jsonText(scene.name)}};
    if (!scene.doc.empty()) all.push_back({"summary", jsonText(scene.doc)});
    all.push_back({"simulated_by", jsonText(fmt::format("Rivulet {} on {}", version, device))});
    all.push_back({"scene", jsonText(writeJson([&scene](ParamVisitor& v) { scene.visit(v); }, &defaults))});
    for (DataAttribute& parameter : parametersOf(scene)) all.push_back(std::move(parameter));
    return all;
}

void printDataSet(const std::string& path, const DataSetWriter& written) {
    fmt::print("{}, {} frames, {} particles on average\n", printable(path), written.frames(),
               written.particles() / std::max<size_t>(written.frames(), 1));
}

// Writes the files of each frame.
class Writer {
  public:
    Writer(const ExportRequest& request, const std::string& scene)
        : particles_(particleFormats().find(request.format)),
          dataSet_(dataSetFormats().find(request.format)),
          surfaces_(meshFormats().find(request.surface)),
          cells_(request.cells.value_or(2)),
          name_(fileNameOf(scene)),
          folder_(request.out) {
        frame_.up = request.up == "z" ? UpAxis::z : UpAxis::y;
    }

    // Creates the folder and checks that the files can be written and replace no file that is read, before the simulation starts.
    Status open(const SceneFile& scene) {
        std::vector<NamedFile> outputs, inputs;
        if (particles_ != nullptr)
            outputs.push_back({"--format", inFolder(fmt::format("{}_particles_*.{}", name_, particles_->ending)), true});
        if (particles_ != nullptr) outputs.push_back({"--format", inFolder(collection())});
        if (surfaces_ != nullptr) outputs.push_back({"--surface", inFolder(fmt::format("{}_*.{}", name_, surfaces_->name)), true});
        const std::string set = dataSet_ != nullptr ? inFolder(fmt::format("{}.{}", name_, dataSet_->ending)) : "";
        outputs.push_back({"--format", set});
        for (const SceneInput& input : inputsOf(scene)) inputs.push_back({input.name, input.path});
        if (Status apart = checkOutputs(outputs, inputs); !apart) return apart;
        if (Status made = makeFolder(folder_.string()); !made) return made;
        if (dataSet_ != nullptr) {
            Result<DataSetWriter> opened = DataSetWriter::open(*dataSet_, set);
            if (!opened) return opened.error();
            frames_ = std::move(*opened);
        }
        if (particles_ != nullptr)
            if (Status writable = checkWritable(inFolder(particleFile(0))); !writable) return writable;
        return surfaces_ != nullptr ? checkWritable(inFolder(surfaceFile(0))) : ok();
    }

    Status add(int f, const Session& session) {
        const FluidWorld& world = session.world();
        if (frames_) {
            frames_->expect(world.particles().count);  // with the room that emitters fill
            RecordedFrame frame = rivulet::frameOf(session);
            if (Status sound = stillWorks(world.device()); !sound) return sound;
            if (Status written = frames_->add(std::move(frame)); !written) return written;
            if (surfaces_ == nullptr) return ok();
        }
        const HostParticles host = readParticles(world, particles_ != nullptr);
        if (Status sound = stillWorks(world.device()); !sound) return sound;
        frame_.origin = world.origin();
        if (particles_ != nullptr)
            if (Status written = addParticles(f, host, world); !written) return written;
        return surfaces_ != nullptr ? addSurface(f, host, world.params().spacing) : ok();
    }

    // Writes the collection (.pvd) of the vtk files, also after an interrupted run. A data set is complete, or there is none.
    Status close(const Session& session, bool interrupted) {
        if (frames_ && frames_->frames() > 0 && !interrupted) {
            const Device& device = session.world().device();
            return frames_->close(
                attributesOf(session.scene(), RIVULET_VERSION, fmt::format("{}: {}", backendName(device.backend()), device.info().name)));
        }
        if (particles_ == nullptr || particles_->name != std::string_view("vtk") || files_.empty()) return ok();
        return writeFileAtomic(inFolder(collection()), writeVtkCollection(files_));
    }

    bool empty() const { return files_.empty() && meshes_ == 0 && (!frames_ || frames_->frames() == 0); }
    size_t framesWithoutParticles() const { return emptyFrames_; }
    void printSummary() const {
        const std::string at = (folder_ / name_).string();
        if (!files_.empty()) {
            const std::string list = particles_->name == std::string_view("vtk") ? fmt::format(" and {}", inFolder(collection())) : "";
            fmt::print("{} {} {}_particles_*.{}{}, {} particles on average\n", files_.size(), files_.size() == 1 ? "file" : "files",
                       printable(at), particles_->ending, printable(list), counted_ / files_.size());
        }
        if (frames_) printDataSet(inFolder(fmt::format("{}.{}", name_, dataSet_->ending)), *frames_);
        if (meshes_ > 0)
            fmt::print("{} {} {}_*.{}, {} triangles on average\n", meshes_, meshes_ == 1 ? "surface" : "surfaces", printable(at),
                       surfaces_->name, triangles_ / meshes_);
    }

  private:
    std::string particleFile(int f) const { return fmt::format("{}_particles_{:04}.{}", name_, f, particles_->ending); }
    std::string surfaceFile(int f) const { return fmt::format("{}_{:04}.{}", name_, f, surfaces_->name); }
    std::string collection() const { return name_ + "_particles.pvd"; }
    std::string inFolder(const std::string& file) const { return (folder_ / file).string(); }

    Status addParticles(int f, const HostParticles& host, const FluidWorld& world) {
        const ExportParticles of{.position = host.position,
                                 .velocity = host.velocity,
                                 .id = host.id,
                                 .mass = host.mass,
                                 .pressure = host.pressure,
                                 .volume = std::pow(double{world.params().spacing}, 3),
                                 .time = world.time()};
        if (Status written = writeFileAtomic(inFolder(particleFile(f)), particles_->write(of, frame_)); !written) return written;
        files_.push_back({of.time, particleFile(f)});
        counted_ += of.position.size();
        return ok();
    }

    Status addSurface(int f, const HostParticles& host, float spacing) {
        const Result<IsoSurface> surface = IsoSurface::create(host.position, spacing);
        if (!surface) return surface.error();
        if (surface->count() == 0) {
            ++emptyFrames_;
            return ok();
        }
        const Result<SurfaceMesh> mesh = marchingCubes(*surface, cells_);
        if (!mesh) return mesh.error();
        if (Status written = writeFileAtomic(inFolder(surfaceFile(f)), surfaces_->write(mesh->view(), frame_)); !written) return written;
        ++meshes_;
        triangles_ += mesh->view().triangleCount();
        return ok();
    }

    const ParticleFormat* particles_;  // null: none
    const DataSetFormat* dataSet_;     // null: none
    std::optional<DataSetWriter> frames_;
    const MeshFormat* surfaces_;  // null: none
    int cells_;
    std::string name_;
    std::filesystem::path folder_;
    ExportFrame frame_;
    std::vector<TimedFile> files_;  // of particles
    size_t counted_ = 0, meshes_ = 0, triangles_ = 0, emptyFrames_ = 0;
};

int exportAs(const ExportRequest& request, const SceneFile& scene) {
    const Log log = stderrLog();
    const Result<int> frames = framesOf(request.seconds.value_or(scene.duration), scene, request.seconds ? "--seconds" : "duration");
    if (!frames) return report(frames.error());
    Writer writer(request, scene.name);
    if (Status writable = writer.open(scene); !writable) return report(writable.error());
    AskedDevice asked = askedDevice(request.backend, log, request.device);
    std::optional<Progress> opening(std::in_place, scene.name);
    auto opened = openSession(scene, *asked.device, log, request.backend, opening->steps());
    opening.reset();
    if (!opened) return report(opened.error());
    if (opened->instead) asked.device = std::move(opened->instead);
    const std::unique_ptr<Session> session = std::move(opened->session);

    const Graceful graceful;
    asked.device->stopOn(graceful.flag());
    const int every = request.every.value_or(1);
    Progress progress(session->scene().name);
    for (int f = 0; f < *frames && !graceful.interrupted(); ++f) {
        session->step(frameSeconds(session->scene()), true);
        if (graceful.interrupted()) break;
        if (const Result<bool> moved = keepRunning(*session, asked.device, log); !moved) return report(moved.error());
        progress.show(static_cast<double>(f + 1) / *frames, fmt::format("{:.2f} s", session->world().time()));
        if (f % every != 0) continue;
        if (Status written = writer.add(f, *session); !written) return report(written.error());
    }
    if (Status closed = writer.close(*session, graceful.interrupted()); !closed) return report(closed.error());
    if (graceful.interrupted()) return graceful.status();
    if (writer.empty())
        return report(failed(fmt::format("{} has no particles in its first {:.3g} s, so nothing was written; use a larger --seconds",
                                         session->scene().name, session->world().time())));
    if (writer.framesWithoutParticles() > 0)
        log.notice(fmt::format("{} frames have no particles: no surface was written for them", writer.framesWithoutParticles()));
    writer.printSummary();
    return kDone;
}

int exportRecording(const ExportRequest& request) {
    const Log log = stderrLog();
    Result<RecordingReader> reader = RecordingReader::open(request.scene);
    if (!reader) return report(reader.error());
    const RecordedRun run = recordedRun(reader->about());
    std::vector<DataAttribute> attributes;
    if (run.scene.empty()) {
        log.notice(fmt::format("{} has no parameters, because the program that recorded it wrote none", request.scene));
    } else {
        SceneFile scene;
        if (Status read = readJson(run.scene, request.scene, [&scene](ParamVisitor& v) { scene.visit(v); }); !read)
            return report(read.error());
        attributes = attributesOf(scene, run.version, run.device);
    }
    attributes.push_back({"recording", jsonText(std::filesystem::path(request.scene).filename().string())});
    if (!reader->cut().empty()) {
        log.notice(reader->cut());
        attributes.push_back({"incomplete", jsonText("the recording has no end: its last frames are missing")});
    }
    const std::string path = dataSetPath(request, std::filesystem::path(request.scene).stem().string());
    const std::vector<NamedFile> outputs = {{"--format", path}}, inputs = {{"the recording", request.scene}};
    if (Status apart = checkOutputs(outputs, inputs); !apart) return report(apart.error());
    if (Status made = makeFolder(request.out); !made) return report(made.error());
    Result<DataSetWriter> writer = DataSetWriter::open(*dataSetFormats().find(request.format), path);
    if (!writer) return report(writer.error());
    writer->expect(reader->largest());
    const Graceful graceful;
    Progress progress(request.scene);
    for (size_t f = 0; f < reader->frames(); f += static_cast<size_t>(request.every.value_or(1))) {
        if (graceful.interrupted()) return graceful.status();
        Result<RecordedFrame> frame = reader->read(f);
        if (!frame) return report(frame.error());
        progress.show(static_cast<double>(f + 1) / static_cast<double>(reader->frames()), fmt::format("{:.2f} s", frame->time));
        if (Status added = writer->add(std::move(*frame)); !added) return report(added.error());
    }
    if (Status closed = writer->close(std::move(attributes)); !closed) return report(closed.error());
    printDataSet(path, *writer);
    return kDone;
}

}  // namespace

int exportVerb(const Arguments& arguments) {
    ArgumentReader reader(
        "export", "Runs a scene without drawing it and writes the particles, the water's surface as meshes, or both. Lengths are metres.");
    ExportRequest request;
    std::string formats = "Formats of --format:";
    for (const ParticleFormat& row : particleFormats().rows) formats += fmt::format("\n  {:<10}{}", row.name, row.doc);
    for (const DataSetFormat& row : dataSetFormats().rows) formats += fmt::format("\n  {:<10}{}", row.name, row.doc);
    formats += "\nFormats of --surface:";
    for (const MeshFormat& row : meshFormats().rows) formats += fmt::format("\n  {:<10}{}", row.name, row.doc);
    reader.footer(
        formats +
        "\n\nThe up axis is +Y, or +Z with --up z. Blender uses +Z: for PLY files use --up z, because its PLY importer does not "
        "convert;\nits OBJ importer converts +Y to +Z itself, so use --up y. ParaView does not convert; its first view has +Y up.\n"
        "PLY and OBJ have no units: 1 is one metre. Positions are world positions: fluid.origin is added to them, in double "
        "precision.");
    reader.positional("SCENE", "a scene file, the name of a scene in 'rivulet list scenes', or a recording (.rrec) for hdf5 or zarr",
                      request.scene, true);
    reader.option("--format", "FORMAT", fmt::format("write the particles as {}", fmt::join(formatNames(), ", ")), request.format);
    reader.option("--surface", "FORMAT", fmt::format("write the surface as {}", fmt::join(meshFormats().names(), " or ")), request.surface);
    reader.option("--up", "AXIS", "up axis: y, as simulated, or z, which writes (x, y, z) as (x, -z, y); default: y", request.up);
    reader.option("--every", "N", "write every N-th frame; 60 frames are one second of video; default: 1", request.every, 1, kMostEvery);
    reader.option("--seconds", "S", "simulated time, s; default: the scene's duration", request.seconds, 0,
                  static_cast<double>(kMostFrames) / kFramesPerSecond);
    reader.option("--cells", "N", "resolution of the mesh: cells per particle spacing; default: 2", request.cells, 1, kMaxCellsPerSpacing);
    reader.option("--out", "DIR", "output folder of NAME_particles_0000.vtp, NAME_0000.obj, ...; default: out", request.out);
    reader.option("--backend", "NAME", "backend of the simulation: auto, cpu, gl or cl; default: auto", request.backend);
    reader.option("--device", "TEXT", "OpenCL device: part of its name, or its number in 'rivulet list devices'", request.device);
    reader.option("--preset", "NAME", "a named set of values in the scene file, applied before --set", request.preset);
    reader.option("--set", "PATH=VALUE", "set a parameter, for example --set fluid.spacing=0.02; may be repeated", request.assignments);
    if (std::optional<int> code = reader.read(arguments)) return *code;
    if (Status sense = checkRequest(request); !sense) return report(sense.error());
    if (isRecording(request.scene)) return exportRecording(request);
    Result<SceneFile> scene = loadScene(request.scene, request.assignments, request.preset);
    if (!scene) return report(scene.error());
    return exportAs(request, *scene);
}

}  // namespace rivulet
