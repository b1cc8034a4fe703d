// A minute on a user's GPU: whether it computes the same water as the cpu, then how long steps and pictures take, beside the cost model's
// prediction. And the page of that model.
#include <fmt/format.h>
#include <json/json.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "demos/rivulet/bench_cases.h"
#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "engine/app/context_egl.h"
#include "engine/core/timeline.h"
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
    v["predictedStepMs"] = row.predictedStepMs;
    v["iterations"] = row.iterations;
    v["warmSteps"] = row.warmSteps;
    v["frameMs"] = row.frameMs;
    v["predictedFrameMs"] = row.predictedFrameMs;
    v["passes"] = jsonOf(row.passes);
    v["predictedPasses"] = jsonOf(row.predictedPasses);
    if (row.drawMs == 0) return v;
    v["drawMs"] = row.drawMs;
    v["predictedDrawMs"] = row.predictedDrawMs;
    v["drawPasses"] = jsonOf(row.drawPasses);
    v["predictedDrawPasses"] = jsonOf(row.predictedDrawPasses);
    return v;
}

Json::Value jsonOf(const ExaminedGpu& e) {
    Json::Value v(Json::objectValue);
    v["backend"] = backendName(e.device->backend());
    v["name"] = e.name;
    v["driver"] = e.device->info().driver;
    v["software"] = e.device->info().software;
    if (e.from.empty()) return v;  // there was no time to measure its rates
    v["predictedFrom"] = e.from;
    Json::Value& r = v["rates"];
    r["bytesPerSecond"] = e.rates.bandwidth;
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
    v["unit"] = f.unit;
    v["difference"] = std::isfinite(f.difference) ? Json::Value(f.difference) : Json::Value();  // null: not a number, or without bound
    v["limit"] = f.limit;
    v["pass"] = f.passed();
    return v;
}

std::string sentenceOf(const SeriesRow& row) {
    std::string text = fmt::format("{} particles take {:.3g} ms a substep with {} (predicted: {:.3g})", row.particles, row.stepMs,
                                   row.method, row.predictedStepMs);
    if (row.drawMs > 0)
        text += fmt::format(" and {:.3g} ms to draw at {}x{} (predicted: {:.3g})", row.drawMs, kSeriesWidth, kSeriesHeight,
                            row.predictedDrawMs);
    return text;
}

// The devices gl and cl of this machine, and the context of the first.
struct GpuDevices {
    Result<ContextEgl> egl = ContextEgl::create();
    GlFacts gl = egl ? currentGlFacts() : noGl(egl.error().message);
    std::vector<std::unique_ptr<Device>> list;

    // `one`: the first of them alone.
    GpuDevices(const Log& log, bool one) {
        for (const char* name : {"gl", "cl"}) {
            std::unique_ptr<Device> device = makeDevice(name, gl, log);
            if (std::string_view(backendName(device->backend())) == name) list.push_back(std::move(device));
            if (one && !list.empty()) return;
        }
    }
    std::string nameOf(const Device& device) const { return device.backend() == Backend::gl ? gl.renderer : device.info().name; }
};

// What is left out for lack of time or memory, to be named in one sentence.
using LeftOut = std::vector<std::string>;

Result<std::vector<GpuFinding>> compare(const GpuDevices& devices, const SceneFile& scene, double until, Progress& progress, LeftOut& out) {
    const std::unique_ptr<Device> cpu = makeCpu();
    std::vector<GpuFinding> findings;
    for (const std::unique_ptr<Device>& device : devices.list) {
        progress.show(0.05, fmt::format("{}: comparing with the cpu", backendName(device->backend())));
        Result<std::vector<GpuFinding>> found = checkDevice(*device, *cpu, until, out);
        if (!found) return found.error();
        findings.insert(findings.end(), found->begin(), found->end());
    }
    if (!devices.gl.present()) return findings;
    if (hostSeconds() > until) {
        out.emplace_back("gl: comparison of a picture");
        return findings;
    }
    Result<std::unique_ptr<FluidWorld>> world =
        FluidWorld::create(*devices.list.front(), seriesWater(scene, "pbf", kSoftwareSides[0]), {}, {});
    if (!world) return world.error();
    (*world)->step({}, 1.0e-3);
    Result<GpuFinding> picture = checkPicture(**world);
    if (!picture) return picture.error();
    findings.push_back(std::move(*picture));
    return findings;
}

// Steps all methods on all devices, and draws the first method. Each row is saved at once. Returns the row of the first device and method
// with most particles.
Result<std::optional<SeriesRow>> runSeries(const BenchContext& context, const std::vector<ExaminedGpu>& gpus, const SceneFile& scene,
                                           SceneRenderer* renderer, double until, Progress& progress, Json::Value& series, LeftOut& out) {
    std::optional<SeriesRow> largest;
    const double begun = hostSeconds(), share = kSeriesShare * context.seconds / static_cast<double>(gpus.size() * kGpuMethods.size());
    for (const ExaminedGpu& gpu : gpus)
        for (const char* method : kGpuMethods) {
            SceneRenderer* draws = method == kGpuMethods[0] ? renderer : nullptr;
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
                if (at > until || at - from + expected > share) {
                    leaveOut(side, "");
                    break;
                }
                progress.show(0.25 + 0.75 * std::min((at - begun) / (until - begun), 1.0),
                              fmt::format("{}, {}, {} particles", device, method, seriesParticles(side)));
                Result<SeriesRow> row = measureSeries(gpu, scene, method, side, context.quick ? 0 : kStepSeconds, draws, until);
                if (!row && row.error().memory && before > 0) {
                    gpu.device->forgiveFull();
                    leaveOut(side, " (memory)");
                    break;  // as many as memory allows
                }
                if (!row) return row.error();
                last = hostSeconds() - at;
                before = side;
                series.append(jsonOf(*row));
                if (draws != nullptr && row->drawMs == 0)
                    out.push_back(fmt::format("{}: a picture of {} particles", device, row->particles));
                const auto report = [&](const std::string& what, const char* unit, double ms, double predicted) {
                    context.report({.name = fmt::format("gpu, {}: {}, {}", row->device, what, row->particles),
                                    .unit = unit,
                                    .value = spreadOf({ms}),
                                    .passes = {{"predicted", predicted}}});
                };
                report(method, "ms/step", row->stepMs, row->predictedStepMs);
                if (row->drawMs > 0) report("drawn", "ms", row->drawMs, row->predictedDrawMs);
                if (Status saved = context.save(); !saved) return saved.error();
                if (&gpu == &gpus.front() && method == kGpuMethods[0]) largest = std::move(*row);
            }
        }
    return largest;
}

Result<std::unique_ptr<SceneRenderer>> rendererOf(const GpuDevices& devices) {
    if (!devices.gl.present()) return std::unique_ptr<SceneRenderer>();
    return SceneRenderer::create(ShaderFiles::developer());
}

}  // namespace

Status benchGpu(const BenchContext& context) {
    const double start = hostSeconds(), seriesUntil = start + kSeriesUntil * context.seconds;
    const GpuDevices devices(context.log, context.quick);
    if (devices.list.empty()) {
        context.log.notice("the case gpu needs OpenGL or OpenCL, and this machine has neither: it is skipped");
        return ok();
    }
    Result<SceneFile> scene = loadScene("dam_break.json", {});
    if (!scene) return scene.error();
    Json::Value unused, &result = (context.json != nullptr ? *context.json : unused)["gpu"];
    Progress progress("gpu");
    LeftOut out;

    // Correctness first: the speed of wrong water is of no use. What is known is saved at once: a person may send it after Ctrl-C.
    result["complete"] = false;
    const Result<std::vector<GpuFinding>> findings = compare(devices, *scene, start + kChecksUntil * context.seconds, progress, out);
    if (!findings) return findings.error();
    std::string wrong;
    result["checks"] = Json::Value(Json::arrayValue);
    for (const GpuFinding& f : *findings) {
        result["checks"].append(jsonOf(f));
        if (!f.passed()) wrong += fmt::format("{}{}", wrong.empty() ? "" : "; ", f.sentence());
    }
    result["correct"] = wrong.empty();
    const char* verdict = !wrong.empty() ? "does not compute the same water as the cpu"
                          : out.empty()  ? "computes the same water as the cpu"
                                         : "computes the same water as the cpu, as far as there was time to compare";
    if (Status saved = context.save(); !saved) return saved;

    std::vector<ExaminedGpu> gpus;
    result["devices"] = Json::Value(Json::arrayValue);
    for (const std::unique_ptr<Device>& device : devices.list) {
        const char* name = backendName(device->backend());
        progress.show(0.2, fmt::format("{}: rates", name));
        Result<ExaminedGpu> gpu = ExaminedGpu{.device = device.get(), .name = devices.nameOf(*device)};
        if (hostSeconds() < seriesUntil)
            gpu = examineGpu(*device, devices.nameOf(*device));
        else
            out.push_back(fmt::format("{}: rates", name));
        if (!gpu) return gpu.error();
        result["devices"].append(jsonOf(*gpu));
        gpus.push_back(std::move(*gpu));
        if (Status saved = context.save(); !saved) return saved;
    }
    Result<std::unique_ptr<SceneRenderer>> renderer = std::unique_ptr<SceneRenderer>();
    if (hostSeconds() < seriesUntil) renderer = rendererOf(devices);
    if (!renderer) return renderer.error();
    result["series"] = Json::Value(Json::arrayValue);
    const Result<std::optional<SeriesRow>> largest =
        runSeries(context, gpus, *scene, renderer->get(), seriesUntil, progress, result["series"], out);
    if (!largest) return largest.error();
    std::string sentence = fmt::format("{} {}; ", gpus.front().name, verdict);
    sentence += *largest ? fmt::format("{} (from {}).", sentenceOf(**largest), gpus.front().from) : "no size was measured.";
    result["leftOut"] = Json::Value(Json::arrayValue);
    for (const std::string& what : out) result["leftOut"].append(what);
    if (!out.empty()) sentence += fmt::format(" Left out after {:.0f} s: {}.", hostSeconds() - start, fmt::join(out, "; "));
    result["sentence"] = sentence;
    result["seconds"] = hostSeconds() - start;
    result["complete"] = true;
    fmt::print("{}\n", sentence);
    flushOutput();
    return wrong.empty() ? ok() : Status(failed(fmt::format("the water differs from the cpu's: {}", wrong)));
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
    if (context.out.empty()) return ok();
    const Graceful whole;  // Ctrl-C waits for the files
    return writeGpuPage(run, context.out, "rivulet bench gpu_model --out " + context.out);
}

}  // namespace rivulet
