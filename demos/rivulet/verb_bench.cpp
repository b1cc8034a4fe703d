#include <fmt/format.h>
#include <json/json.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string_view>
#include <utility>

#include "demos/rivulet/bench_cases.h"
#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "demos/rivulet/outputs.h"
#include "engine/app/capture.h"
#include "engine/core/file.h"
#include "engine/core/json_text.h"

namespace rivulet {

Spread repeat(const BenchContext& context, const std::function<double()>& once) {
    once();
    std::vector<double> values(context.runs);
    for (double& value : values) value = once();
    return spreadOf(values);
}

namespace {

Json::Value jsonOf(const char* benchCase, const BenchRow& row) {
    Json::Value v(Json::objectValue);
    v["case"] = benchCase;
    v["name"] = row.name;
    v["unit"] = row.unit;
    v["runs"] = Json::UInt64(row.value.count);
    v["median"] = row.value.median;
    v["min"] = row.value.min;
    v["max"] = row.value.max;
    for (const auto& [pass, ms] : row.passes) v["passes"][pass] = ms;
    return v;
}

void print(const BenchRow& row) {
    fmt::print("{:<44} {:>10.3f} {:>10.3f} {:>10.3f}  {:<10} {} runs\n", row.name, row.value.median, row.value.min, row.value.max, row.unit,
               row.value.count);
    for (const auto& [pass, ms] : row.passes) fmt::print("    {:<40} {:>10.3f}\n", pass, ms);
    flushOutput();
}

// The results as a Markdown page: one table row for each measurement, with the times of its passes.
std::string markdownOf(const Json::Value& all) {
    std::string page = fmt::format("# Performance\n\nWritten by `rivulet bench --markdown`, version {}, on: {}.\n\n",
                                   all["version"].asString(), all["machine"].asString());
    page += "| measurement | unit | median | minimum | maximum | runs | passes, ms |\n| --- | --- | --- | --- | --- | --- | --- |\n";
    for (const Json::Value& row : all["rows"]) {
        std::string passes;
        for (const std::string& name : row["passes"].getMemberNames())
            passes += fmt::format("{}{} {:.3f}", passes.empty() ? "" : ", ", name, row["passes"][name].asDouble());
        page += fmt::format("| {} | {} | {:.4g} | {:.4g} | {:.4g} | {} | {} |\n", row["name"].asString(), row["unit"].asString(),
                            row["median"].asDouble(), row["min"].asDouble(), row["max"].asDouble(), row["runs"].asUInt64(), passes);
    }
    return page;
}

bool reads(const BenchCase& row, std::string_view option) {
    return fmt::format(" {} ", row.options).find(fmt::format(" {} ", option)) != std::string::npos;
}

// The cases that read an option, for its help text.
std::string readersOf(std::string_view option) {
    std::string names;
    for (const BenchCase& row : benchCases().rows)
        if (reads(row, option)) names += fmt::format("{}{}", names.empty() ? "" : ", ", row.name);
    return names;
}

// Error (badInput): none of the cases reads `option`.
Status checkRead(std::span<const BenchCase* const> cases, std::string_view option) {
    if (std::ranges::any_of(cases, [option](const BenchCase* row) { return reads(*row, option); })) return ok();
    std::string names;
    for (const BenchCase* row : cases) names += fmt::format("{}{}", names.empty() ? "" : ", ", row->name);
    return badInput(fmt::format("{} has no effect on {}; leave it out, or add one of: {}", option, names, readersOf(option)));
}

}  // namespace

int benchVerb(const Arguments& arguments) {
    ArgumentReader reader("bench", "Measures speed and memory use. Each row shows the median, minimum and maximum of the runs.");
    std::vector<std::string> names;
    std::string jsonFile, markdownFile, out;
    std::optional<int> runs;
    std::string list;
    for (const BenchCase& row : benchCases().rows) list += fmt::format("\n  {:<16}{}", row.name, row.doc);
    reader.footer("Cases:" + list);
    reader.positional("CASE", "cases to measure; default: all", names);
    reader.option("--json", "FILE.json", "also write the results as JSON", jsonFile);
    reader.option("--markdown", "FILE.md", "also write the results as a Markdown page, like docs/performance.md", markdownFile);
    reader.option("--out", "DIR", fmt::format("output folder of the pages of {}; without it they write none", readersOf("--out")), out);
    bool quick = false;
    std::optional<double> seconds;
    reader.flag("--quick", "gpu: one device and the smallest sizes only; gpu_model: no measurements, the page keeps those that it has",
                quick);
    reader.option("--seconds", "S", "gpu: leaves out what takes longer than about this; default: 90", seconds, 1, 3600);
    reader.option("--runs", "N", fmt::format("measured runs of each row of {}; default: 5", readersOf("--runs")), runs, 5, 1000);
    if (std::optional<int> code = reader.read(arguments)) return *code;

    std::vector<const BenchCase*> cases;
    for (const BenchCase& row : benchCases().rows)
        if (names.empty()) cases.push_back(&row);
    for (const std::string& name : names) {
        if (Status known = checkWord("bench case", name, benchCases().names()); !known) return report(known.error());
        cases.push_back(benchCases().find(name));
    }
    for (const auto& [option, used] : {std::pair("--out", !out.empty()), std::pair("--quick", quick),
                                       std::pair("--seconds", seconds.has_value()), std::pair("--runs", runs.has_value())})
        if (used)
            if (Status read = checkRead(cases, option); !read) return report(read.error());

    const auto inOut = [&](const char* names) { return out.empty() ? "" : (std::filesystem::path(out) / names).string(); };
    const NamedFile outputs[] = {{"--json", jsonFile},
                                 {"--markdown", markdownFile},
                                 {"--out", inOut("chapter2.*"), true},
                                 {"--out", inOut("chapter4.*"), true},
                                 {"--out", inOut("gpus.md")},
                                 {"--out", inOut("gpus.csv")}};
    if (Status apart = checkOutputs(outputs, {}); !apart) return report(apart.error());
    for (const std::string& file : {jsonFile, markdownFile})
        if (!file.empty())
            if (Status writable = checkWritable(file); !writable) return report(writable.error());
    if (!out.empty())
        if (Status made = makeFolder(out); !made) return report(made.error());
    Json::Value all(Json::objectValue);
    all["version"] = RIVULET_VERSION;
    all["machine"] = machineName();
    all["rows"] = Json::Value(Json::arrayValue);
    // What a pipe or device gets cannot be replaced by the next.
    const bool replaced = !jsonFile.empty() && (!std::filesystem::exists(jsonFile) || std::filesystem::is_regular_file(jsonFile));
    const auto save = [&]() -> Status { return replaced ? writeFileAtomic(jsonFile, jsonText(all, 6)) : ok(); };
    fmt::print("{}\n{:<44} {:>10} {:>10} {:>10}\n", machineName(), "", "median", "min", "max");
    Status done = ok();
    for (const BenchCase* benchCase : cases) {
        BenchContext context;
        context.named = !names.empty();
        context.quick = quick;
        context.seconds = seconds.value_or(context.seconds);
        context.json = &all;
        context.save = save;
        context.runs = runs.value_or(5);
        context.out = out;
        context.log = stderrLog();
        context.report = [&all, benchCase](const BenchRow& row) {
            print(row);
            all["rows"].append(jsonOf(benchCase->name, row));
        };
        done = benchCase->run(context);
        if (!done) all["error"] = done.error().message;
        if (!done) break;                                                      // what is measured is written
        if (const Graceful pages; pages.interrupted()) return pages.status();  // while pages were written
    }
    const Graceful graceful;  // until here Ctrl-C exits at once: rows are printed, and there is nothing to close
    if (!jsonFile.empty())
        if (Status written = writeFileAtomic(jsonFile, jsonText(all, 6)); !written) return report(written.error());
    if (!markdownFile.empty())
        if (Status written = writeFileAtomic(markdownFile, markdownOf(all)); !written) return report(written.error());
    return done ? graceful.status() : report(done.error());
}

}  // namespace rivulet
