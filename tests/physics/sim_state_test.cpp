// A run resumed from a saved state equals the uninterrupted run: bit for bit on the cpu, for all moving parts.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "engine/compute/device_cpu.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/unit/voxel_test_meshes.h"

namespace rivulet::sim_state_test {
namespace {

std::unique_ptr<CpuDevice> cpu() {
    const std::vector<CpuKernelRow> rows = cpuKernels();
    return makeCpuDevice(rows);
}

// A block in a box with a rotating and oscillating paddle wheel, and a deforming sheet.
SceneFile scene(const std::string& method) {
    SceneFile s;
    s.name = "state";
    s.fluid.method = method;
    s.fluid.spacing = 0.04F;
    s.fluid.box.max = vec3(1.0F, 0.8F, 0.6F);
    s.fluid.blocks = {{vec3(0.0F), vec3(0.5F, 0.5F, 0.6F), vec3(0.0F)}};
    ColliderParams wheel;
    wheel.mesh = "meshes/paddle_wheel.obj";
    wheel.fitSize = 0.4F;
    wheel.resolution = 30;
    wheel.position = vec3(0.7F, 0.25F, 0.3F);
    wheel.motion.spin = 150;
    wheel.motion.shake = vec3(0.05F, 0, 0);
    ColliderParams sheet;
    sheet.mesh = "meshes/sheet.obj";
    sheet.fitSize = 0.3F;
    sheet.resolution = 16;
    sheet.position = vec3(0.3F, 0.6F, 0.3F);
    sheet.wave.amplitude = 0.05F;
    s.colliders = {wheel, sheet};
    return s;
}

std::unique_ptr<Session> make(Device& device, const SceneFile& scene) {
    auto session = Session::create(scene, device, {});
    EXPECT_TRUE(session) << (session ? "" : session.error().message);
    return session ? std::move(*session) : nullptr;
}

// By way of the bytes of a file, as a program does.
WorldState throughBytes(Session& session) {
    WorldState state;
    session.save(state);
    Result<std::string> bytes = packState(state);
    EXPECT_TRUE(bytes) << (bytes ? "" : bytes.error().message);
    Result<WorldState> back = unpackState(std::as_bytes(std::span(*bytes)), "state");
    EXPECT_TRUE(back) << (back ? "" : back.error().message);
    return std::move(*back);
}

struct All {
    std::vector<vec4> position, velocity;
    std::vector<uint32_t> id;
    std::vector<Pose> poses;
    double time = 0;
};
All all(Session& session) {
    FluidWorld& w = session.world();
    const ParticleView v = w.particles();
    return {w.device().readAll<vec4>(*v.position, v.count), w.device().readAll<vec4>(*v.velocity, v.count),
            w.device().readAll<uint32_t>(*v.id, v.count), w.poses(), w.time()};
}

template <class T>
bool sameBits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

class State : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, State, testing::Values("wcsph", "pbf", "dfsph"), [](const auto& row) { return std::string(row.param); });

TEST_P(State, AResumedRunContinuesBitForBit) {
    auto device = cpu();
    const int frames = 8;
    auto whole = make(*device, scene(GetParam())), first = make(*device, scene(GetParam())), second = make(*device, scene(GetParam()));
    for (int k = 0; k < 2 * frames; ++k) whole->step(1.0 / 60, true);
    for (int k = 0; k < frames; ++k) first->step(1.0 / 60, true);
    second->step(1.0 / 60, true);  // its earlier state does not matter
    WorldState state = throughBytes(*first);
    const Status done = second->restore(state);
    ASSERT_TRUE(done) << done.error().message;
    const All before = all(*first), restored = all(*second);
    EXPECT_TRUE(sameBits(before.position, restored.position) && sameBits(before.velocity, restored.velocity));
    for (int k = 0; k < frames; ++k) second->step(1.0 / 60, true);
    const All a = all(*whole), b = all(*second);
    EXPECT_EQ(a.time, b.time);
    EXPECT_TRUE(sameBits(a.id, b.id));
    EXPECT_TRUE(sameBits(a.position, b.position));
    EXPECT_TRUE(sameBits(a.velocity, b.velocity));
    EXPECT_TRUE(sameBits(a.poses, b.poses));
    EXPECT_EQ(whole->world().voxelsRewritten(), second->world().voxelsRewritten());
    EXPECT_FALSE(sameBits(a.position, before.position)) << "it does move";
    EXPECT_EQ(whole->world().stats().kinetic, second->world().stats().kinetic);
    EXPECT_EQ(whole->world().stats().dtMin, second->world().stats().dtMin);
}

// Each missing part has an effect: without it the next frames differ, or the state is refused.
TEST_P(State, AMissingPartOrAnotherSceneIsRefused) {
    auto device = cpu();
    auto session = make(*device, scene(GetParam()));
    for (int k = 0; k < 3; ++k) session->step(1.0 / 60, true);
    WorldState saved = throughBytes(*session);
    const All before = all(*session);
    for (const auto& [left, bytes] : saved.sections()) {
        WorldState less;
        for (const auto& [name, numbers] : saved.sections())
            if (name != left) less.putBytes(name, numbers);
        const Status done = session->restore(less);
        ASSERT_FALSE(done) << left;
        EXPECT_NE(done.error().message.find(left), std::string::npos) << done.error().message;
    }
    for (const auto& [changed, bytes] : saved.sections()) {
        WorldState other;
        for (const auto& [name, numbers] : saved.sections()) {
            WorldState::Bytes b = numbers;
            if (name == changed && name != "world.limited") b.push_back(std::byte{65});
            other.putBytes(name, b);
        }
        if (changed != "world.limited") EXPECT_FALSE(session->restore(other)) << changed;
    }
    {
        WorldState more = saved;
        more.putText("emitter.pending", "1");
        const Status done = session->restore(more);
        ASSERT_FALSE(done);
        EXPECT_NE(done.error().message.find("emitter.pending"), std::string::npos);
    }
    for (const auto& [what, change] : std::initializer_list<std::pair<const char*, void (*)(SceneFile&)>>{
             {"spacing", [](SceneFile& s) { s.fluid.spacing = 0.045F; }},
             {"method", [](SceneFile& s) { s.fluid.method = s.fluid.method == "pbf" ? "wcsph" : "pbf"; }},
             {"box.max", [](SceneFile& s) { s.fluid.box.max.x = 1.1F; }},
             {"blocks",
              [](SceneFile& s) {
                  s.fluid.blocks.push_back({vec3(0.6F), vec3(0.7F), vec3(0.0F)});
              }},
             {"colliders", [](SceneFile& s) { s.colliders.pop_back(); }},
             {"resolution", [](SceneFile& s) { s.colliders[0].resolution = 25; }}}) {
        SceneFile other = scene(GetParam());
        change(other);
        auto another = make(*device, other);
        WorldState state = saved;
        const Status done = another->restore(state);
        ASSERT_FALSE(done) << what;
        EXPECT_NE(done.error().message.find(what), std::string::npos) << done.error().message;
        EXPECT_EQ(another->world().time(), 0);
    }
    // Refused or not, nothing has changed.
    const All after = all(*session);
    EXPECT_TRUE(sameBits(before.position, after.position) && sameBits(before.velocity, after.velocity) && sameBits(before.id, after.id));
    EXPECT_EQ(before.time, after.time);
    // Kernels use ids as indices.
    WorldState twice;
    for (const auto& [name, numbers] : saved.sections()) {
        WorldState::Bytes b = numbers;
        if (name == "particles.id") std::memcpy(b.data(), b.data() + 4, 4);
        twice.putBytes(name, b);
    }
    EXPECT_FALSE(session->restore(twice));
}

// A world without a session: time that waits for a whole step, and dropped time, are kept.
TEST(StateOfAWorld, PendingTimeIsKept) {
    auto device = cpu();
    FluidParams p;
    p.method = "pbf";
    p.spacing = 0.05F;
    p.fixedStep = 0.01F;
    p.blocks = {{vec3(0.0F), vec3(0.4F), vec3(0.0F)}};
    const auto world = [&] {
        auto made = FluidWorld::create(*device, p, {}, {});
        EXPECT_TRUE(made) << (made ? "" : made.error().message);
        return std::move(*made);
    };
    auto a = world(), b = world();
    a->setOrigin(dvec3(1.0e7 + 0.1, 0, 0));
    a->step({.gravity = p.gravity}, 0.25);
    a->step({.gravity = p.gravity}, 0.0137);
    WorldState state;
    a->save(state);
    const Status done = b->restore(state);
    ASSERT_TRUE(done) << done.error().message;
    EXPECT_EQ(a->pending(), b->pending());
    EXPECT_EQ(a->dropped(), b->dropped());
    EXPECT_EQ(a->origin(), b->origin());
    EXPECT_EQ(a->stats().limited, b->stats().limited);
    for (FluidWorld* w : {a.get(), b.get()}) w->step({.gravity = p.gravity}, 0.0301);
    EXPECT_EQ(a->time(), b->time());
    const uint32_t n = a->particles().count;
    EXPECT_EQ(device->readAll<vec4>(*a->particles().position, n), device->readAll<vec4>(*b->particles().position, n));
}

}  // namespace
}  // namespace rivulet::sim_state_test
