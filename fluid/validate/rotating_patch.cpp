// A square of water turns without gravity (Colagrossi 2005, Dottorato di Ricerca, Universita La Sapienza, Roma; Le Touze et al. 2013, Int.
// J. Numer. Methods Fluids 73:660-691, doi:10.1002/fld.3819). Its pressure is negative: corners grow into arms, and the water stays in one
// piece and keeps its area. Without negative pressure each particle flies straight ahead.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "fluid/validate/clusters.h"
#include "fluid/validate/trial.h"

namespace rivulet {

Result<Outcome> runRotatingPatch(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("rotating_patch", settings);
    if (!trial) return trial.error();
    const FluidParams p = trial->params();
    const double turn = glm::length(p.blocks[0].spin), spacing = p.spacing;
    const double period = double{p.box.max.z - p.box.min.z};  // along z
    const auto volume = [&](const HostParticles& all) { return coveredVolume(all.position, 0.75 * spacing, 0.25 * spacing, period); };
    const double before = volume(trial->particles());
    std::vector<Finding> findings;
    Plot plot{"Rotating square patch", "x, m", "y, m", {}};
    for (const double at : {1.0, 2.0}) {
        if (!trial->run(
                1.0 / 60, [] {}, at / turn))
            return trial->outcome({}, {});
        const HostParticles all = trial->particles();
        const double share = largestCluster(all.position, 1.5 * spacing, period), area = volume(all) / before;
        findings.push_back(
            {fmt::format("share of the largest piece, omega t = {:.0f}", at), "", share, 1, std::abs(share - 1), toleranceOf(settings)});
        findings.push_back(
            {fmt::format("area over that at the start, omega t = {:.0f}", at), "", area, 1, std::abs(area - 1), toleranceOf(settings)});
        Curve points{fmt::format("omega t = {:.0f}", at), false, {}};
        for (const vec4& x : all.position)
            if (double{x.z} < spacing) points.points.emplace_back(double{x.x}, double{x.y});
        plot.curves.push_back(points);
    }
    return trial->outcome(findings, plot);
}

}  // namespace rivulet
