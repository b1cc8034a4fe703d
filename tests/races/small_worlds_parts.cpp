#include "tests/races/small_worlds_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fluid/sim/world/host_particles.h"

namespace rivulet::races {

FluidParams column(const char* method) {
    FluidParams p;
    p.method = method;
    p.spacing = kSpacing;
    p.supportSpacings = 2.3F;
    p.box.max = vec3(0.5F, 0.4F, 0.3F);
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.3F), .velocity = vec3(0.5F, 0.0F, 0.1F)}};
    p.soundSpeed = 15;
    p.cfl = 0.8F;
    p.pbf.minSubsteps = p.dfsph.minSubsteps = 1;
    p.dfsph.maxIterations = 3;
    return p;
}

std::unique_ptr<FluidWorld> make(Device& device, const FluidParams& p, const Solids& solids, const Sources& sources) {
    auto world = FluidWorld::create(device, p, solids, {}, sources);
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    return world ? std::move(*world) : nullptr;
}

void step(FluidWorld& world, const FluidInputs& inputs, double seconds) {
    world.step(inputs, seconds);
    world.device().finish();
    world.device().poll();
}

void addParticles(FluidWorld& world, std::vector<float>& to) {
    const HostParticles all = readParticles(world);
    std::vector<size_t> order(all.id.size());
    for (size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return all.id[a] < all.id[b]; });
    to.push_back(static_cast<float>(order.size()));
    for (const size_t k : order) {
        add(to, all.position[k]);
        add(to, vec3(all.velocity[k]));
        for (const std::vector<vec4>& attribute : all.attributes) add(to, attribute[k]);
    }
    for (const size_t k : order)
        if (!std::isfinite(all.position[k].x)) ADD_FAILURE() << "a particle is nowhere";
}
void addMeans(std::span<const vec4> all, std::vector<float>& to) {
    dvec3 mean(0.0), square(0.0);
    double count = 0;
    for (const vec4& x : all) {
        if (x.w < 0) continue;
        mean += dvec3(x);
        square += dvec3(x) * dvec3(x);
        count += 1;
    }
    add(to, vec3(mean / std::max(count, 1.0)));
    add(to, vec3(square / std::max(count, 1.0)));
    to.push_back(static_cast<float>(0.001 * count));
}
void addMeans(FluidWorld& world, std::vector<float>& to) {
    const HostParticles all = readParticles(world);
    addMeans(all.position, to);
    addMeans(all.velocity, to);
}

}  // namespace rivulet::races
