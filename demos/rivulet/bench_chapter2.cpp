// The benchmark of the thesis's chapter 2: see fluid/validate/chapter2.h.
#include <fmt/format.h>

#include "demos/rivulet/bench_cases.h"
#include "demos/rivulet/interrupt.h"
#include "engine/app/context_egl.h"
#include "fluid/validate/chapter2.h"

namespace rivulet {

Status benchChapter2(const BenchContext& context) {
    Result<ContextEgl> egl = ContextEgl::create();
    if (!egl) {
        context.log.notice("the case chapter2 needs OpenGL, which is not available: it is skipped");
        return ok();
    }
    Chapter2Request request;
    request.gl = currentGlFacts();
    request.log = context.log;
    request.runs = context.runs;
    request.report = [&context](const Chapter2Row& row) {
        BenchRow line{.name = fmt::format("chapter 2, {}, {}", row.particles, nameOf(row.way)),
                      .unit = "ms",
                      .value = row.way.frameMs,
                      .passes = row.way.passes};
        line.passes["step"] = row.way.stepMs;
        line.passes["drawing"] = row.way.drawMs;
        line.passes["overlap"] = row.way.overlapMs;
        context.report(line);
    };
    const Result<Chapter2> chapter = runChapter2(request);
    if (!chapter) return chapter.error();
    if (context.out.empty()) return ok();
    const Graceful whole;  // Ctrl-C waits for the files
    return writeChapter2(*chapter, context.out, machineName(), "rivulet bench chapter2 --out " + context.out);
}

}  // namespace rivulet
