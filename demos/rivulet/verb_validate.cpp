#include <fmt/format.h>
#include <fmt/ranges.h>
#include <json/json.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "demos/rivulet/asked_device.h"
#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "demos/rivulet/outputs.h"
#include "engine/app/capture.h"
#include "engine/core/file.h"
#include "engine/core/json_text.h"
#include "engine/core/message_line.h"
#include "fluid/render/backend.h"
#include "fluid/session/run_stats.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/validate/orders.h"
#include "fluid/validate/physics_case.h"

namespace rivulet {

namespace {

struct ValidateRequest {
    std::vector<std::string> names, assignments;
    std::string method, backend, device, json, pictures;
    bool quick = false, orders = false;
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
    v["known"] = f.known.empty() || f.pass() ? Json::Value() : Json::Value(f.known);
    return v;
}

void print(const PhysicsCase& row, const Outcome& o) {
    if (!o.refused.empty()) {
        fmt::print("{}, {}: refused: {}\n", row.name, o.method, messageLine(o.refused));
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
                   !f.tolerance ? std::string()
                   : f.pass()   ? "ok"
                   : f.fails()  ? "MISSED"
                                : "missed: " + f.known);
    flushOutput();
}

// Errors of a case at its spacings, with the fitted order.
Json::Value printOrders(const PhysicsCase& row, const std::string& method, const Orders& orders) {
    Json::Value all(Json::arrayValue);
    std::string head = fmt::format("{}, {}, errors at spacings of", row.name, method);
    for (const double spacing : orders.spacings) head += fmt::format(" {:.4g}", spacing);
    fmt::print("{} m\n", head);
    for (const OrderRow& r : orders.rows) {
        std::string line = fmt::format("    {:<72}", r.what);
        Json::Value v(Json::objectValue);
        v["case"] = fmt::format("{}: {}", row.name, r.what);
        v["method"] = method;
        for (size_t k = 0; k < r.errors.size(); ++k) {
            line += fmt::format(" {:>9.3g}", r.errors[k]);
            v["spacings"].append(orders.spacings[k]);
            v["errors"].append(r.errors[k]);
        }
        v["order"] = r.order;
        all.append(v);
        fmt::print("{}   {}\n", line, std::isfinite(r.order) ? fmt::format("order {:.2f}", r.order) : "no order: an error is 0");
    }
    flushOutput();
    return all;
}

// Of all cases, each once.
std::vector<std::string> allMethods() {
    std::vector<std::string> all;
    for (const PhysicsCase& row : physicsCases().rows)
        for (const std::string& method : methodsOf(row))
            if (std::find(all.begin(), all.end(), method) == all.end()) all.push_back(method);
    return all;
}

Status checkRequest(ValidateRequest& request) {
    for (const std::string& name : request.names)
        if (Status known = checkWord("case", name, physicsCases().names()); !known) return known;
    if (!request.method.empty())
        if (Status known = checkWord("method", request.method, allMethods()); !known) return known;
    if (Status sense = settleBackend(request.backend, "cpu", request.device); !sense) return sense;
    for (const std::string& name : request.names)
        if (request.orders && *physicsCases().find(name)->sizes == '\0')
            return badInput(fmt::format("the case {} has no sizes for --orders: name another case, or none for all that can", name));
    if (request.orders && !request.pictures.empty()) return badInput("--orders draws no pictures: leave out --pictures");
    if (request.orders && request.backend != "cpu") return badInput("--orders runs on the cpu: leave out --backend and --device");
    const NamedFile outputs[] = {
        {"--json", request.json},
        {"--pictures", request.pictures.empty() ? "" : (std::filesystem::path(request.pictures) / "*.svg").string(), true}};
    if (Status apart = checkOutputs(outputs, {}); !apart) return apart;
    if (!request.json.empty())
        if (Status writable = checkWritable(request.json); !writable) return writable;
    if (!request.pictures.empty()) return makeFolder(request.pictures);
    return ok();
}

}  // namespace

int validateVerb(const Arguments& arguments) {
    ArgumentReader reader(
        "validate",
        "Compares the simulation with experiments, published data and analytic solutions. The exit status is 1 if an error "
        "exceeds its tolerance and the cause is not known.");
    ValidateRequest request;
    std::string list;
    for (const PhysicsCase& row : physicsCases().rows) list += fmt::format("\n  {:<16}{}", row.name, row.doc);
    reader.footer(
        "On the backends gl and cl, a case runs for 0.5 s with 8,000 particles and is compared with the cpu.\nTolerances apply to the "
        "method dfsph, in some cases to pbf and wcsph, to flow on skins, and to the first filter for surfaces; other results are only "
        "reported.\nA miss with a known cause is printed as \"missed\" with the cause, and does not change the exit status.\n\nCases:" +
        list);
    reader.positional("CASE", "cases to run; default: all", request.names);
    reader.flag("--quick", "run each case with about 8,000 particles", request.quick);
    reader.flag("--orders", "run cases at four spacings and print the errors and the order of convergence; default: all that can",
                request.orders);
    reader.option("--method", "M", fmt::format("run one method only: {}; default: all", fmt::join(allMethods(), ", ")), request.method);
    reader.option("--backend", "B", "backend of the simulation: cpu, gl or cl; default: cpu", request.backend);
    reader.option("--device", "TEXT", "OpenCL device: part of its name, or its number in 'rivulet list devices'", request.device);
    reader.option("--json", "FILE.json", "also write the results as JSON", request.json);
    reader.option("--pictures", "DIR",
                  "write a chart (SVG) of each case, measured values and reference, to this folder; of surface, its pictures (PNG)",
                  request.pictures);
    reader.option("--set", "PATH=VALUE", "set a parameter of the case's scene; may be repeated", request.assignments);
    if (std::optional<int> code = reader.read(arguments)) return *code;
    if (Status sense = checkRequest(request); !sense) return report(sense.error());

    std::vector<std::string> names = request.names;
    if (names.empty())
        for (const PhysicsCase& row : physicsCases().rows)
            if (!request.orders || *row.sizes != '\0') names.emplace_back(row.name);

    const AskedDevice asked = askedDevice(request.backend, stderrLog(), request.device);
    const std::unique_ptr<Device>& device = asked.device;
    const bool onCpu = device->backend() == Backend::cpu;
    const std::vector<CpuKernelRow> rows = cpuKernels();
    const std::unique_ptr<Device> cpu = onCpu ? nullptr : makeCpuDevice(rows);

    // Until files are written, Ctrl-C exits at once: results are printed, and there is nothing to close.
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
            if (!request.pictures.empty())
                settings.savePicture = [&](const std::string& as, const std::vector<uint8_t>& rgba, int width, int height) {
                    return writePng((std::filesystem::path(request.pictures) / (as + ".png")).string(), rgba, width, height);
                };
            settings.log = stderrLog();
            settings.goOn = [&](double share) {
                progress.show(share);
                return true;
            };
            if (request.orders) {
                if (!request.method.empty() || judges(row, method)) {
                    const Result<Orders> orders = measureOrders(row, settings);
                    if (!orders) return report(orders.error());
                    for (const Json::Value& v : printOrders(row, method, *orders)) all.append(v);
                }
                continue;
            }
            Result<Outcome> outcome = runCase(row, settings, cpu.get());
            if (!outcome) return report(outcome.error());
            for (Finding& f : outcome->findings) {
                if (onCpu && !judges(row, method)) f.tolerance.reset();
                passed = passed && !f.fails();
                all.append(jsonOf(row, backendName(device->backend()), *outcome, f));
            }
            print(row, *outcome);
            if (!request.pictures.empty() && !outcome->plot.curves.empty()) {
                const std::string path = (std::filesystem::path(request.pictures) / fmt::format("{}_{}.svg", name, method)).string();
                const Graceful graceful;
                if (Status drawn = drawPlot(outcome->plot, path); !drawn) return report(drawn.error());
                if (graceful.interrupted()) return graceful.status();
            }
        }
    }
    const Graceful graceful;
    if (!request.json.empty())
        if (Status written = writeFileAtomic(request.json, jsonText(all, 8)); !written) return report(written.error());
    if (graceful.interrupted()) return graceful.status();
    return passed ? kDone : kFailed;
}

}  // namespace rivulet
