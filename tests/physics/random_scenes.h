// Random scenes for the tests of relations between pairs of worlds (relations.h). In the environment, RIVULET_SEED sets the seed of the
// first round, RIVULET_ROUNDS the number of rounds.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "fluid/sim/world/host_particles.h"

namespace rivulet::relations {

// Random numbers that depend on the seed alone: the distributions of the standard library differ between libraries.
class Dice {
  public:
    explicit Dice(uint32_t seed) : engine_(seed) {}
    int whole(int from, int to) { return from + static_cast<int>(engine_() % static_cast<uint32_t>(to - from + 1)); }  // both included
    float real(float from, float to) { return from + (to - from) * static_cast<float>(engine_() >> 8U) / 16777216.0F; }
    // In braces: evaluated from left to right.
    vec3 inCube(float half) { return {real(-half, half), real(-half, half), real(-half, half)}; }

  private:
    std::mt19937 engine_;
};

inline uint32_t fromEnvironment(const char* name, uint32_t otherwise) {
    const char* text = std::getenv(name);
    return text != nullptr && *text != 0 ? static_cast<uint32_t>(std::strtoul(text, nullptr, 10)) : otherwise;
}

// Calls `round` with the dice of each round; a failure names the seed. `rounds`: without RIVULET_ROUNDS.
template <class Round>
void eachRound(uint32_t rounds, Round&& round) {
    const uint32_t first = fromEnvironment("RIVULET_SEED", 1);
    rounds = fromEnvironment("RIVULET_ROUNDS", rounds);
    for (uint32_t k = 0; k < rounds && !testing::Test::IsSkipped(); ++k) {
        SCOPED_TRACE(fmt::format("RIVULET_SEED={} RIVULET_ROUNDS=1 runs this round alone", first + k));
        Dice dice(first + k);
        round(dice);
    }
}

struct RandomScene {
    FluidParams params;
    std::vector<vec3> x, v;  // m, m/s, of each particle; its index is its id
    double dt = 1.0 / 512;   // s, of a step
    int steps = 51;          // 0.1 s
    bool oneStep = true;     // required of each frame
};

constexpr float kSpacing = 0.0625F;  // m: places on the lattice, and cells of two spacings, are exact

inline const vec3 kDesignSpeed(6.0F, 0.0F, 0.0F);  // m/s

// What a relation requires of its scene.
struct Wanted {
    bvec3 periodic{false};
    bool gravity = true;
    int margin = 0;            // spacings, between blocks and box
    bvec3 marginOn{true};      // the axes that have the margin
    int least = 8, most = 16;  // spacings, the edges of the box without margins; even
};

// Settings with which every frame is one step, and the solver of dfsph has a fixed number of iterations: the answer then does not depend on
// the speed of the fastest particle.
inline FluidParams settings(const std::string& method) {
    FluidParams p;
    p.method = method;
    p.spacing = kSpacing;
    p.viscosity = 0;
    p.soundSpeed = 15;
    p.cfl = 0.8F;
    p.pbf.reach = p.dfsph.reach = 1;
    p.pbf.minSubsteps = p.dfsph.minSubsteps = 1;
    p.dfsph.tolerance = 1.0e-6F;
    p.dfsph.maxIterations = 4;
    return p;
}

// One to three blocks in a box. Blocks are on the lattice, each in its own slab of the box; particles have jitter. Gravity is along an
// axis. The methods derive sound and stiffness from BlockParams::velocity; it is the same in all scenes, above the speeds of the particles.
// open() writes the velocities themselves.
inline RandomScene randomScene(const std::string& method, Dice& dice, const Wanted& wanted = {}) {
    RandomScene s;
    s.params = settings(method);
    FluidParams& p = s.params;
    p.box.periodicX = wanted.periodic.x;
    p.box.periodicY = wanted.periodic.y;
    p.box.periodicZ = wanted.periodic.z;
    p.gravity = vec3(0.0F);
    if (wanted.gravity) p.gravity[dice.whole(0, 2)] = dice.real(2, 15) * (dice.whole(0, 1) == 0 ? -1.0F : 1.0F);
    ivec3 size, corner;
    for (int k = 0; k < 3; ++k) {
        size[k] = 2 * dice.whole(wanted.least / 2, wanted.most / 2);
        corner[k] = 2 * dice.whole(-4, 4);
    }
    const ivec3 margin = wanted.margin * ivec3(wanted.marginOn);
    p.box.min = vec3(corner - margin) * kSpacing;
    p.box.max = vec3(corner + size + margin) * kSpacing;
    const int blocks = dice.whole(1, 3), axis = dice.whole(0, 2);
    for (int b = 0; b < blocks; ++b) {
        ivec3 low = corner, room = size;
        room[axis] = size[axis] / blocks;
        low[axis] += b * room[axis];
        ivec3 edge;
        for (int k = 0; k < 3; ++k) {
            edge[k] = dice.whole(std::min(4, room[k]), std::min(8, room[k]));
            low[k] += dice.whole(0, room[k] - edge[k]);
        }
        p.blocks.push_back({vec3(low) * kSpacing, vec3(low + edge) * kSpacing, kDesignSpeed});
        const vec3 speed = dice.inCube(1.0F);
        for (int z = 0; z < edge.z; ++z)
            for (int y = 0; y < edge.y; ++y)
                for (int x = 0; x < edge.x; ++x) {
                    s.x.push_back((vec3(low) + vec3(x, y, z) + 0.5F + dice.inCube(0.1F)) * kSpacing);
                    s.v.push_back(speed + dice.inCube(0.05F));
                }
    }
    return s;
}

struct State {
    std::vector<vec3> x, v;  // by id
    FluidStats stats;
};

inline State byId(FluidWorld& world) {
    const HostParticles now = readParticles(world);
    State s;
    s.x.resize(now.id.size());
    s.v.resize(now.id.size());
    for (size_t i = 0; i < now.id.size(); ++i) {
        s.x.at(now.id[i]) = vec3(now.position[i]);
        s.v.at(now.id[i]) = vec3(now.velocity[i]);
    }
    world.device().finish();
    world.device().poll();
    s.stats = world.stats();
    return s;
}

// Writes places and velocities, by id.
inline void place(FluidWorld& world, const std::vector<vec3>& x, const std::vector<vec3>& v) {
    const ParticleView view = world.particles();
    ASSERT_EQ(view.count, x.size());
    std::vector<vec4> places, speeds;
    for (const uint32_t id : world.device().readAll<uint32_t>(*view.id, view.count)) {
        places.emplace_back(x.at(id), 1.0F);
        speeds.emplace_back(v.at(id), 0.0F);
    }
    world.device().writeAll<vec4>(const_cast<Buffer&>(*view.position), places);
    world.device().writeAll<vec4>(const_cast<Buffer&>(*view.velocity), speeds);
}

// Whether a world was refused because its method does not support periodic axes: the only refusal that random scenes may meet.
inline bool refusedPeriodicAxes(const Error& error) { return error.message.find("no periodic axes") != std::string::npos; }

// Null if the method does not support the scene's periodic axes: the test is then skipped. Any other refusal is a failure.
inline std::unique_ptr<FluidWorld> open(Device& device, const RandomScene& s) {
    auto world = FluidWorld::create(device, s.params, {}, {});
    if (!world) {
        if (glm::any(s.params.box.periodic()) && refusedPeriodicAxes(world.error()))
            [&] { GTEST_SKIP() << world.error().message; }();
        else
            ADD_FAILURE() << world.error().message;
        return nullptr;
    }
    place(**world, s.x, s.v);
    return std::move(*world);
}

inline void advance(FluidWorld& world, const RandomScene& s, int steps) {
    for (int k = 0; k < steps; ++k) {
        world.step({.gravity = s.params.gravity}, s.dt);
        if (s.oneStep) ASSERT_EQ(world.lastSubsteps(), 1);
    }
}

inline State run(Device& device, const RandomScene& s) {
    auto world = open(device, s);
    if (!world) return {};
    advance(*world, s, s.steps);
    State end = byId(*world);
    EXPECT_EQ(end.stats.lost, 0U);
    EXPECT_EQ(end.stats.nan, 0U);
    if (s.oneStep) EXPECT_EQ(end.stats.speedLimited, 0U);
    EXPECT_EQ(end.x.size(), s.x.size());
    return end;
}

}  // namespace rivulet::relations
