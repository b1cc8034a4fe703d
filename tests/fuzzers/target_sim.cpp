// Targets state (values of a saved world), flow (drops on any mesh) and grid (neighbours and surface of any particles).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "engine/core/json.h"
#include "fluid/flow/surface_flow.h"
#include "fluid/session/session.h"
#include "fluid/sim/solids/body_shapes.h"
#include "fluid/sim/surface/ellipsoids.h"
#include "fluid/sim/surface/iso_surface.h"
#include "fluid/sim/world/fluid_world.h"
#include "fluid/sim/world/pose.h"
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

// A scene of its own: a body and a solid that spins.
std::unique_ptr<Session> session() {
    SceneFile scene;
    const Status read = readJson(R"({"fluid": {"spacing": 0.06, "box": {"max": [0.5, 0.5, 0.5]}, "blocks": [{"max": [0.5, 0.18, 0.5]}]},
        "colliders": [{"mesh": "meshes/obstacle.obj", "fitSize": 0.15, "position": [0.25, 0.1, 0.25], "motion": {"spin": 90}}],
        "bodies": [{"mesh": "meshes/obstacle.obj", "fitSize": 0.12, "position": [0.1, 0.35, 0.1], "density": 400}]})",
                                 "session", [&](ParamVisitor& v) { scene.visit(v); });
    require(read, read ? "" : read.error().message);
    auto made = Session::create(scene, device(), {});
    require(made, made ? "" : made.error().message);
    for (int k = 0; k < 20; ++k) (*made)->step(1.0 / 60, true);
    return std::move(*made);
}

// A world by itself, or a session's.
struct Saved {
    std::unique_ptr<FluidWorld> world;
    std::unique_ptr<Session> session;
    WorldState state;

    FluidWorld& of() { return session ? session->world() : *world; }
    Status restore(const std::map<std::string, WorldState::Bytes>& sections) {
        WorldState from;
        for (const auto& [name, section] : sections) from.putBytes(name, section);
        return session ? session->restore(from) : world->restore(from);
    }
    void step() { session ? (void)session->step(1.0 / 60, true) : world->step({}, 1.0 / 60); }
};
std::array<Saved, 4>& saved() {
    static std::array<Saved, 4> all = [] {
        std::array<Saved, 4> made;
        constexpr std::array kMethods = {"pbf", "dfsph", "wcsph"};
        for (size_t k = 0; k < kMethods.size(); ++k) {
            made[k].world = world(kMethods[k]);
            made[k].world->save(made[k].state);
        }
        made[3].session = session();
        made[3].session->save(made[3].state);
        return made;
    }();
    return all;
}

// Changes one number of a section, or its length.
void change(WorldState::Bytes& section, Feed& feed) {
    const uint8_t what = feed.u8();
    if (what >= 250) return section.resize(feed.below(static_cast<uint32_t>(section.size()) + 9));
    const auto put = [&](auto value) {
        if (section.size() < sizeof value) return;
        const size_t at = sizeof value * static_cast<size_t>(feed.below(static_cast<uint32_t>(section.size() / sizeof value)));
        std::memcpy(section.data() + at, &value, sizeof value);
    };
    if (what < 100) return put(feed.real());
    if (what < 150) return put(feed.u32());
    if (what < 200) return put(double{feed.real()});
    put(feed.u8());
}

}  // namespace

// Changes numbers of some sections, or their lengths, and continues from that.
void runState(Bytes bytes) {
    Feed feed(bytes);
    Saved& from = saved()[feed.u8() % saved().size()];
    std::vector<std::string> names;
    for (const auto& [name, section] : from.state.sections()) names.push_back(name);
    std::map<std::string, WorldState::Bytes> sections = from.state.sections();
    for (int k = 0; k < 8 && !feed.empty(); ++k) change(sections[names[feed.below(static_cast<uint32_t>(names.size()))]], feed);
    if (const Status restored = from.restore(sections); !restored) {
        requireSentence(restored.error().message);
        const Status whole = from.restore(from.state.sections());
        require(whole, whole ? "" : "a world continues from its own state after it refused another: " + whole.error().message);
    }
    FluidWorld& world = from.of();
    for (int k = 0; k < 2; ++k) from.step();
    require(std::isfinite(world.stats().kinetic), "energy is finite");
    require(world.savable(), "a world that was restored can be saved");
    WorldState again;
    from.session ? from.session->save(again) : world.save(again);
    const Status back = from.restore(again.sections());
    require(back, back ? "" : "a state that was saved can be restored: " + back.error().message);
    const ParticleView view = world.particles();
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
    if (!mesh) return requireSentence(mesh.error().message);
    constexpr float kFarthest = 1.0e5F;  // m
    const bool far =
        std::ranges::any_of(mesh->rest, [](const vec3& p) { return glm::any(glm::greaterThan(glm::abs(p), vec3(kFarthest))); });
    const auto triangles = static_cast<uint32_t>(mesh->triangleCount());
    SurfaceFlowParams params;
    params.capacity = 64;
    params.filmCell = 2.0e-3F;
    Result<SurfaceFlow> flow = SurfaceFlow::create(device(), std::move(*mesh), params);
    if (!flow) return requireSentence(flow.error().message);
    require(!far, "a skin that is far from zero is refused");
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
        const Status done = flow->step(inputs, 1.0 / 60);
        if (!done) requireSentence(done.error().message);
        require(!done || isWithin(inputs.gravity, kMostGravity), "gravity beyond all worlds is refused");
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
    const float extent = feed.u8() < 128 ? 0.1F : 100.0F;
    for (vec4& p : particles) p = vec4(feed.within(-extent, extent), feed.within(-extent, extent), feed.within(-extent, extent), 1.0F);
    float spacing = feed.within(0.005F, 0.05F);
    const Result<HostEllipsoids> shapes = ellipsoidsOf(device(), particles, spacing);
    if (!shapes) return requireSentence(shapes.error().message);
    for (const std::vector<vec4>& part : *shapes) {
        require(part.size() == particles.size(), "one ellipsoid a particle");
        for (const vec4& v : part) require(isFinite(vec3(v)), "ellipsoids of finite particles are finite");
    }
    // A surface takes any numbers.
    if (feed.u8() < 64 && !particles.empty())
        particles[feed.below(static_cast<uint32_t>(particles.size()))][static_cast<int>(feed.below(4))] = feed.real();
    if (feed.u8() < 32) spacing = feed.real();
    const Result<IsoSurface> surface = IsoSurface::create(particles, spacing);
    if (!surface) return requireSentence(surface.error().message);
    (void)surface->sample(dvec3(particles.empty() ? vec3(0.0F) : vec3(particles[0])));
}

std::vector<std::string> gridSeeds() { return flowSeeds(); }

}  // namespace rivulet::fuzzers
