#include "fluid/validate/trial.h"

#include <fmt/format.h>

#include <algorithm>

namespace rivulet {

Result<Trial> Trial::open(const char* name, const CaseSettings& settings) {
    std::vector<std::string> assignments = {"fluid.method=" + settings.method};
    if (settings.quick) {
        const std::string_view all = physicsCases().find(name)->quick;
        for (size_t at = 0; at < all.size();) {
            const size_t end = std::min(all.find("; ", at), all.size());
            assignments.emplace_back(all.substr(at, end - at));
            at = end + 2;
        }
    }
    assignments.insert(assignments.end(), settings.assignments.begin(), settings.assignments.end());
    Result<SceneFile> scene = loadScene(fmt::format("cases/{}.json", name), assignments);
    if (!scene) return scene.error();
    Result<std::unique_ptr<Session>> session = Session::create(std::move(*scene), *settings.device, settings.log);
    if (!session) return session.error();
    Trial trial;
    trial.session_ = std::move(*session);
    trial.goOn_ = settings.goOn;
    return trial;
}

Status Trial::setVelocities(const std::function<dvec3(const dvec3&)>& at) {
    return changeParticles(world(), [&](vec4& x, vec4& v) { v = vec4(vec3(at(dvec3(x))), v.w); });
}

Status Trial::keep(const std::function<bool(const dvec3&)>& where) {
    return changeParticles(world(), [&](vec4& x, vec4&) {
        if (!where(dvec3(x))) x.w = -1;
    });
}

Status changeParticles(FluidWorld& w, const std::function<void(vec4& position, vec4& velocity)>& each) {
    if (Status can = w.savable(); !can) return can;
    WorldState state;
    w.save(state);
    const size_t slots = w.particles().slots;
    Result<std::vector<vec4>> x = state.take<vec4>("particles.position", slots), v = state.take<vec4>("particles.velocity", slots);
    if (!x) return x.error();
    if (!v) return v.error();
    for (size_t i = 0; i < slots; ++i)
        if (!((*x)[i].w < 0)) each((*x)[i], (*v)[i]);
    WorldState changed;
    for (const auto& [name, bytes] : state.sections()) changed.putBytes(name, bytes);
    changed.put<vec4>("particles.position", *x);
    changed.put<vec4>("particles.velocity", *v);
    return w.restore(changed);
}

double amplitudeOf(const HostParticles& particles, const std::function<dvec3(const dvec3&)>& mode) {
    double along = 0, whole = 0;
    for (size_t i = 0; i < particles.position.size(); ++i) {
        const dvec3 m = mode(dvec3(particles.position[i]));
        along += glm::dot(m, dvec3(particles.velocity[i]));
        whole += glm::dot(m, m);
    }
    return whole > 0 ? along / whole : 0;
}

std::vector<double> zerosOf(std::span<const glm::dvec2> curve) {
    std::vector<double> zeros;
    for (size_t i = 1; i < curve.size(); ++i) {
        const glm::dvec2 a = curve[i - 1], c = curve[i];
        if (a.y * c.y <= 0 && a.y != c.y) zeros.push_back(a.x + (c.x - a.x) * a.y / (a.y - c.y));
    }
    return zeros;
}

bool Trial::run(double frame, const std::function<void()>& each, double until) {
    const double duration = scene().duration, end = std::min(duration, until);
    while (time() < end - 1e-3 * frame) {
        if (!goOn_(time() / duration)) return false;
        if (world().device().health().state != DeviceHealth::works) return false;  // runCase() reports it
        const double before = time();
        wall_ += 1e-3 * session_->step(std::min(frame, end - time()), true);
        if (world().interrupted()) return false;
        if (stepped_ = world().lastStep(); !stepped_) return false;
        steps_ += world().lastSubsteps();
        awake_ += static_cast<double>(world().lastSubsteps()) * world().stats().particles;
        compression_ += world().stats().avgCompression * (time() - before);
        each();
    }
    return true;
}

Result<Outcome> Trial::outcome(std::vector<Finding> findings, Plot plot) const {
    if (!stepped_) return stepped_.error();
    const FluidWorld& w = session_->world();
    Outcome o;
    o.findings = std::move(findings);
    o.plot = std::move(plot);
    o.method = w.params().method;
    o.spacing = w.params().spacing;
    o.particles = w.stats().particles;
    if (w.time() > 0) {
        o.wallPerSecond = wall_ / w.time();
        o.stepsPerSecond = static_cast<double>(steps_) / w.time();
        const double share = w.params().sleep.on && awake_ > 0 ? std::min(w.stats().stepped / awake_, 1.0) : 1.0;
        o.sweepsPerSecond = share * static_cast<double>(w.stats().sweeps) / w.time();
    }
    o.fastest = double{w.fastestFall()};
    o.compression = w.time() > 0 ? compression_ / w.time() : 0;
    return o;
}

}  // namespace rivulet
