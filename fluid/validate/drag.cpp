// Drag of a sphere and of a cylinder that are held in a stream. Sphere: Cd = 24 / Re (1 + 0.15 Re^0.687) (Schiller and Naumann 1935; within
// 5 % of the measurements below Re = 800, Clift, Grace and Weber 1978). Cylinder: Dennis and Chang 1970, steady flow. A sphere's wake is
// steady up to Re = 210, a cylinder's up to Re = 47.
//
// The water starts with the speed of the stream, and the run ends before the wake returns through the periodic box. Drag slows the water
// down by 1 to 3 % until then; the speed of the stream is the mean over all water. The rows of images beside the cylinder raise its drag as
// the walls of a wind tunnel do, which is corrected by Allen and Vincenti 1944. For the sphere, five diameters from its images, the same
// effect is below 3 %.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "fluid/validate/trial.h"

namespace rivulet {

namespace {

// The drag coefficient of a body of diameter `diameter` and frontal area `area` (m, m^2) and its curve over time; nothing: the run was
// stopped.
struct Drag {
    double coefficient = 0;
    Curve curve;
};
std::optional<Drag> dragOf(Trial& trial, double diameter, double area, const std::string& name) {
    const FluidParams& p = trial.params();
    const double speed = p.blocks[0].velocity.x, density = p.restDensity, from = 0.6 * double{trial.scene().duration};
    Drag drag{0, {name, true, {}}};
    double impulse = 0, head = 0, before = 0, time = 0, binned = 0, since = 0;
    const double bin = 0.5 * diameter / speed;
    const bool done = trial.run(1.0 / 120, [&] {
        const HostParticles all = trial.particles();
        double mean = 0;
        for (const vec4& v : all.velocity) mean += double{v.x} / static_cast<double>(all.velocity.size());
        const double passed = trial.time() - time, force = trial.world().stats().loads.probes.at(0).impulse.x - before;
        time += passed;
        before += force;
        binned += force;
        if (time - since >= bin) {
            drag.curve.points.emplace_back(time * speed / diameter, binned / ((time - since) * 0.5 * density * mean * mean * area));
            binned = 0;
            since = time;
        }
        if (time < from) return;
        impulse += force;
        head += passed * 0.5 * density * mean * mean * area;
    });
    if (!done) return {};
    drag.coefficient = impulse / head;
    return drag;
}

struct Stream {
    const char* name;
    std::vector<double> reynolds;
    std::function<double(const FluidParams&, double)> area;          // m^2, of a body of that diameter
    std::function<double(double)> reference;                         // drag coefficient at a Reynolds number
    std::function<double(const FluidParams&, double, double)> free;  // of a measured coefficient and a diameter: without images
};

Result<Outcome> run(const CaseSettings& settings, const Stream& stream) {
    std::vector<Finding> findings;
    Plot plot{fmt::format("Drag: {}", stream.name), "t U / D", "Cd", {}};
    std::optional<Trial> last;
    Result<SceneFile> scene = loadScene(fmt::format("cases/{}.json", stream.name), {});
    if (!scene) return scene.error();
    const ColliderParams& body = scene->colliders[0];
    const double diameter = double{body.fitSize > 0 ? body.fitSize : body.scale}, speed = scene->fluid.blocks[0].velocity.x;
    for (const double reynolds : stream.reynolds) {
        CaseSettings with = settings;
        with.assignments.insert(with.assignments.begin(), fmt::format("fluid.viscosity={:.9g}", speed * diameter / reynolds));
        Result<Trial> trial = Trial::open(stream.name, with);
        if (!trial) return trial.error();
        const FluidParams params = trial->params();
        const std::optional<Drag> drag = dragOf(*trial, diameter, stream.area(params, diameter), fmt::format("Re = {:.0f}", reynolds));
        if (!drag) return trial->outcome({}, {});
        const double measured = stream.free(params, drag->coefficient, diameter), expected = stream.reference(reynolds);
        findings.push_back(
            {fmt::format("drag coefficient at Re = {:.0f}", reynolds), "", measured, expected, std::abs(measured / expected - 1), 0.15});
        plot.curves.push_back(drag->curve);
        last = std::move(*trial);
    }
    return last->outcome(findings, plot);
}

}  // namespace

Result<Outcome> runDrag(const CaseSettings& settings) {
    return run(settings, {"drag", settings.quick ? std::vector<double>{20} : std::vector<double>{20, 100, 200},
                          [](const FluidParams&, double diameter) { return std::numbers::pi / 4 * diameter * diameter; },
                          [](double reynolds) { return 24 / reynolds * (1 + 0.15 * std::pow(reynolds, 0.687)); },
                          [](const FluidParams&, double measured, double) { return measured; }});
}

Result<Outcome> runDragCylinder(const CaseSettings& settings) {
    return run(settings, {"drag_cylinder", settings.quick ? std::vector<double>{20} : std::vector<double>{20, 40},
                          [](const FluidParams& p, double diameter) { return diameter * double{p.box.max.z - p.box.min.z}; },
                          [](double reynolds) { return reynolds < 30 ? 2.045 : 1.522; },
                          [](const FluidParams& p, double measured, double diameter) {
                              const double share = diameter / double{p.box.max.y - p.box.min.y};
                              return measured * (1 - 0.5 * measured * share - 2.5 * share * share);
                          }});
}

}  // namespace rivulet
