// The benchmark of the thesis's chapter 4: see fluid/validate/chapter4.h.
#include <fmt/format.h>

#include "demos/rivulet/bench_cases.h"
#include "demos/rivulet/interrupt.h"
#include "engine/app/context_egl.h"
#include "fluid/render/backend.h"
#include "fluid/validate/chapter4.h"

namespace rivulet {

Status benchChapter4(const BenchContext& context) {
    Result<ContextEgl> egl = ContextEgl::create();
    const GlFacts gl = egl ? currentGlFacts() : noGl(egl.error().message);
    const std::unique_ptr<Device> device = makeDevice("gl", gl, context.log);
    if (device->backend() != Backend::gl) {
        context.log.notice("the case chapter4 needs OpenGL, which is not available: it is skipped");
        return ok();
    }
    Chapter4Request request;
    request.device = device.get();
    request.runs = context.runs;
    request.report = [&context](const Chapter4Row& row) {
        BenchRow line{
            .name = fmt::format("chapter 4, {}, {}, {}, {}", row.particles, row.grid, row.walk.empty() ? "none" : row.walk, row.workGroup),
            .unit = "frames/s",
            .value = row.frames,
            .passes = row.passes};
        line.passes["step"] = row.stepMs;
        line.passes["drawing"] = row.drawMs;
        context.report(line);
    };
    const Result<Chapter4> chapter = runChapter4(request);
    if (!chapter) return chapter.error();
    if (context.out.empty()) return ok();
    const Graceful whole;  // Ctrl-C waits for the files
    return writeChapter4(*chapter, context.out, machineName(), "rivulet bench chapter4 --out " + context.out);
}

}  // namespace rivulet
