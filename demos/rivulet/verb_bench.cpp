#include <fmt/format.h>
#include <json/json.h>

#include "demos/rivulet/bench_cases.h"
#include "demos/rivulet/cli.h"
#include "demos/rivulet/interrupt.h"
#include "engine/app/capture.h"
#include "engine/core/file.h"

namespace rivulet {

Spread repeat(const BenchContext& context, const std::function<double()>& once) {
    once();
    std::vector<double> values;
    for (int i = 0; i < context.runs && !context.interrupted(); ++i) values.push_back(once());
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
    std::fflush(stdout);
}

// A page of a table, with the passes of each row beneath it.
std::string markdownOf(const Json::Value& all) {
    std::string page = fmt::format("# Performance\n\nWritten by `rivulet bench --markdown`, version {}, on: {}.\n\n",
                                   all["version"].asString(), all["machine"].asString());
    page += "| what | unit | median | least | most | runs | its passes, ms |\n| --- | --- | --- | --- | --- | --- | --- |\n";
    for (const Json::Value& row : all["rows"]) {
        std::string passes;
        for (const std::string& name : row["passes"].getMemberNames())
            passes += fmt::format("{}{} {:.3f}", passes.empty() ? "" : ", ", name, row["passes"][name].asDouble());
        page += fmt::format("| {} | {} | {:.4g} | {:.4g} | {:.4g} | {} | {} |\n", row["name"].asString(), row["unit"].asString(),
                            row["median"].asDouble(), row["min"].asDouble(), row["max"].asDouble(), row["runs"].asUInt64(), passes);
    }
    return page;
}

}  // namespace

int benchVerb(const Arguments& arguments) {
    ArgumentReader reader("bench", "Measures speed and memory.");
    std::vector<std::string> names;
    std::string jsonFile, markdownFile, out;
    std::optional<int> runs;
    std::string list;
    for (const BenchCase& row : benchCases().rows) list += fmt::format("\n  {:<16}{}", row.name, row.doc);
    reader.footer("Cases:" + list);
    reader.positional("CASE", "which cases; all of them when none is named", names);
    reader.option("--json", "FILE.json", "also write the figures to a file", jsonFile);
    reader.option("--markdown", "FILE.md", "also write a page of them, as docs/performance.md is", markdownFile);
    reader.option("--out", "DIR", "the folder for the pages of chapter2 and chapter4; none are written if not given", out);
    reader.option("--runs", "N", "measured runs of each", runs, 5, 1000);
    if (std::optional<int> code = reader.read(arguments)) return *code;

    std::vector<const BenchCase*> cases;
    for (const BenchCase& row : benchCases().rows)
        if (names.empty()) cases.push_back(&row);
    for (const std::string& name : names) {
        if (Status known = checkWord("bench case", name, benchCases().names()); !known) return report(known.error());
        cases.push_back(benchCases().find(name));
    }

    if (!out.empty())
        if (Status made = makeFolder(out); !made) return report(made.error());
    Graceful graceful;
    Json::Value all(Json::objectValue);
    all["version"] = RIVULET_VERSION;
    all["machine"] = machineName();
    all["rows"] = Json::Value(Json::arrayValue);
    fmt::print("{}\n{:<44} {:>10} {:>10} {:>10}\n", machineName(), "", "median", "min", "max");
    for (const BenchCase* benchCase : cases) {
        BenchContext context;
        context.runs = runs.value_or(5);
        context.out = out;
        context.log = stderrLog();
        context.interrupted = [&graceful] { return graceful.interrupted(); };
        context.report = [&all, benchCase](const BenchRow& row) {
            print(row);
            all["rows"].append(jsonOf(benchCase->name, row));
        };
        if (Status done = benchCase->run(context); !done) return report(done.error());
        if (graceful.interrupted()) return kInterrupted;
    }
    if (!jsonFile.empty()) {
        Json::StreamWriterBuilder builder;
        builder["indentation"] = "  ";
        builder["enableYAMLCompatibility"] = true;
        builder["precision"] = 6;
        if (Status written = writeFileAtomic(jsonFile, Json::writeString(builder, all) + "\n"); !written) return report(written.error());
    }
    if (!markdownFile.empty())
        if (Status written = writeFileAtomic(markdownFile, markdownOf(all)); !written) return report(written.error());
    return kDone;
}

}  // namespace rivulet
