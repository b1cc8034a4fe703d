// A state with bodies, emitters and sinks continues bit for bit, with bodies moved by the world or by a host; an invalid state changes
// nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "fluid/session/session.h"
#include "fluid/sim/solids/body_shapes.h"
#include "tests/physics/worlds.h"

namespace rivulet::sim_state_bodies_test {
namespace {

constexpr float kSpacing = 0.03F;
constexpr int kMostParticles = 1650;

// A heavy box on the floor of a pool with another on it, a floating box, and a rotating paddle; an emitter adds dyed water, and a sink
// removes as much.
SceneFile scene(const std::string& method) {
    SceneFile s;
    s.name = "state";
    s.fluid.method = method;
    s.fluid.spacing = kSpacing;
    s.fluid.soundSpeed = 20;
    s.fluid.cfl = 0.8F;
    s.fluid.maxParticles = kMostParticles;
    s.fluid.box.max = vec3(0.6F, 0.6F, 0.6F);
    s.fluid.blocks = {{vec3(0.0F), vec3(0.6F, 0.13F, 0.6F), vec3(0.0F)}};
    BodyParams body;
    body.density = 3000;
    body.size = vec3(0.15F, 0.1F, 0.15F);
    body.position = vec3(0.15F, 0.05F, 0.3F);
    s.bodies.push_back(body);
    body.size = vec3(0.1F);
    body.position = vec3(0.16F, 0.15F, 0.3F);
    body.rotation = vec3(0, 20, 0);
    s.bodies.push_back(body);
    body.density = 300;
    body.position = vec3(0.3F, 0.2F, 0.12F);
    s.bodies.push_back(body);
    ColliderParams paddle;
    paddle.mesh = "meshes/paddle_wheel.obj";
    paddle.fitSize = 0.2F;
    paddle.resolution = 16;
    paddle.position = vec3(0.45F, 0.2F, 0.15F);
    paddle.motion.spin = 200;
    s.colliders = {paddle};
    EmitterParams emitter;
    emitter.litresPerSecond = 20;
    emitter.radius = 0.08F;
    emitter.position = vec3(0.4F, 0.5F, 0.4F);
    emitter.dye = vec3(0.9F, 0.1F, 0.2F);
    s.emitters = {emitter};
    SinkParams sink;
    sink.position = vec3(0.5F, 0.04F, 0.5F);
    sink.size = vec3(0.2F, 0.08F, 0.2F);
    s.sinks = {sink};
    return s;
}

std::unique_ptr<Session> start(Device& device, const SceneFile& scene) {
    auto session = Session::create(scene, device, {});
    EXPECT_TRUE(session) << (session ? "" : session.error().message);
    return session ? std::move(*session) : nullptr;
}

WorldState throughBytes(const WorldState& state) {
    Result<std::string> bytes = packState(state);
    EXPECT_TRUE(bytes) << (bytes ? "" : bytes.error().message);
    Result<WorldState> back = unpackState(std::as_bytes(std::span(*bytes)), "state");
    EXPECT_TRUE(back) << (back ? "" : back.error().message);
    return std::move(*back);
}

WorldState saved(Session& session) {
    WorldState state;
    session.save(state);
    return throughBytes(state);
}

void run(Session& session, int frames) {
    for (int k = 0; k < frames; ++k) session.step(1.0 / 60, true);
}

// All sections of the state that the next step depends on, for one comparison of everything.
void expectSame(const WorldState& a, const WorldState& b) {
    ASSERT_EQ(a.sections().size(), b.sections().size());
    for (const auto& [name, bytes] : a.sections()) {
        ASSERT_TRUE(b.sections().contains(name)) << name;
        EXPECT_TRUE(bytes == b.sections().at(name)) << name;
    }
}

template <class T>
std::vector<T> items(const WorldState& state, const std::string& name) {
    const WorldState::Bytes& bytes = state.sections().at(name);
    std::vector<T> all(bytes.size() / sizeof(T));
    std::memcpy(all.data(), bytes.data(), bytes.size());
    return all;
}

class WholeState : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, WholeState, testing::Values("wcsph", "pbf", "dfsph"),
                         [](const auto& row) { return std::string(row.param); });

TEST_P(WholeState, WithBodiesEmittersAndSinksContinuesBitForBit) {
    auto device = cpu();
    const int frames = 14;
    auto whole = start(*device, scene(GetParam())), first = start(*device, scene(GetParam())), second = start(*device, scene(GetParam()));
    ASSERT_TRUE(whole && first && second);
    run(*whole, 2 * frames);
    run(*first, frames);
    run(*second, 3);  // its earlier state does not matter
    const WorldState half = saved(*first);
    WorldState taken = half;
    const Status done = second->restore(taken);
    ASSERT_TRUE(done) << done.error().message;
    expectSame(half, saved(*second));
    const ParticleView v = first->world().particles(), w = second->world().particles();
    EXPECT_EQ(device->readAll<vec4>(*v.absorption, v.count), device->readAll<vec4>(*w.absorption, w.count)) << "what is drawn, too";
    EXPECT_EQ(first->world().stats().emitted, second->world().stats().emitted);
    EXPECT_EQ(first->world().stats().drained, second->world().stats().drained);
    EXPECT_EQ(first->world().stats().particles, second->world().stats().particles);
    run(*second, frames);
    expectSame(saved(*whole), saved(*second));
    const FluidStats &a = whole->world().stats(), &b = second->world().stats();
    EXPECT_EQ(a.kinetic, b.kinetic);
    EXPECT_EQ(a.emitted, b.emitted);
    EXPECT_EQ(a.drained, b.drained);
    EXPECT_EQ(a.backlog, b.backlog);

    // The scene must cover these cases: bodies in contact and in motion, and reused slots.
    const auto bodies = items<BodyState>(half, "bodies.states");
    EXPECT_NEAR(bodies[0].pose.position.y, 0.05F, 0.003F);
    EXPECT_NEAR(bodies[1].pose.position.y, 0.15F, 0.01F);
    EXPECT_GT(glm::length(whole->world().bodies()[2].pose.position - bodies[2].pose.position), 0.001F);
    const double volume = std::pow(double{kSpacing}, 3);
    EXPECT_GT(a.emitted / volume, kMostParticles + 20) << "more than there are slots: some were used again";
    EXPECT_GT(first->world().stats().drained / volume, 20);
    const auto x = items<vec4>(half, "particles.position");
    const auto ids = items<uint32_t>(half, "particles.id");
    const auto dyed = items<vec4>(half, "particles.absorption");
    size_t red = 0;
    for (size_t i = 0; i < x.size(); ++i) red += x[i].w >= 0 && dyed[ids[i]].y > 1 ? 1 : 0;
    EXPECT_GT(red, 100U);
}

TEST_P(WholeState, InvalidStatesAreRefusedAndNothingChanges) {
    auto device = cpu();
    auto session = start(*device, scene(GetParam()));
    ASSERT_TRUE(session);
    run(*session, 3);
    const WorldState good = saved(*session);
    run(*session, 1);
    const WorldState now = saved(*session);
    const auto with = [&](const std::string& name, const std::function<void(WorldState::Bytes&)>& change) {
        WorldState other;
        for (const auto& [n, numbers] : good.sections()) {
            WorldState::Bytes bytes = numbers;
            if (n == name) change(bytes);
            other.putBytes(n, bytes);
        }
        return session->restore(other);
    };
    int parts = 0;
    for (const auto& [name, numbers] : good.sections()) {
        if (!name.starts_with("bodies.") && !name.starts_with("sources.") && name != "particles.absorption") continue;
        ++parts;
        EXPECT_FALSE(with(name, [](auto& b) { b.push_back(std::byte{65}); })) << name;
        EXPECT_FALSE(with(name, [](auto& b) { b.pop_back(); })) << name;
        WorldState less;
        for (const auto& [n, bytes] : good.sections())
            if (n != name) less.putBytes(n, bytes);
        const Status done = session->restore(less);
        ASSERT_FALSE(done) << name;
        EXPECT_NE(done.error().message.find(name), std::string::npos) << done.error().message;
    }
    EXPECT_EQ(parts, 10);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const double dnan = nan;
    EXPECT_FALSE(with("bodies.states", [&](auto& b) { std::memcpy(b.data(), &nan, 4); }));
    EXPECT_FALSE(with("bodies.states", [&](auto& b) { std::memcpy(b.data() + 12, b.data(), 4); })) << "a rotation of another length";
    EXPECT_FALSE(with("bodies.loads", [&](auto& b) { std::memcpy(b.data() + 8, &dnan, 8); }));
    EXPECT_FALSE(with("bodies.host", [&](auto& b) { std::memcpy(b.data(), &nan, 4); }));
    EXPECT_FALSE(with("bodies.host", [&](auto& b) { std::memcpy(b.data() + b.size() - 8, &dnan, 8); }));
    EXPECT_FALSE(with("sources.accounts", [&](auto& b) { std::memcpy(b.data(), &dnan, 8); }));
    EXPECT_FALSE(with("sources.accounts", [](auto& b) { b[8] ^= std::byte{1}; })) << "one more was offered than was taken or refused";
    EXPECT_FALSE(with("sources.counters", [](auto& b) { b[0] ^= std::byte{1}; }));
    EXPECT_FALSE(with("sources.heard", [](auto& b) { b[0] ^= std::byte{1}; }));
    EXPECT_FALSE(with("sources.waited", [&](auto& b) { std::memcpy(b.data(), &dnan, 8); }));
    expectSame(now, saved(*session));

    // The state of another scene.
    for (const auto& [what, change] : std::initializer_list<std::pair<const char*, void (*)(SceneFile&)>>{
             {"bodies", [](SceneFile& s) { s.bodies.pop_back(); }},
             {"density", [](SceneFile& s) { s.bodies[1].density = 2900; }},
             {"emitters", [](SceneFile& s) { s.emitters.push_back(s.emitters[0]); }},
             {"sinks", [](SceneFile& s) { s.sinks.push_back(s.sinks[0]); }},
             {"dye", [](SceneFile& s) { s.emitters[0].dye = vec3(1.0F); }},
         }) {
        SceneFile other = scene(GetParam());
        change(other);
        auto another = start(*device, other);
        ASSERT_TRUE(another);
        WorldState state = good;
        const Status done = another->restore(state);
        ASSERT_FALSE(done) << what;
        EXPECT_NE(done.error().message.find(what), std::string::npos) << done.error().message;
        EXPECT_EQ(another->world().time(), 0);
    }
}

// A custom host: a magnet whose force grows with time.
struct Magnet {
    explicit Magnet(std::span<const Body> bodies) : free(bodies) {}
    FreeBodies free;
    double on = 0;  // s
    bool picky = false;
    BodyHost host(bool saves) {
        BodyHost h;
        h.self = this;
        h.advance = [](void* self, std::span<const BodyLoad> loads, const vec3& gravity, double seconds, std::span<BodyState> states) {
            Magnet& m = *static_cast<Magnet*>(self);
            m.on += seconds;
            std::vector<BodyLoad> more(loads.begin(), loads.end());
            for (BodyLoad& l : more) l.force.y += 20 * m.on;
            const BodyHost inner = m.free.host();
            inner.advance(inner.self, more, gravity, seconds, states);
        };
        h.reset = [](void* self, std::span<const BodyState>) { static_cast<Magnet*>(self)->on = 0; };
        if (!saves) return h;
        h.save = [](void* self) {
            std::vector<std::byte> bytes(sizeof(double));
            std::memcpy(bytes.data(), &static_cast<Magnet*>(self)->on, sizeof(double));
            return bytes;
        };
        h.restore = [](void* self, std::span<const std::byte> bytes, std::span<const BodyState>) -> Status {
            Magnet& m = *static_cast<Magnet*>(self);
            if (m.picky || bytes.size() != sizeof(double)) return badInput("not a magnet's");
            std::memcpy(&m.on, bytes.data(), sizeof(double));
            return ok();
        };
        return h;
    }
};

TEST(StateOfAHost, IsSavedIfTheHostProvidesIt) {
    auto device = cpu();
    FluidParams p;
    p.method = "pbf";
    p.spacing = 0.05F;
    p.blocks = {{vec3(0.0F), vec3(1.0F, 0.3F, 0.5F), vec3(0.0F)}};
    Body body;
    body.shape = boxShape(vec3(0.2F), 400, p.spacing);
    body.state.pose.position = vec3(0.5F, 0.35F, 0.25F);
    const auto world = [&](const BodyHost& host) { return makeWorld(*device, p, {.bodies = {body}, .bodyHost = host}); };
    const auto step = [&](FluidWorld& w, int frames) {
        for (int k = 0; k < frames; ++k) w.step({.gravity = p.gravity}, 1.0 / 60);
    };
    const std::span<const Body> one(&body, 1);

    Magnet a(one), b(one), mute(one);
    auto whole = world(a.host(true)), resumed = world(b.host(true)), unsaid = world(mute.host(false)), alone = world({});
    EXPECT_TRUE(whole->savable());
    EXPECT_TRUE(alone->savable()) << "bodies that move freely have no memory";
    const Status refused = unsaid->savable();
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("host"), std::string::npos);

    step(*whole, 5);
    WorldState state;
    whole->save(state);
    const WorldState kept = throughBytes(state);
    step(*whole, 5);
    step(*resumed, 2);
    WorldState before;
    resumed->save(before);
    b.picky = true;
    WorldState taken = kept;
    EXPECT_FALSE(resumed->restore(taken));
    WorldState after;
    resumed->save(after);
    expectSame(before, after);
    b.picky = false;
    taken = kept;
    const Status done = resumed->restore(taken);
    ASSERT_TRUE(done) << done.error().message;
    step(*resumed, 5);
    WorldState ends, endsToo;
    whole->save(ends);
    resumed->save(endsToo);
    expectSame(ends, endsToo);
    taken = kept;
    EXPECT_FALSE(unsaid->restore(taken));
    taken = kept;
    EXPECT_FALSE(alone->restore(taken)) << "of another host";
}

}  // namespace
}  // namespace rivulet::sim_state_bodies_test
