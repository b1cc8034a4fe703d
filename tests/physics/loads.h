// The momentum of a world's fluid against the impulses that its probes measure: for tests on any device.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "fluid/sim/world/fluid_world.h"

namespace rivulet::test {

// kg m/s, of the fluid, without the samples on bodies.
inline dvec3 momentumOf(const FluidWorld& world, double* mass = nullptr) {
    const ParticleView view = world.particles();
    const std::vector<vec4> x = world.device().readAll<vec4>(*view.position, view.slots),
                            v = world.device().readAll<vec4>(*view.velocity, view.slots);
    dvec3 sum(0.0);
    double count = 0;
    for (size_t i = 0; i < x.size(); ++i) {
        if (x[i].w < 0) continue;
        sum += dvec3(vec3(v[i]));
        ++count;
    }
    if (mass != nullptr) *mass = count * double{view.mass};
    return sum * double{view.mass};
}

inline void arrive(FluidWorld& world) {
    world.device().finish();
    world.device().poll();
}

// Probes of everything that a world may have; each impulse counts once.
inline std::vector<ProbeParams> probesOfAll(const Solids& solids) {
    std::vector<ProbeParams> all = {{.name = "box"}};
    if (!solids.planes.empty()) all.push_back({.name = "planes", .on = "plane"});
    if (solids.field != nullptr) all.push_back({.name = "still", .on = "still"});
    if (!solids.rigid.empty()) all.push_back({.name = "rigid", .on = "rigid"});
    if (!solids.deforming.empty()) all.push_back({.name = "deforming", .on = "deforming"});
    if (!solids.bodies.empty()) all.push_back({.name = "bodies", .on = "body"});
    return all;
}

// Of a run: what the momentum balance misses over any window, as a share of `scale`, and the impulse of each probe at the end.
struct Balance {
    double missing = 0, scale = 0;  // 1; kg m/s: the largest change of momentum that gravity, walls or bodies make within the run
    std::vector<dvec3> impulses = {};
    uint32_t limited = 0;
};

// Runs `frames` of 1/60 s. `inputs`: of each frame.
inline Balance balanceOf(FluidWorld& world, int frames, const std::function<FluidInputs(int)>& inputs = {}) {
    Balance b;
    double mass = 0;
    const dvec3 start = momentumOf(world, &mass);
    dvec3 least(0.0), most(0.0);
    for (int k = 0; k < frames; ++k) {
        world.step(inputs ? inputs(k) : FluidInputs{}, 1.0 / 60);
        arrive(world);
        const ProbeFrame& loads = world.stats().loads;
        EXPECT_EQ(loads.time, world.time());
        const dvec3 now = momentumOf(world), weight = dvec3(world.params().gravity) * mass * world.time();
        dvec3 missing = now - start - weight;
        b.impulses.clear();
        for (const ProbeReading& p : loads.probes) {
            missing += p.impulse;
            b.impulses.push_back(p.impulse);
            b.scale = std::max(b.scale, glm::length(p.impulse));
        }
        b.scale = std::max({b.scale, glm::length(now - start), glm::length(weight)});
        b.limited += world.stats().speedLimited;
        least = glm::min(least, missing);
        most = glm::max(most, missing);
    }
    b.missing = glm::length(most - least) / b.scale;
    return b;
}

}  // namespace rivulet::test
