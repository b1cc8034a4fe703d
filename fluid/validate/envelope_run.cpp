#include "fluid/validate/envelope_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace rivulet {

namespace {

constexpr double kLongestFixedStep = 0.0999;  // s, as fluid.fixedStep's range says

double energyOf(const FluidWorld& world, const vec3& gravity) {
    const HostParticles all = readParticles(world);
    double sum = 0;
    for (size_t i = 0; i < all.position.size(); ++i) {
        const dvec3 v(all.velocity[i]), x(all.position[i]);
        sum += double{all.mass[i]} * (0.5 * glm::dot(v, v) - glm::dot(dvec3(gravity), x));
    }
    return sum;
}

void look(const FluidWorld& world, Seen& s) {
    const FluidStats& f = world.stats();
    s.energy = f.kinetic + f.potential;
    s.mostEnergy = std::max(s.mostEnergy, s.energy);
    s.compression = f.avgCompression;
    s.mostCompression = std::max(s.mostCompression, f.avgCompression);
    s.mostSpeed = std::max(s.mostSpeed, f.maxSpeed);
    s.particles = f.particles;
    s.lost = f.lost;
    s.finite = s.finite && f.nan == 0 && std::isfinite(s.energy) && std::isfinite(f.maxSpeed) && std::isfinite(f.avgCompression);
    s.steps += static_cast<uint64_t>(world.lastSubsteps());
    s.time = world.time();
    s.notices = f.limited;
}

}  // namespace

Result<SceneFile> stabilityScene(const char* name, const std::vector<std::string>& assignments) {
    return loadScene(fmt::format("stability/{}.json", name), assignments);
}

Result<Seen> watch(const EnvelopeSettings& settings, const StabilityRun& run) {
    std::vector<std::string> assignments = run.assignments;
    assignments.push_back(fmt::format("fluid.limits={}", run.limits));
    const bool fixed = run.limits && !run.asFrames;
    const double frame = fixed ? double{static_cast<float>(std::min(run.frame, kLongestFixedStep))} : run.frame;
    if (fixed) assignments.push_back(fmt::format("fluid.fixedStep={}", frame));
    Result<SceneFile> scene = stabilityScene(run.scene, assignments);
    if (!scene) return scene.error();
    const double seconds = run.seconds > 0 ? run.seconds : double{scene->duration};
    Result<std::unique_ptr<Session>> made = Session::create(std::move(*scene), *settings.device, settings.log);
    if (!made) return made.error();
    Session& session = **made;
    if (run.prepare)
        if (Status ready = run.prepare(session); !ready) return ready.error();
    Seen seen;
    seen.start = seen.energy = seen.mostEnergy = energyOf(session.world(), session.world().params().gravity);
    seen.particles = session.world().stats().particles;
    double asked = 0;
    for (int k = 0; asked < seconds * (1 - 1e-9) && !seen.failed; ++k) {
        if (!settings.goOn()) return failed("the stability envelope was stopped");
        const double now = run.frameOf ? run.frameOf(k) : frame;
        session.step(now, true);
        if (const Status stepped = session.world().lastStep(); !stepped && !session.world().interrupted()) return stepped.error();
        asked += now;
        look(session.world(), seen);
        if (run.each) run.each(session);
        seen.failed = !seen.whole() || (run.fails && run.fails(seen));
    }
    if (run.verdict && !seen.failed) seen.failed = run.verdict(session);
    return seen;
}

Result<Threshold> findThreshold(double first, double least, double most, const std::function<Result<bool>(double)>& fails) {
    double holds = 0, breaks = 0;
    for (double at = first;;) {
        const Result<bool> bad = fails(at);
        if (!bad) return bad.error();
        (*bad ? breaks : holds) = at;
        if (holds > 0 && breaks > 0) break;
        if (!*bad && at >= most) return Threshold{{}, at};
        if (*bad && at <= least) return Threshold{at, at};
        at = *bad ? std::max(at / 2, least) : std::min(2 * at, most);
    }
    while (breaks / holds > 1.1) {
        const double at = std::sqrt(breaks * holds);
        const Result<bool> bad = fails(at);
        if (!bad) return bad.error();
        (*bad ? breaks : holds) = at;
    }
    return Threshold{breaks, breaks};
}

std::function<bool(const Seen&)> gainsEnergy(double more) {
    return [more](const Seen& s) { return s.energy > 1.1 * (s.start + more); };
}

std::function<bool(const Seen&)> gainsEnergyOrIsSqueezed() {
    return [gains = gainsEnergy()](const Seen& s) { return gains(s) || s.compression > 0.1; };
}

Result<EnvelopeFinding> sweep(const EnvelopeSettings& settings, const Sweep& s) {
    const double least = s.least > 0 ? s.least : s.predicted / 64, most = s.most > 0 ? s.most : s.predicted * 64;
    const Result<Threshold> found = findThreshold(s.predicted, least, most, [&](double at) {
        const Result<Seen> seen = watch(settings, s.run(at, false));
        return seen ? Result<bool>(seen->failed) : Result<bool>(seen.error());
    });
    if (!found) return found.error();
    const double asked = s.ask > 0 ? s.ask : std::min({found->at ? 2 * *found->at : found->reached, most, s.askable});
    StabilityRun run = s.run(asked, true);
    run.limits = true;
    const Result<Seen> seen = watch(settings, run);
    if (!seen) return seen.error();
    return EnvelopeFinding{
        .row = s.row,
        .method = s.method,
        .what = s.what,
        .unit = s.unit,
        .predicted = s.predicted,
        .measured = found->at,
        .reached = found->reached,
        .criterion = s.criterion,
        .limited = {asked, seen->finite, !seen->failed, seen->lost == 0, seen->steps, fmt::format("{}", fmt::join(seen->notices, "; "))}};
}

Sweep stepSweep(const char* row, std::string method, std::string what, double predicted, std::string criterion, StabilityRun run) {
    return {.row = row,
            .method = std::move(method),
            .what = std::move(what),
            .unit = "s",
            .predicted = predicted,
            .askable = kLongestFixedStep,
            .criterion = std::move(criterion),
            .run = [run = std::move(run)](double at, bool) {
                StabilityRun now = run;
                now.frame = at;
                return now;
            }};
}

Result<std::vector<EnvelopeFinding>> sweepAll(const EnvelopeSettings& settings, const std::vector<Sweep>& sweeps) {
    std::vector<EnvelopeFinding> all;
    for (const Sweep& s : sweeps) {
        Result<EnvelopeFinding> found = sweep(settings, s);
        if (!found) return found.error();
        all.push_back(std::move(*found));
    }
    return all;
}

}  // namespace rivulet
