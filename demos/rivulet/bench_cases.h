// The cases of `rivulet bench`. A case measures a quantity several times and reports median, minimum and maximum.
#pragma once

#include <json/forwards.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "engine/core/log.h"
#include "engine/core/result.h"
#include "engine/core/table.h"
#include "fluid/session/run_stats.h"

namespace rivulet {

// One row of the results.
struct BenchRow {
    std::string name;                      // "wcsph step, 128k, cpu"
    std::string unit;                      // "ms", "B/particle"
    Spread value;                          // over value.count runs
    std::map<std::string, double> passes;  // ms by name of the pass, of the last run; may be empty
};

struct BenchContext {
    int runs = 5;                                 // measured runs of each row
    bool named = false;                           // the person asked for this case, not for all
    bool quick = false;                           // gpu: one device, the smallest sizes; gpu_model: nothing is measured
    double seconds = 90;                          // gpu: it ends after about this time
    Json::Value* json = nullptr;                  // of --json: a case may add values under its own name
    std::function<Status()> save;                 // writes it as it is so far: a case that takes long and may be interrupted
    std::string out;                              // output folder of the pages of a case; "": no pages
    Log log;                                      // notices, for example of an absent backend
    std::function<void(const BenchRow&)> report;  // prints a row at once
};

struct BenchCase {
    const char* name;
    const char* doc;
    Status (*run)(const BenchContext& context);
    const char* options;  // those of its own: "--runs --out"
};
Table<BenchCase> benchCases();

Status benchVoxels(const BenchContext& context);
Status benchCollide(const BenchContext& context);
Status benchMethods(const BenchContext& context);
Status benchGpu(const BenchContext& context);
Status benchGpuModel(const BenchContext& context);
Status benchFlow(const BenchContext& context);
Status benchChapter2(const BenchContext& context);
Status benchChapter4(const BenchContext& context);
Status benchHost(const BenchContext& context);
Status benchDraw(const BenchContext& context);
Status benchSleep(const BenchContext& context);
Status benchUi(const BenchContext& context);

// Calls `once` 1 + context.runs times; the first call warms the caches and is not counted. Returns the spread of the values of the others.
Spread repeat(const BenchContext& context, const std::function<double()>& once);

}  // namespace rivulet
