// A minute on a user's GPU: whether it computes the same water as the cpu, then how long steps and pictures take, beside the cost model's
// prediction. And the page of that model.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <json/json.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "demos/rivulet/bench_cases.h"
#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "engine/app/context_egl.h"
#include "engine/compute/device_cl.h"
#include "engine/core/timeline.h"
#include "engine/gpu/current_context.h"
#include "engine/gpu/device_gl.h"
#include "fluid/render/backend.h"
#include "fluid/validate/gpu_check.h"
#include "fluid/validate/gpu_page.h"
#include "fluid/validate/gpu_series.h"

namespace rivulet {

namespace {

constexpr std::array<const char*, 3> kGpuMethods = {"pbf", "dfsph", "wcsph"};
constexpr std::array<int, 4> kSides = {37, 53, 68, 79};             // 101,306; 297,754; 628,864; 986,078 particles
constexpr std::array<int, 5> kSoftwareSides = {8, 11, 16, 24, 37};  // 1,024; 2,662; 8,192; 27,648; 101,306
constexpr double kStepSeconds = 0.4;                                // of steps of one size, at least one
// Shares of the time that the command may take: after the first no comparison is begun, after the second no size. Sizes of one method on
// one device are not begun if they would take longer than theirs of kSeriesShare, judged by the one before.
constexpr double kChecksUntil = 0.45, kSeriesUntil = 0.9, kSeriesShare = 0.4;

Json::Value jsonOf(const std::map<std::string, double>& values) {
    Json::Value v(Json::objectValue);
    for (const auto& [name, value] : values) v[name] = value;
    return v;
}

Json::Value jsonOf(const SeriesRow& row) {
    Json::Value v(Json::objectValue);
    v["device"] = row.device;
    v["method"] = row.method;
    v["particles"] = row.particles;
    v["stepMs"] = row.stepMs;
    v["iterations"] = row.iterations;
    v["warmSteps"] = row.warmSteps;
    v["passes"] = jsonOf(row.passes);
    if (row.predictedStepMs > 0) {
        v["predictedStepMs"] = row.predictedStepMs;
        v["frameMs"] = row.frameMs;
        v["predictedFrameMs"] = row.predictedFrameMs;
        v["predictedPasses"] = jsonOf(row.predictedPasses);
    }
    if (row.drawMs == 0) return v;
    v["drawMs"] = row.drawMs;
    v["drawPasses"] = jsonOf(row.drawPasses);
    if (row.predictedDrawMs > 0) {
        v["predictedDrawMs"] = row.predictedDrawMs;
        v["predictedDrawPasses"] = jsonOf(row.predictedDrawPasses);
    }
    return v;
}

Json::Value jsonOf(const ExaminedGpu& e) {
    Json::Value v(Json::objectValue);
    v["backend"] = backendName(e.device->backend());
    v["name"] = e.name;
    v["driver"] = e.device->info().driver;
    v["software"] = e.device->info().software;
    if (!e.from.empty()) v["predictedFrom"] = e.from;
    if (!e.measured) return v;
    Json::Value& r = v["rates"];
    r["bytesPerSecond"] = e.rates.bandwidth;
    r["copiedBytes"] = static_cast<Json::UInt64>(e.rates.copied);
    r["arithmetic"] = e.rates.arithmetic;
    r["integer"] = e.rates.integer;
    r["special"] = e.rates.special;
    r["loads"] = e.rates.loads;
    r["rounds"] = e.rates.rounds;
    r["dispatchMs"] = e.rates.dispatchMs;
    r["fragments"] = e.rates.fragments;
    r["filteredReads"] = e.rates.filtered;
    r["texelFetches"] = e.rates.fetches;
    return v;
}

Json::Value jsonOf(const GpuFinding& f) {
    Json::Value v(Json::objectValue);
    v["device"] = f.device;
    v["what"] = f.what;
    v["pass"] = f.passed();
    if (!f.error.empty()) {
        v["error"] = f.error;
        return v;
    }
    v["unit"] = f.unit;
    v["difference"] = std::isfinite(f.difference) ? Json::Value(f.difference) : Json::Value();  // null: not a number, or without bound
    v["limit"] = f.limit;
    return v;
}

std::string sentenceOf(const SeriesRow& row) {
    const auto beside = [](double ms) { return ms > 0 ? fmt::format(" (predicted: {:.3g})", ms) : std::string(); };
    std::string text =
        fmt::format("{} particles take {:.3g} ms a substep with {}{}", row.particles, row.stepMs, row.method, beside(row.predictedStepMs));
    if (row.drawMs > 0)
        text += fmt::format(" and {:.3g} ms to draw at {}x{}{}", row.drawMs, kSeriesWidth, kSeriesHeight, beside(row.predictedDrawMs));
    return text;
}

// Why a device is absent, without the remedy of verbs that have an option --backend.
std::string reasonIn(std::string message) {
    for (const std::string_view remedy : {" or use --backend cpu", "; use --backend cpu"})
        if (message.ends_with(remedy)) message.resize(message.size() - remedy.size());
    return message;
}

// The devices gl and cl of this machine, and the context of the first.
struct GpuDevices {
    struct Absent {
        const char* backend;
        std::string why;
    };
    Result<ContextEgl> egl = ContextEgl::create();
    GlFacts gl = egl ? currentGlFacts() : noGl(egl.error().message);
    std::vector<std::unique_ptr<Device>> list;
    std::vector<Absent> absent;

    // `one`: the first of them alone. `log` receives which device is absent, and why.
    GpuDevices(const Log& log, bool one) {
        const ShaderFiles files = ShaderFiles::developer();
        if (gl.present())
            list.push_back(makeGlDevice(files, log));
        else
            absent.push_back({"gl", reasonIn(gl.absent)});
        if (!one || list.empty()) {
            Result<std::unique_ptr<Device>> cl = makeClDevice(files, log, {.gl = gl.present() ? gpu::currentContext() : GlContext{}});
            if (cl)
                list.push_back(std::move(*cl));
            else
                absent.push_back({"cl", reasonIn(cl.error().message)});
        }
        for (const auto& [backend, why] : absent) log.notice(fmt::format("{}: not measured: {}", backend, why));
    }
    std::string nameOf(const Device& device) const { return device.backend() == Backend::gl ? gl.renderer : device.info().name; }
};

bool isLost(const Device& device) { return device.health().state == DeviceHealth::lost; }

// What is left out for lack of time or memory, to be named in one sentence.
using LeftOut = std::vector<std::string>;

// What the devices compute otherwise than the cpu, and what they fail to do; in the JSON at once.
class Findings {
  public:
    explicit Findings(Json::Value& checks) : checks_(checks) { checks_ = Json::Value(Json::arrayValue); }
    void add(const GpuFinding& f) {
        checks_.append(jsonOf(f));
        OfDevice& of = of_[f.device];
        (f.passed() ? of.agrees : f.error.empty() ? of.differs : of.fails) = true;
        if (f.passed()) return;
        const auto append = [](std::string& to, const std::string& text) { to += (to.empty() ? "" : "; ") + text; };
        append(f.error.empty() ? differences_ : failures_, f.sentence());
        if (!f.error.empty()) append(failed_, fmt::format("{}: {}", f.device, f.what));
    }
    void fail(const Device& device, const std::string& what, const Error& error) {
        add({.device = backendName(device.backend()), .what = what, .unit = {}, .error = error.message});
    }
    bool correct() const { return differences_.empty() && failures_.empty(); }
    // Continues a sentence after the name of a device of backend `device`.
    const char* verdict(const std::string& device, const LeftOut& out) const {
        const auto found = of_.find(device);
        const OfDevice of = found != of_.end() ? found->second : OfDevice();
        if (of.differs) return "does not compute the same water as the cpu";
        if (!of.agrees) return "could not be compared with the cpu";
        if (of.fails) return "computes the same water as the cpu where it could be compared";
        const bool all = std::ranges::none_of(out, [&](const std::string& what) { return what.starts_with(device + ": comparison"); });
        return all ? "computes the same water as the cpu" : "computes the same water as the cpu, as far as there was time to compare";
    }
    const std::string& failed() const { return failed_; }  // "cl: pbf; cl: rates"
    // Error (failed): something differs, or a device failed.
    Status status() const {
        if (correct()) return ok();
        std::string why = differences_.empty() ? "" : "the water differs from the cpu's: " + differences_;
        if (!failures_.empty()) why += fmt::format("{}a device failed: {}", why.empty() ? "" : "; ", failures_);
        return rivulet::failed(why);
    }

  private:
    struct OfDevice {
        bool agrees = false, differs = false, fails = false;
    };
    Json::Value& checks_;
    std::map<std::string, OfDevice> of_;
    std::string differences_, failures_, failed_;
};

// All devices are compared, also after one has failed.
Status compare(const BenchContext& context, const GpuDevices& devices, const SceneFile& scene, double until, Progress& progress,
               Findings& findings, LeftOut& out) {
    const std::unique_ptr<Device> cpu = makeCpu();
    for (const std::unique_ptr<Device>& device : devices.list) {
        progress.show(0.05, fmt::format("{}: comparing with the cpu", backendName(device->backend())));
        for (const GpuFinding& found : checkDevice(*device, *cpu, until, out)) findings.add(found);
        if (Status saved = context.save(); !saved) return saved;
    }
    if (!devices.gl.present()) return ok();
    Device& gl = *devices.list.front();
    if (hostSeconds() > until || isLost(gl)) {
        out.emplace_back("gl: comparison of a picture");
        return ok();
    }
    const auto picture = [&]() -> Result<GpuFinding> {
        Result<std::unique_ptr<FluidWorld>> world = FluidWorld::create(gl, seriesWater(scene, "pbf", kSoftwareSides[0]), {}, {});
        if (!world) return world.error();
        (*world)->step({}, 1.0e-3);
        return checkPicture(**world);
    };
    if (const Result<GpuFinding> found = picture(); found)
        findings.add(*found);
    else
        findings.fail(gl, "picture", found.error());
    return ok();
}

// The row of the first method with most particles, of the first device that has one.
struct Largest {
    const ExaminedGpu* gpu = nullptr;
    SeriesRow row;
};

void reportRow(const BenchContext& context, const SeriesRow& row) {
    const auto report = [&](const std::string& what, const char* unit, double ms, double predicted) {
        BenchRow line{
            .name = fmt::format("gpu, {}: {}, {}", row.device, what, row.particles), .unit = unit, .value = spreadOf({ms}), .passes = {}};
        if (predicted > 0) line.passes["predicted"] = predicted;
        context.report(line);
    };
    report(row.method, "ms/step", row.stepMs, row.predictedStepMs);
    if (row.drawMs > 0) report("drawn", "ms", row.drawMs, row.predictedDrawMs);
}

// Steps all methods on all devices, and draws the first method. Each row is saved at once.
Result<Largest> runSeries(const BenchContext& context, const std::vector<ExaminedGpu>& gpus, const SceneFile& scene,
                          SceneRenderer* renderer, double until, Progress& progress, Json::Value& series, Findings& findings,
                          LeftOut& out) {
    Largest largest;
    const double begun = hostSeconds(), share = kSeriesShare * context.seconds / static_cast<double>(gpus.size() * kGpuMethods.size());
    for (const ExaminedGpu& gpu : gpus)
        for (const char* method : kGpuMethods) {
            SceneRenderer* draws = gpu.device->backend() == Backend::gl && method == kGpuMethods[0] ? renderer : nullptr;
            const std::span<const int> sides =
                gpu.device->info().software ? std::span<const int>(kSoftwareSides) : std::span<const int>(kSides);
            const char* device = backendName(gpu.device->backend());
            const double from = hostSeconds();
            double last = 0;  // s
            int before = 0;
            const auto leaveOut = [&](int side, const char* lack) {
                out.push_back(fmt::format("{}: {} with {} particles{}{}", device, method, seriesParticles(side),
                                          side < sides.back() ? " and more" : "", lack));
            };
            for (const int side : context.quick ? sides.first(1) : sides) {
                const double at = hostSeconds(), expected = before > 0 ? last * seriesParticles(side) / seriesParticles(before) : 0;
                if (isLost(*gpu.device) || at > until || at - from + expected > share) {
                    leaveOut(side, isLost(*gpu.device) ? " (the device is lost)" : "");
                    break;
                }
                progress.show(0.25 + 0.75 * std::min((at - begun) / (until - begun), 1.0),
                              fmt::format("{}, {}, {} particles", device, method, seriesParticles(side)));
                Result<SeriesRow> row = measureSeries(gpu, scene, method, side, context.quick ? 0 : kStepSeconds, draws, until);
                if (!row) {
                    gpu.device->forgiveFull();
                    if (row.error().memory)  // as many as memory allows
                        leaveOut(side, " (memory)");
                    else
                        findings.fail(*gpu.device, fmt::format("{} with {} particles", method, seriesParticles(side)), row.error());
                    break;
                }
                last = hostSeconds() - at;
                before = side;
                series.append(jsonOf(*row));
                if (draws != nullptr && row->drawMs == 0) {
                    const std::string picture = fmt::format("a picture of {} particles", row->particles);
                    const bool memory = row->notDrawn && row->notDrawn->memory;
                    if (row->notDrawn && !memory)
                        findings.fail(*gpu.device, picture, *row->notDrawn);
                    else
                        out.push_back(fmt::format("{}: {}{}", device, picture, memory ? " (memory)" : ""));
                    draws = row->notDrawn ? nullptr : draws;
                    gpu.device->forgiveFull();
                }
                reportRow(context, *row);
                if (Status saved = context.save(); !saved) return saved.error();
                if (method == kGpuMethods[0] && (largest.gpu == nullptr || largest.gpu == &gpu)) largest = {&gpu, std::move(*row)};
            }
        }
    return largest;
}

Result<std::unique_ptr<SceneRenderer>> rendererOf(const GpuDevices& devices) {
    if (!devices.gl.present()) return std::unique_ptr<SceneRenderer>();
    return SceneRenderer::create(ShaderFiles::developer());
}

// The rates of all devices. A device keeps its row of the JSON, which then holds them too.
Result<std::vector<ExaminedGpu>> examineAll(const BenchContext& context, const GpuDevices& devices, double until, Progress& progress,
                                            Json::Value& rows, Findings& findings, LeftOut& out) {
    std::vector<ExaminedGpu> gpus;
    for (const std::unique_ptr<Device>& device : devices.list) {
        const std::string name = devices.nameOf(*device), what = fmt::format("{}: rates", backendName(device->backend()));
        progress.show(0.2, what);
        Result<ExaminedGpu> gpu = isLost(*device) ? Result<ExaminedGpu>(namedGpu(*device, name)) : examineGpu(*device, name, until);
        if (gpu && !gpu->measured) out.push_back(what + (isLost(*device) ? " (the device is lost)" : ""));
        if (!gpu && gpu.error().memory) out.push_back(what + " (memory)");
        if (!gpu && !gpu.error().memory) findings.fail(*device, "rates", gpu.error());
        gpus.push_back(gpu ? std::move(*gpu) : namedGpu(*device, name));
        rows[static_cast<Json::ArrayIndex>(gpus.size() - 1)] = jsonOf(gpus.back());
        if (Status saved = context.save(); !saved) return saved.error();
    }
    return gpus;
}

// Without OpenGL and OpenCL. An error if the person named this case; in a run of all cases a notice, and the other cases follow.
Status withoutDevices(const BenchContext& context, const GpuDevices& devices, Json::Value& result) {
    std::vector<std::string> why;
    for (const GpuDevices::Absent& absent : devices.absent) why.push_back(fmt::format("{}: {}", absent.backend, absent.why));
    result["sentence"] = fmt::format("Nothing was measured: {}.", fmt::join(why, "; "));
    result["complete"] = true;
    const std::string sentence = "the case gpu needs OpenGL or OpenCL, and this machine has neither: ";
    if (context.named) return failed(sentence + "install a driver for one of them");
    context.log.notice(sentence + "it is skipped");
    return ok();
}

}  // namespace

Status benchGpu(const BenchContext& context) {
    const double start = hostSeconds(), seriesUntil = start + kSeriesUntil * context.seconds;
    Result<SceneFile> scene = loadScene("dam_break.json", {});
    if (!scene) return scene.error();
    Json::Value unused, &result = (context.json != nullptr ? *context.json : unused)["gpu"];
    Progress progress("gpu");
    LeftOut out;

    // What is known is saved at once, the names of devices and drivers first: a person may send it after Ctrl-C, or when a driver ended the
    // program.
    const GpuDevices devices(context.log, context.quick);
    result["complete"] = false;
    result["devices"] = result["notMeasured"] = Json::Value(Json::arrayValue);
    for (const std::unique_ptr<Device>& device : devices.list)
        result["devices"].append(jsonOf(ExaminedGpu{.device = device.get(), .name = devices.nameOf(*device)}));
    for (const auto& [backend, why] : devices.absent) {
        Json::Value& row = result["notMeasured"].append(Json::Value(Json::objectValue));
        row["backend"] = backend;
        row["reason"] = why;
    }
    if (devices.list.empty()) return withoutDevices(context, devices, result);
    if (Status saved = context.save(); !saved) return saved;

    // Correctness first: the speed of wrong water is of no use.
    Findings findings(result["checks"]);
    if (Status compared = compare(context, devices, *scene, start + kChecksUntil * context.seconds, progress, findings, out); !compared)
        return compared;
    result["correct"] = findings.correct();
    std::map<Backend, std::string> verdicts;
    for (const std::unique_ptr<Device>& device : devices.list)
        verdicts[device->backend()] = fmt::format("{} ({}) {}", devices.nameOf(*device), backendName(device->backend()),
                                                  findings.verdict(backendName(device->backend()), out));
    if (Status saved = context.save(); !saved) return saved;

    const Result<std::vector<ExaminedGpu>> gpus = examineAll(context, devices, seriesUntil, progress, result["devices"], findings, out);
    if (!gpus) return gpus.error();
    Result<std::unique_ptr<SceneRenderer>> renderer = std::unique_ptr<SceneRenderer>();
    if (hostSeconds() < seriesUntil) renderer = rendererOf(devices);
    if (!renderer) findings.fail(*devices.list.front(), "pictures", renderer.error());
    result["series"] = Json::Value(Json::arrayValue);
    const Result<Largest> largest =
        runSeries(context, *gpus, *scene, renderer ? renderer->get() : nullptr, seriesUntil, progress, result["series"], findings, out);
    if (!largest) return largest.error();
    const ExaminedGpu& named = largest->gpu != nullptr ? *largest->gpu : gpus->front();
    std::string sentence = verdicts[named.device->backend()] + "; ";
    sentence += largest->gpu == nullptr ? "no size was measured." : sentenceOf(largest->row);
    if (largest->gpu != nullptr) sentence += named.from.empty() ? "." : fmt::format(" (from {}).", named.from);
    for (const auto& [backend, verdict] : verdicts)
        if (backend != named.device->backend()) sentence += fmt::format(" {}.", verdict);
    if (!findings.failed().empty()) sentence += fmt::format(" Failed: {}.", findings.failed());
    result["leftOut"] = Json::Value(Json::arrayValue);
    for (const std::string& what : out) result["leftOut"].append(what);
    if (!out.empty()) sentence += fmt::format(" Left out after {:.0f} s: {}.", hostSeconds() - start, fmt::join(out, "; "));
    result["correct"] = findings.correct();  // what failed since, too
    result["sentence"] = sentence;
    result["seconds"] = hostSeconds() - start;
    result["complete"] = true;
    fmt::print("{}\n", sentence);
    flushOutput();
    return findings.status();
}

Status benchGpuModel(const BenchContext& context) {
    if (context.quick) {
        if (context.out.empty()) return badInput("bench gpu_model --quick measures nothing, and writes no page without --out");
        const Graceful whole;
        return writeGpuPage({}, context.out, "rivulet bench gpu_model --out " + context.out);
    }
    const GpuDevices devices(context.log, false);
    Result<SceneFile> scene = loadScene("dam_break.json", {});
    if (!scene) return scene.error();
    const Result<std::unique_ptr<SceneRenderer>> renderer = rendererOf(devices);
    if (!renderer) return renderer.error();
    GpuModelRun run;
    for (const std::unique_ptr<Device>& device : devices.list) {
        if (!device->info().software) {  // its model is by published figures
            context.log.notice(fmt::format("{}: left out: {} is a GPU, which `rivulet bench gpu` compares with the model",
                                           backendName(device->backend()), devices.nameOf(*device)));
            continue;
        }
        Result<ExaminedGpu> gpu = examineGpu(*device, devices.nameOf(*device));
        if (!gpu) return gpu.error();
        for (const char* method : kGpuMethods) {
            SceneRenderer* draws = method == kGpuMethods[0] && device->backend() == Backend::gl ? renderer->get() : nullptr;
            Result<SeriesRow> row = measureSeries(*gpu, *scene, method, 16, 1, draws);
            if (!row) return row.error();
            context.report({.name = fmt::format("gpu_model, {}: {}, {}", row->device, method, row->particles),
                            .unit = "ms/step",
                            .value = spreadOf({row->stepMs}),
                            .passes = {{"predicted", row->predictedStepMs}}});
            run.rows.push_back(std::move(*row));
        }
        run.gpus.push_back(std::move(*gpu));
    }
    if (run.gpus.empty()) {
        const std::string sentence =
            "the case gpu_model needs OpenGL or OpenCL in software (Mesa's llvmpipe, PoCL), and this machine has neither";
        if (context.named) return failed(sentence + ": install one of them");
        context.log.notice(sentence + ": it is skipped");
        return ok();
    }
    if (context.out.empty()) return ok();
    const Graceful whole;  // Ctrl-C waits for the files
    return writeGpuPage(run, context.out, "rivulet bench gpu_model --out " + context.out);
}

}  // namespace rivulet
