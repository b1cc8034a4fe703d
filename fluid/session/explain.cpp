#include "fluid/session/explain.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace rivulet {

namespace {

// Parts that a scene may not need, and the sign of that: no kernel has a path that begins with one of `paths` (separated by '|'), or none
// was compiled with `define`.
struct Part {
    const char* name;
    const char* why;     // it is left out
    const char* paths;   // "" = see `define`
    const char* define;  // "" = see `paths`
};
constexpr Part kParts[] = {
    {"walls", "the box is periodic along all axes, and there are no colliders", "fluid/solids/near_walls|fluid/wall", ""},
    {"collision with meshes", "no collider has triangles", "fluid/solids/collide", ""},
    {"moving meshes", "no collider moves or deforms", "fluid/solids/near_walls_moving|fluid/forces/wall_friction_moving", ""},
    {"floating bodies", "the scene has none",
     "fluid/solids/place_samples|fluid/solids/push_samples|fluid/solids/sum_loads|fluid/solids/advance_bodies|"
     "fluid/solids/advance_touching|fluid/solids/index_samples",
     ""},
    {"masses and densities per particle", "there is one liquid and no body", "", "MATTER"},
    {"periodic axes", "no axis of the box is periodic", "fluid/world/wrap", "PERIODIC"},
    {"surface tension", "fluid.forces.tension and adhesion are 0", "fluid/forces/cohesion", ""},
    {"thesis tension", "fluid.forces.thesisTension is 0", "fluid/forces/tension_thesis", ""},
    {"pairwise viscosity", "fluid.forces.viscosity has no effect, or is part of the method", "fluid/forces/viscosity|fluid/viscous", ""},
    {"vorticity confinement", "fluid.forces.vorticity is 0", "fluid/forces/vorticity|fluid/forces/confinement", ""},
    {"air drag", "fluid.forces.airDrag is 0", "fluid/forces/air", ""},
    {"normals of the surface", "fluid.forces.normals is none", "fluid/forces/normals", ""},
    {"ellipsoids about particles", "fluid.ellipsoids is false, and look draws spheres", "fluid/surface/ellipsoids", ""},
    {"emitters", "the scene has none", "fluid/sources/emit", ""},
    {"sinks", "the scene has none", "fluid/sources/drain", ""},
    {"dry volumes", "the scene has none", "fluid/sources/dry", ""},
    {"dyes and attributes", "all particles have the same colour, and fluid.attributes is empty", "fluid/world/gather_vectors", ""},
    {"positions between steps", "fluid.fixedStep is 0", "fluid/world/blend", ""},
};

bool beginsWithAny(const std::string& text, std::string_view paths) {
    for (size_t at = 0; at < paths.size();) {
        const size_t end = std::min(paths.find('|', at), paths.size());
        if (text.starts_with(paths.substr(at, end - at))) return true;
        at = end + 1;
    }
    return false;
}

bool isThere(const Part& part, const std::vector<std::string>& kernels) {
    return std::any_of(kernels.begin(), kernels.end(), [&](const std::string& k) {
        return beginsWithAny(k, part.paths) || (*part.define != '\0' && k.find(fmt::format(";{}=", part.define)) != std::string::npos);
    });
}

}  // namespace

std::string explain(const Session& session, const RunStats& stats) {
    const FluidWorld& world = session.world();
    const Device& device = world.device();
    const FluidParams& p = world.params();
    std::string text = fmt::format("chosen\n  {}: {}{}{}\n", backendName(device.backend()), device.info().name,
                                   device.info().driver.empty() ? "" : ", ", device.info().driver);
    text += fmt::format("  method {}, {} particles {} m apart, with a support radius of {} spacings\n", p.method, world.stats().particles,
                        p.spacing, p.supportSpacings);
    if (session.budget()) text += session.budget()->report();

    std::vector<std::string> kernels = device.kernels();
    std::sort(kernels.begin(), kernels.end());
    text += "left out\n";
    for (const Part& part : kParts)
        if (!isThere(part, kernels)) text += fmt::format("  {}: {}\n", part.name, part.why);

    text += fmt::format("compiled, {} kernels{}\n", kernels.size(),
                        session.budget() ? ", including those of methods that the budget tried" : "");
    for (std::string k : kernels) {
        std::replace(k.begin(), k.end(), ';', ' ');
        for (size_t at = 0; (at = k.find("=1", at)) != std::string::npos;) {
            const bool all = at + 2 == k.size() || k[at + 2] == ' ';  // LOCAL_SIZE=128 stays
            if (all) k.erase(at, 2);
            if (!all) at += 2;
        }
        text += "  " + k + '\n';
    }

    text += stats.frames > 0 ? fmt::format("costs, ms per frame, median of {}\n", stats.frames) : "costs: no frame has run yet\n";
    std::vector<std::pair<double, std::string>> costs;
    for (const auto& [name, spread] : stats.passes) costs.emplace_back(spread.median, name);
    std::sort(costs.rbegin(), costs.rend());
    for (const auto& [ms, name] : costs) text += fmt::format("  {:>9.3f}  {}\n", ms, name);
    if (stats.frames > 0) text += fmt::format("  {:>9.3f}  simulation, in all\n", stats.simulateMs.median);
    return text;
}

}  // namespace rivulet
