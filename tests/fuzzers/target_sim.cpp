// Targets state (values of a saved world), flow (drops on any mesh) and grid (neighbours of any particles).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "fluid/flow/surface_flow.h"
#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/surface/ellipsoids.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/fuzzers/target.h"

namespace rivulet::fuzzers {

namespace {

constexpr float kSpacing = 0.05F;

// A small world that has a section of nearly every kind.
std::unique_ptr<FluidWorld> world(const char* method) {
    FluidParams p;
    p.method = method;
    p.spacing = kSpacing;
    p.sleep.on = true;
    p.sleep.speed = 0.1F;
    p.ellipsoids = true;
    p.foam.most = 100;
    p.box.max = vec3(0.5F);
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.5F, 0.15F, 0.3F)}};
    Solids solids;
    solids.bodies.resize(1);
    solids.bodies[0].shape = sphereShape(0.08F, 300, kSpacing);
    solids.bodies[0].state.pose.position = vec3(0.25F, 0.25F, 0.15F);
    Sources sources;
    sources.emitters.resize(1);
    sources.emitters[0].params.litresPerSecond = 2;
    sources.emitters[0].params.position = vec3(0.4F, 0.4F, 0.4F);
    sources.emitters[0].params.radius = 0.06F;
    sources.emitters[0].params.stop = 0.2F;
    sources.sinks.resize(1);
    sources.sinks[0].position = vec3(0.0F, 0.0F, 0.5F);
    sources.sinks[0].size = vec3(0.05F);
    sources.expectedDeposit = 1.0e-3;
    auto made = FluidWorld::create(device(), p, solids, {}, sources);
    require(made, made ? "" : made.error().message);
    for (int k = 0; k < 20; ++k) (*made)->step({}, 1.0 / 60);
    return std::move(*made);
}

struct Saved {
    std::unique_ptr<FluidWorld> of;
    WorldState state;
};
std::array<Saved, 3>& saved() {
    static std::array<Saved, 3> all = [] {
        std::array<Saved, 3> made;
        constexpr std::array kMethods = {"pbf", "dfsph", "wcsph"};
        for (size_t k = 0; k < made.size(); ++k) {
            made[k].of = world(kMethods[k]);
            made[k].of->save(made[k].state);
        }
        return made;
    }();
    return all;
}

}  // namespace

// Changes words of some sections, or their lengths, and continues from that.
void runState(Bytes bytes) {
    Feed feed(bytes);
    Saved& from = saved()[feed.u8() % saved().size()];
    WorldState state;
    std::vector<std::string> names;
    for (const auto& [name, section] : from.state.sections()) names.push_back(name);
    std::map<std::string, WorldState::Bytes> sections = from.state.sections();
    for (int k = 0; k < 8 && !feed.empty(); ++k) {
        WorldState::Bytes& section = sections[names[feed.below(static_cast<uint32_t>(names.size()))]];
        const uint8_t what = feed.u8();
        if (what == 255) {
            section.resize(feed.below(static_cast<uint32_t>(section.size()) + 9));
        } else if (section.size() >= 4) {
            const size_t at = 4 * static_cast<size_t>(feed.below(static_cast<uint32_t>(section.size() / 4)));
            const float value = feed.real();
            const uint32_t word = feed.u32();
            std::memcpy(section.data() + at, what < 128 ? static_cast<const void*>(&value) : &word, 4);
        }
    }
    for (const auto& [name, section] : sections) state.putBytes(name, section);
    if (const Status restored = from.of->restore(state); !restored) {
        requireSentence(restored.error().message);
        WorldState whole;
        for (const auto& [name, section] : from.state.sections()) whole.putBytes(name, section);
        require(from.of->restore(whole), "a world continues from its own state after it refused another");
    }
    for (int k = 0; k < 2; ++k) from.of->step({}, 1.0 / 60);
    require(std::isfinite(from.of->stats().kinetic), "energy is finite");
    WorldState again;
    from.of->save(again);
    const ParticleView view = from.of->particles();
    for (const vec4& x : device().readAll<vec4>(*view.position, view.slots))
        require(x.w < 0 || (std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z)), "positions are finite");
}

std::vector<std::string> stateSeeds() {
    std::vector<std::string> all;
    for (int k = 0; k < 40; ++k) {
        std::string bytes(40, '\0');
        for (size_t n = 0; n < bytes.size(); ++n) bytes[n] = static_cast<char>(17 * k + 5 * static_cast<int>(n * n));
        all.push_back(bytes);
    }
    return all;
}

void runFlow(Bytes bytes) {
    Feed feed(bytes);
    std::vector<vec3> positions(feed.below(40));
    const bool wild = feed.u8() < 64;
    for (vec3& p : positions)
        p = wild ? vec3(feed.real(), feed.real(), feed.real()) : 0.02F * vec3(feed.within(-1, 1), feed.within(-1, 1), feed.within(-1, 1));
    std::vector<uint32_t> indices(feed.below(120));
    for (uint32_t& i : indices) i = wild && feed.u8() == 0 ? feed.u32() : feed.below(static_cast<uint32_t>(positions.size()));
    Result<FlowMesh> mesh = makeFlowMesh({positions, indices, {}, {}});
    if (!mesh) {
        requireSentence(mesh.error().message);
        return;
    }
    const auto triangles = static_cast<uint32_t>(mesh->triangleCount());
    SurfaceFlowParams params;
    params.capacity = 64;
    params.filmCell = 2.0e-3F;
    Result<SurfaceFlow> flow = SurfaceFlow::create(device(), std::move(*mesh), params);
    if (!flow) {
        requireSentence(flow.error().message);
        return;
    }
    const bool bends = feed.u8() < 128;
    for (int step = 0; step < 6; ++step) {
        const float b1 = feed.within(0, 1), b2 = feed.within(0, 1) * (1 - b1);
        flow->add({feed.below(triangles), b1, b2}, feed.below(30000000), vec3(feed.within(-1, 1)));
        SurfaceFlowInputs inputs;
        inputs.gravity = vec3(feed.real(), -9.81F, feed.real());
        if (bends) {
            for (vec3& p : positions) p += 1.0e-3F * vec3(feed.real(), feed.real(), feed.real());
            inputs.positions = positions;
        }
        if (const Status done = flow->step(inputs, 1.0 / 60); !done) requireSentence(done.error().message);
    }
    for (const SkinDrop& d : flow->drops()) {
        require(d.at.triangle < triangles, "a drop is on a triangle");
        require(std::isfinite(d.position.x) && std::isfinite(d.position.y) && std::isfinite(d.position.z), "a drop is at a place");
    }
    const SurfaceFlow::Ledger l = flow->ledger();
    require(l.added == l.drops + l.film + l.left + l.evaporated + l.refused, "the ledger closes");
}

std::vector<std::string> flowSeeds() {
    std::vector<std::string> all;
    for (int k = 0; k < 20; ++k) {
        std::string bytes(1200, '\0');
        uint32_t state = static_cast<uint32_t>(k) * 2654435761U + 1;
        for (char& c : bytes) c = static_cast<char>((state = state * 1664525U + 1013904223U) >> 24U);
        bytes[4] = static_cast<char>(k % 2 == 0 ? 200 : 0);
        all.push_back(bytes);
    }
    return all;
}

// Neighbour cells, lists and a kernel over pairs, for any number of particles at any places.
void runGrid(Bytes bytes) {
    Feed feed(bytes);
    std::vector<vec4> particles(feed.below(400));
    const uint8_t wild = feed.u8();
    const float extent = wild < 64 ? 0.1F : 100.0F;
    for (vec4& p : particles) {
        p = vec4(feed.within(-extent, extent), feed.within(-extent, extent), feed.within(-extent, extent), 1.0F);
        if (wild == 0) p[static_cast<int>(feed.below(3))] = feed.real();
    }
    const float spacing = feed.u8() == 0 ? feed.real() : feed.within(0.005F, 0.05F);
    const Result<HostEllipsoids> shapes = ellipsoidsOf(device(), particles, spacing);
    if (!shapes) {
        requireSentence(shapes.error().message);
        return;
    }
    for (const std::vector<vec4>& part : *shapes) require(part.size() == particles.size(), "one ellipsoid a particle");
    if (wild == 0) return;
    for (const vec4& centre : (*shapes)[0])
        require(std::isfinite(centre.x) && std::isfinite(centre.y) && std::isfinite(centre.z), "ellipsoids of finite particles are finite");
}

std::vector<std::string> gridSeeds() { return flowSeeds(); }

}  // namespace rivulet::fuzzers
