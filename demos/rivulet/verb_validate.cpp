#include <fmt/format.h>
#include <json/json.h>

#include <algorithm>
#include <filesystem>

#include "demos/rivulet/asked_device.h"
#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "engine/app/capture.h"
#include "engine/core/file.h"
#include "fluid/render/backend.h"
#include "fluid/session/run_stats.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/validate/physics_case.h"

namespace rivulet {

namespace {

struct ValidateRequest {
    std::vector<std::string> names, assignments;
    std::string method, backend, device, json, pictures;
    bool quick = false;
};

Json::Value jsonOf(const PhysicsCase& row, const char* backend, const Outcome& o, const Finding& f) {
    Json::Value v(Json::objectValue);
    v["case"] = fmt::format("{}: {}", row.name, f.what);
    v["method"] = o.method;
    v["backend"] = backend;
    v["measured"] = f.measured;
    v["reference"] = f.reference;
    v["error"] = f.error;
    v["tolerance"] = f.tolerance ? Json::Value(*f.tolerance) : Json::Value();
    v["unit"] = f.unit;
    v["particles"] = o.particles;
    v["wallPerSecond"] = o.wallPerSecond;
    v["sweepsPerSecond"] = o.sweepsPerSecond;
    v["pass"] = f.pass();
    return v;
}

void print(const PhysicsCase& row, const Outcome& o) {
    if (!o.refused.empty()) {
        fmt::print("{}, {}: refused: {}\n", row.name, o.method, o.refused);
        return;
    }
    if (o.wallPerSecond == 0)
        fmt::print("{}, {}: {} particles\n", row.name, o.method, o.particles);
    else if (o.particles == 0)
        fmt::print("{}, {}: {:.3g} s per simulated second\n", row.name, o.method, o.wallPerSecond);
    else
        fmt::print("{}, {}: {} particles, {:.3g} s and {:.3g} sweeps per simulated second, {:.3g} % compressed\n", row.name, o.method,
                   o.particles, o.wallPerSecond, o.sweepsPerSecond, 100 * o.compression);
    for (const Finding& f : o.findings)
        fmt::print("    {:<56} {:>11.5g} {:>11.5g} {:<6} {:>9.3g} {:>9} {}\n", f.what, f.measured, f.reference, f.unit, f.error,
                   f.tolerance ? fmt::format("{:.3g}", *f.tolerance) : "",
                   !f.tolerance ? ""
                   : f.pass()   ? "ok"
                                : "MISSED");
    std::fflush(stdout);
}

Status checkRequest(ValidateRequest& request) {
    for (const std::string& name : request.names)
        if (Status known = checkWord("case", name, physicsCases().names()); !known) return known;
    if (!request.method.empty()) {
        std::vector<std::string> any;
        for (const PhysicsCase& row : physicsCases().rows)
            for (const std::string& method : methodsOf(row))
                if (std::find(any.begin(), any.end(), method) == any.end()) any.push_back(method);
        if (Status known = checkWord("method", request.method, any); !known) return known;
    }
    if (Status sense = settleBackend(request.backend, "cpu", request.device); !sense) return sense;
    if (!request.json.empty())
        if (Status writable = checkWritable(request.json); !writable) return writable;
    if (!request.pictures.empty()) return makeFolder(request.pictures);
    return ok();
}

}  // namespace

int validateVerb(const Arguments& arguments) {
    ArgumentReader reader("validate", "Measures the simulation against nature, papers and formulas.");
    ValidateRequest request;
    std::string list;
    for (const PhysicsCase& row : physicsCases().rows) list += fmt::format("\n  {:<16}{}", row.name, row.doc);
    reader.footer(
        "On gl and cl a case runs for half a second at 8,000 particles and is compared with the cpu.\nAims hold for the method dfsph, "
        "on skins for flow, of surfaces for the first filter; the others are reported beside it.\n\nCases:" +
        list);
    reader.positional("CASE", "which cases; all of them when none is named", request.names);
    reader.flag("--quick", "each at about 8,000 particles", request.quick);
    reader.option("--method", "M", "one method only; else all: dfsph, pbf, wcsph, wcsph_thesis; flow, flow_thesis; a filter, reference",
                  request.method);
    reader.option("--backend", "B", "cpu, gl or cl", request.backend);
    reader.option("--device", "TEXT", "which OpenCL device: a part of its name, or its number in 'list devices'", request.device);
    reader.option("--json", "FILE.json", "also write the figures to a file", request.json);
    reader.option("--pictures", "DIR", "draw each case, measured against reference, as SVG into this folder", request.pictures);
    reader.option("--set", "path=value", "change a parameter of the case's scene", request.assignments);
    if (std::optional<int> code = reader.read(arguments)) return *code;
    if (Status sense = checkRequest(request); !sense) return report(sense.error());

    std::vector<std::string> names = request.names.empty() ? physicsCases().names() : request.names;

    const AskedDevice asked = askedDevice(request.backend, stderrLog(), request.device);
    const std::unique_ptr<Device>& device = asked.device;
    const bool onCpu = device->backend() == Backend::cpu;
    const std::vector<CpuKernelRow> rows = cpuKernels();
    const std::unique_ptr<Device> cpu = onCpu ? nullptr : makeCpuDevice(rows);

    Graceful graceful;
    Json::Value all(Json::arrayValue);
    bool passed = true;
    fmt::print("{}\n    {:<56} {:>11} {:>11} {:<6} {:>9} {:>9}\n", machineName(), "", "measured", "reference", "", "error", "tolerance");
    for (const std::string& name : names) {
        const PhysicsCase& row = *physicsCases().find(name);
        for (const std::string& method : methodsOf(row)) {
            if (!request.method.empty() && method != request.method) continue;
            Progress progress(fmt::format("{}, {}", name, method));
            CaseSettings settings;
            settings.device = device.get();
            settings.method = method;
            settings.quick = request.quick;
            settings.assignments = request.assignments;
            settings.log = stderrLog();
            settings.goOn = [&](double share) {
                progress.show(share);
                return !graceful.interrupted();
            };
            Result<Outcome> outcome = runCase(row, settings, cpu.get());
            if (!outcome) return report(outcome.error());
            if (graceful.interrupted()) return kInterrupted;
            for (Finding& f : outcome->findings) {
                if (onCpu && method != row.judged) f.tolerance.reset();
                passed = passed && f.pass();
                all.append(jsonOf(row, backendName(device->backend()), *outcome, f));
            }
            print(row, *outcome);
            if (!request.pictures.empty() && !outcome->plot.curves.empty()) {
                const std::string path = (std::filesystem::path(request.pictures) / fmt::format("{}_{}.svg", name, method)).string();
                if (Status drawn = drawPlot(outcome->plot, path); !drawn) return report(drawn.error());
            }
        }
    }
    if (!request.json.empty()) {
        Json::StreamWriterBuilder builder;
        builder["indentation"] = "  ";
        builder["precision"] = 8;
        if (Status written = writeFileAtomic(request.json, Json::writeString(builder, all) + "\n"); !written)
            return report(written.error());
    }
    return passed ? kDone : kFailed;
}

}  // namespace rivulet
