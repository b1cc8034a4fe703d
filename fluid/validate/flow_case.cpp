#include "fluid/validate/flow_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

namespace rivulet {

bool Under::step(SurfaceFlow& flow, const SurfaceFlowInputs& inputs, double seconds) {
    const auto before = std::chrono::steady_clock::now();
    const Status done = flow.step(inputs, seconds);
    wall += std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    simulated += seconds;
    stopped = stopped || !done || !settings.goOn(share);
    return !stopped;
}

void Under::found(std::string what, const char* unit, double measured, double reference, double error, std::optional<double> tolerance) {
    outcome.findings.push_back({std::move(what), unit, measured, reference, error, tolerance});
}

Result<Outcome> runParts(Under& u, std::span<const FlowPart> parts) {
    for (const auto& [share, part] : parts) {
        if (Status done = part(); !done) return done.error();
        if (u.stopped) {
            u.outcome.findings.clear();
            return u.outcome;
        }
        u.share = share;
    }
    u.outcome.wallPerSecond = u.wall / std::max(u.simulated, 1.0e-9);
    u.outcome.stepsPerSecond = 1 / kStep;
    return u.outcome;
}

double furmidgeVolume(const SurfaceFlowParams& p) {
    // rho g V = k w gamma (cos receding - cos advancing), w the width of a cap with the mean contact angle.
    const double rad = std::numbers::pi / 180, advancing = double{p.advancing} * rad, receding = double{p.receding} * rad;
    const double h = std::tan(0.25 * (advancing + receding));
    const double w = 2 * std::cbrt(6 / (std::numbers::pi * h * (3 + h * h)));  // over V^(1/3)
    const double force = double{p.hold} * w * double{p.surfaceTension} * (std::cos(receding) - std::cos(advancing));
    return std::pow(force / (double{p.density} * kGravity), 1.5);
}

std::vector<PathCase> pathCases() {
    // Bumps of a tenth of the radius, so that paths can differ.
    Shape ball = ballShape(0.05F, 48);
    for (vec3& x : ball.positions) x *= 1.0F + 0.06F * std::sin(90 * x.x + 1.0F) * std::sin(110 * x.y) * std::sin(80 * x.z + 2.0F);
    return {{"bumpy ball", ball, vec3(0.012F, 0.06F, 0.014F), -0.02F},
            {"cylinder", coneShape(0.03F, 0.03F, 0.1F, 48, 40), vec3(0.02F, 0.095F, 0.03F), 0.01F},
            {"cone", coneShape(0.06F, 0.02F, 0.1F, 48, 40), vec3(0.012F, 0.095F, 0.016F), 0.01F}};
}

void breathe(Under& u, SurfaceFlow& flow, const Shape& rest, uint32_t picolitres, std::optional<double> tolerance) {
    std::vector<vec3> shape = rest.positions;
    const double duration = u.settings.quick ? 10 : 60;
    uint64_t released = 0;
    for (int k = 0; k < static_cast<int>(duration / kStep); ++k) {
        const double t = k * kStep;
        for (const float side : {-1.0F, 1.0F})
            if (k % 6 == 0) flow.add(nearestPoint(flow.mesh(), vec3(0.02F * side, 0.045F, 0.035F)), picolitres);
        for (size_t i = 0; i < shape.size(); ++i)
            shape[i] = rest.positions[i] * (1.0F + 0.05F * static_cast<float>(std::sin(3 * t + 40 * double{rest.positions[i].x})));
        const vec3 wind(static_cast<float>(std::fmod(t, 10) > 8 ? 6 : 0), 0, 0);
        if (!u.step(flow, {.wind = wind, .positions = shape})) return;
        for (const LeftDrop& d : flow.takeLeft()) released += d.picolitres;
    }
    const SurfaceFlow::Ledger l = flow.ledger();
    const auto there = static_cast<double>(l.drops + l.film + released + l.evaporated + l.refused), added = static_cast<double>(l.added);
    u.found(fmt::format("ledger after {:.0f} s: {} merges, {:.0f} % let go or ran over an edge, {:.0f} % dried", duration, l.merges,
                        100.0 * static_cast<double>(released) / added, 100.0 * static_cast<double>(l.evaporated) / added),
            "pl", there, added, std::abs(there - added) / added, tolerance);
}

}  // namespace rivulet
