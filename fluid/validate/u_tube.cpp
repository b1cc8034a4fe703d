// A column of water oscillates in a U-tube: T = 2 pi sqrt(L / 2 g), and comes to rest at equal levels.
//
// L is the length of a straight column with the same inertia. In the two square corners the flow takes the short way round: such a corner
// counts 0.559 of its width (conduction through a corner, the same potential problem: Hall 1968, Thin Solid Films 1:277-295,
// doi:10.1016/0040-6090(68)90037-8); 1.0, the centre line, would give a period 8 % too long.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "fluid/validate/oscillation.h"
#include "fluid/validate/trial.h"

namespace rivulet {

Result<Outcome> runUTube(const CaseSettings& settings) {
    // The arms are 0.2 m wide: 10 spacings in the scene. At each spacing the slab is 6 spacings thick and the levels are whole layers.
    std::vector<std::vector<std::string>> sizes = {{}};
    if (!settings.quick) {
        sizes.push_back({"fluid.spacing=0.0333333333", "fluid.box.max=0.7,0.7,0.2", "fluid.blocks.0.max=0.7,0.2,0.2",
                         "fluid.blocks.1.max=0.2,0.433333333,0.2", "fluid.blocks.2.max=0.7,0.366666667,0.2"});
        sizes.push_back({"fluid.spacing=0.01", "fluid.box.max=0.7,0.7,0.06", "fluid.blocks.0.max=0.7,0.2,0.06",
                         "fluid.blocks.1.max=0.2,0.44,0.06", "fluid.blocks.2.max=0.7,0.36,0.06"});
    }
    constexpr double kCorner = 0.559;
    std::vector<Finding> findings;
    Plot plot{"U-tube", "time, s", "level of the right arm over its start", {}};
    std::optional<Outcome> outcome;
    for (const std::vector<std::string>& size : sizes) {
        CaseSettings with = settings;
        with.assignments.insert(with.assignments.begin(), size.begin(), size.end());
        Result<Trial> trial = Trial::open("u_tube", with);
        if (!trial) return trial.error();
        const FluidParams p = trial->params();
        const BlockParams &channel = p.blocks[0], &left = p.blocks[1], &right = p.blocks[2];
        const double arm = double{left.max.x - left.min.x}, between = double{right.min.x - left.max.x};
        const double start = 0.5 * double{left.max.y - right.max.y};  // of each level over that at rest
        const double height = 0.5 * double{left.max.y + right.max.y} - double{channel.max.y};
        const double length = 2 * height + between + 2 * kCorner * arm, g = glm::length(p.gravity);
        const double w = std::sqrt(2 * g / length), period = 2 * std::numbers::pi / w;
        // Water that leaves one arm arrives in the other, `arm + between` away: the centre of mass moves by level * arm * (arm + between)
        // over the area of the slab's water.
        const double area = double{channel.max.x - channel.min.x} * double{channel.max.y - channel.min.y} + 2 * arm * height;
        const double middle = 0.5 * double{channel.max.x + channel.min.x}, lever = arm * (arm + between) / area;
        const std::string arms = fmt::format("arms {:.0f} spacings wide", arm / double{p.spacing});
        Curve measured{arms, true, {}}, reference{"2 pi sqrt(L / 2 g)", true, {}};
        std::vector<glm::dvec2> fitted;
        const bool done = trial->run(1.0 / 60, [&] {
            double sum = 0, count = 0;
            for (const vec4& x : trial->particles().position) {
                sum += double{x.x};
                count += 1;
            }
            const double t = trial->time(), level = (sum / std::max(count, 1.0) - middle) / lever;
            measured.points.emplace_back(t, level / start);
            reference.points.emplace_back(t, -std::cos(w * t));
            if (t > 0.25 * period) fitted.emplace_back(t, level);
        });
        if (!done) return trial->outcome({}, {});
        if (fitted.size() < 5) return badInput("duration is too short for the case u_tube: set it to more than half a period");
        const Oscillation o = fitOscillation(fitted, w);
        const double found = 2 * std::numbers::pi / o.frequency, apart = 2 * std::abs(o.offset);
        findings.push_back({"period, " + arms, "s", found, period, std::abs(found / period - 1), toleranceOf(settings)});
        findings.push_back(
            {"levels at rest, difference over that at the start, " + arms, "m", apart, 0, apart / (2 * start), toleranceOf(settings)});
        findings.push_back({"decay over the frequency, " + arms, "", o.decay / o.frequency, 0, std::abs(o.decay / o.frequency), {}});
        plot.curves.push_back(measured);
        if (!outcome) {
            plot.curves.push_back(reference);
            Result<Outcome> cost = trial->outcome({}, {});  // of the scene's own size
            if (!cost) return cost.error();
            outcome = std::move(*cost);
        }
    }
    outcome->findings = findings;
    outcome->plot = plot;
    return *outcome;
}

}  // namespace rivulet
