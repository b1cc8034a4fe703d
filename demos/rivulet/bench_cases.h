// The rows of `rivulet bench`. A case measures something several times and reports the spread.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "engine/core/log.h"
#include "engine/core/result.h"
#include "engine/core/table.h"
#include "fluid/session/run_stats.h"

namespace rivulet {

// One line of a bench's report.
struct BenchRow {
    std::string name;                      // "wcsph step, 128k, cpu"
    std::string unit;                      // "ms", "B/particle"
    Spread value;                          // over value.count runs
    std::map<std::string, double> passes;  // ms, medians of the parts; may be empty
};

struct BenchContext {
    int runs = 5;                                 // at least
    std::string out;                              // the folder for pages that a case writes; "" = none is to be written
    Log log;                                      // for notices: a backend that is absent
    std::function<void(const BenchRow&)> report;  // a row is printed as soon as it is known
    std::function<bool()> interrupted;            // ask between runs; then return
};

struct BenchCase {
    const char* name;
    const char* doc;
    Status (*run)(const BenchContext& context);
};
Table<BenchCase> benchCases();

Status benchVoxels(const BenchContext& context);
Status benchCollide(const BenchContext& context);
Status benchMethods(const BenchContext& context);
Status benchFlow(const BenchContext& context);
Status benchChapter2(const BenchContext& context);
Status benchChapter4(const BenchContext& context);
Status benchHost(const BenchContext& context);
Status benchUi(const BenchContext& context);

// Calls `once` context.runs times (a first call, not counted, warms caches); the spread of what it returns.
Spread repeat(const BenchContext& context, const std::function<double()>& once);

}  // namespace rivulet
