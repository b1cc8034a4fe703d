#include "fluid/validate/surface_chart.h"

#include <fmt/format.h>

#include "fluid/validate/surface.h"

namespace rivulet {

Result<SurfaceChart> runSurfaceChart(const SurfaceChartRequest& request) {
    CaseSettings settings;
    settings.device = request.device;
    settings.log = request.log;
    settings.quick = request.quick;
    std::string what = "dam break";
    settings.goOn = [&](double share) { return request.goOn(share, what); };
    Result<SurfaceTrial> trial = SurfaceTrial::create(settings);
    if (!trial) return trial.error();
    SurfaceChart chart;
    chart.width = trial->width();
    chart.height = trial->height();
    chart.slowFrames = 12;  // the reference takes seconds per frame
    chart.stillFrames = 16;
    chart.drawnBy = trial->drawnBy();
    std::vector<SurfaceLook> looks;
    for (const std::string& filter : surfaceMethods()) {
        looks.push_back({filter, "fine"});
        if (filter == kSurfaceReference) continue;
        looks.push_back({filter, "fine", kShortReach});
        looks.push_back({filter, "fast"});
    }
    for (const SurfaceLook& look : looks) {
        SurfaceChartRow row;
        row.look = look;
        const Result<DrawTimes> times = trial->times(look);
        if (!times) return times.error();
        row.times = *times;
        const Result<std::vector<ShapeErrors>> shapes = trial->shapes(look);
        if (!shapes) return shapes.error();
        for (const ShapeErrors& s : *shapes)
            if (s.shape->judged) (s.shape->whole ? row.sphere : row.slab) = s.errors;
        if (look.filter != kSurfaceReference) {
            const Result<MomentErrors> moment = trial->moment(look);
            if (!moment) return moment.error();
            row.moment = *moment;
        }
        chart.rows.push_back(std::move(row));
        what = "each look";
        if (!trial->goOn(kMomentShare)) break;
    }
    chart.particles = trial->momentParticles();
    what = "the dam break in slow motion";
    const Result<Watched> slow = trial->slow(looks, chart.slowFrames);
    if (!slow) return slow.error();
    what = "a pool at rest";
    const Result<Watched> still = trial->still(looks, chart.stillFrames);
    if (!still) return still.error();
    chart.stopped = trial->stopped();
    for (size_t k = 0; k < looks.size() && !chart.stopped; ++k) {
        chart.rows[k].slow = slow->looks[k];
        chart.rows[k].still = still->looks[k];
    }
    return chart;
}

}  // namespace rivulet
