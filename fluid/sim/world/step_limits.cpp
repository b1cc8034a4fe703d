#include "fluid/sim/world/step_limits.h"

#include <algorithm>
#include <cmath>

#include "fluid/sim/sources/block.h"

namespace rivulet {

float StepLimits::fastestFall(const Inputs& in) const {
    const float g = glm::length(in.gravity);
    float fastest = 0.0F;
    const auto add = [&](const BlockParams& b) {
        float fall = 0.0F;
        if (g > 0.0F) {
            const vec3 down = in.gravity / g;
            for (int k = 0; k < 3; ++k)
                fall += std::abs(down[k]) * (down[k] < 0 ? b.max[k] - in.params.box.min[k] : in.params.box.max[k] - b.min[k]);
        }
        fastest = std::max(fastest, std::sqrt(2.0F * g * std::max(fall, 0.0F)) + fastestOf(b));
    };
    for (const BlockParams& b : in.params.blocks) add(b);
    if (in.placed != nullptr) add(*in.placed);
    for (const Emitter& e : in.emitters) {
        float fall = 0.0F;
        for (int k = 0; k < 3; ++k)
            fall += std::abs(in.gravity[k]) *
                    (in.gravity[k] < 0 ? e.params.position[k] - in.params.box.min[k] : in.params.box.max[k] - e.params.position[k]);
        fastest = std::max(fastest, std::sqrt(2.0F * std::max(fall, 0.0F) + in.fastestSource * in.fastestSource));
    }
    fastest = std::max(fastest, fastestWall);
    // The speed that a force's pressure gives at a surface: a drop of wcsph without it would be as soft as its slow motion allows.
    fastest = std::max(fastest, std::sqrt(in.forces.pressure(in.params) / in.params.restDensity));
    // Still water without gravity has no speed of its own: the length it could be pushed over in a tenth of a second.
    return std::max(fastest, 10.0F * in.params.spacing);
}

float StepLimits::fastestPossible(const Inputs& in) const {
    const FluidParams& params = in.params;
    const float fall = std::sqrt(2.0F * glm::length(in.gravity) * glm::length(params.box.max - params.box.min));
    const float thrown = in.atStart ? in.fastestBody : 0.0F;  // later it may be what has gone wrong
    const float most = 10.0F * (std::max({fall, fastestStart, in.fastestSource, thrown, in.forces.fastest(params)}) + fastestFall(in));
    return std::max(most, 2.0F * in.method.soundSpeed(params, fastestFall(in)));
}

StepLimit StepLimits::longest(const Inputs& in, const Measured& measured, double frameSeconds) const {
    const FluidParams& params = in.params;
    if (!params.limits) return {frameSeconds, "the frame"};
    const StepParams& step = measured.step;
    const double hs = 0.5 * step.h, g = glm::length(in.gravity);
    const float fall = fastestFall(in);
    const double c0 = in.method.soundSpeed(params, fall);
    // Speeds may have grown by gravity since they were measured.
    const double fastest = std::max({measured.maxSpeed, double{measured.fastestWall}, double{in.fastestSource}, double{in.fastestBody}}) +
                           g * (measured.late < 1.0e-9 ? frameSeconds : measured.late + frameSeconds);
    StepLimit limit{frameSeconds, "the frame"};
    const auto atMost = [&limit](double dt, const char* why) {
        if (dt < limit.dt) limit = {dt, why};
    };
    const Method::StepLimit own = in.method.stepLimit(params, fall);
    if (c0 > 0) atMost(params.cfl * hs / (c0 + fastest), "the speed of sound (fluid.cfl)");
    atMost(double{own.reach} * params.spacing / std::max(fastest, 1.0e-9), "the speed of the fastest particle or wall");
    atMost(own.longest, own.why);
    const ForceLimitInputs inputs{params, step.h, methodOf(params).doesViscosity, measured.mostViscous, step.artificial};
    for (const ForceRow& f : forces().rows) {
        if (f.limit == nullptr) continue;
        const StepLimit forced = f.limit(inputs);
        atMost(forced.dt, forced.why);
    }
    if (g > 0) atMost(0.25 * std::sqrt(hs / g), "gravity");
    return limit;
}

}  // namespace rivulet
