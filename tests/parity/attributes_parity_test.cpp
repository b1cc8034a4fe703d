// Attributes of particles: a host's values stay with their particles, on every device.
#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <map>
#include <span>
#include <sstream>
#include <string>
#include <tuple>

#include "engine/app/context_egl.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/sim/world/host_particles.h"
#include "tests/parity/devices.h"

namespace rivulet::attributes_parity_test {
namespace {

constexpr float kSpacing = 0.05F, kFrame = 1.0F / 60;
constexpr size_t kOrigin = 0, kTeam = 1;
const vec4 kLeft(1, 2, 3, 4), kOther(-1, 0.5F, 0, 1.0e-20F), kJet(7, 0, 0, 0), kRed(1, 0, 0, 1);

// A dam of two blocks of different teams.
FluidParams dam() {
    FluidParams p;
    p.spacing = kSpacing;
    p.box.max = vec3(1.0F, 0.6F, 0.3F);
    p.blocks = {{.min = vec3(0.0F), .max = vec3(0.3F, 0.4F, 0.3F)}, {.min = vec3(0.3F, 0.0F, 0.0F), .max = vec3(0.5F, 0.2F, 0.3F)}};
    p.attributes = {{.name = "origin"}, {.name = "team", .x = kOther.x, .y = kOther.y, .z = kOther.z, .w = kOther.w}};
    p.blocks[0].attributes = {{.name = "team", .x = kLeft.x, .y = kLeft.y, .z = kLeft.z, .w = kLeft.w}};
    return p;
}

struct Tag {
    vec4 origin, team;
    vec3 position;
};
std::map<uint32_t, Tag> tagsOf(const FluidWorld& world) {
    const HostParticles all = readParticles(world);
    EXPECT_EQ(all.attributes.size(), 2U);
    std::map<uint32_t, Tag> tags;
    for (size_t i = 0; i < all.id.size(); ++i)
        tags[all.id[i]] = {all.attributes[kOrigin][i], all.attributes[kTeam][i], vec3(all.position[i])};
    EXPECT_EQ(tags.size(), all.id.size()) << "an id twice";
    return tags;
}

void tagWithOrigins(FluidWorld& world) {
    std::vector<uint32_t> ids;
    std::vector<vec4> values;
    for (const auto& [id, tag] : tagsOf(world)) {
        ids.push_back(id);
        values.emplace_back(tag.position, static_cast<float>(id));
    }
    std::reverse(ids.begin(), ids.end());  // in no order of the world's
    std::reverse(values.begin(), values.end());
    ASSERT_TRUE(world.setAttribute(kOrigin, ids, values));
}

void step(FluidWorld& world, int frames) {
    for (int k = 0; k < frames; ++k) world.step({}, double{kFrame});
    world.device().finish();
    world.device().poll();
}

class Attributes : public testing::TestWithParam<const char*> {
  protected:
    void SetUp() override {
        if (GetParam() == std::string("cpu")) {
            gpu_.device = makeTestCpu();
            return;
        }
        Result<TestGpu> gpu = makeTestGpu(GetParam());
        if (!gpu) GTEST_SKIP() << gpu.error().message;
        gpu_ = std::move(*gpu);
    }
    std::unique_ptr<FluidWorld> make(const FluidParams& p, const Sources& sources = {}) {
        auto world = FluidWorld::create(*gpu_.device, p, {}, {}, sources);
        EXPECT_TRUE(world) << (world ? "" : world.error().message);
        return world ? std::move(*world) : nullptr;
    }
    TestGpu gpu_;
};

// After a second of a dam break each tag is there once, on the particle that had it: none has jumped from one frame to the next.
TEST_P(Attributes, StayWithTheirParticles) {
    const auto world = make(dam());
    ASSERT_TRUE(world);
    tagWithOrigins(*world);
    const std::map<uint32_t, Tag> first = tagsOf(*world);
    std::map<uint32_t, Tag> before = first;
    float farthest = 0;
    for (int k = 0; k < 60; ++k) {
        step(*world, 1);
        const std::map<uint32_t, Tag> now = tagsOf(*world);
        ASSERT_EQ(now.size(), first.size());
        for (const auto& [id, tag] : now) {
            ASSERT_EQ(tag.origin, vec4(first.at(id).position, static_cast<float>(id))) << "frame " << k;
            ASSERT_EQ(tag.team, first.at(id).position.x < 0.3F ? kLeft : kOther);
            // By the tag alone: a fall of 0.6 m is 3.4 m/s.
            const auto owner = static_cast<uint32_t>(tag.origin.w);
            ASSERT_LT(glm::length(tag.position - before.at(owner).position), 4.0F * kFrame);
            farthest = std::max(farthest, glm::length(tag.position - vec3(tag.origin)));
        }
        before = now;
    }
    EXPECT_GT(farthest, 0.4F) << "the dam broke";
}

// Particles of an emitter have its value, those of freed slots too; setSources changes it for those to come.
TEST_P(Attributes, OfAnEmitterAreItsOwn) {
    FluidParams p = dam();
    Sources sources;
    sources.emitters.resize(1);
    EmitterParams& jet = sources.emitters[0].params;
    jet.position = vec3(0.8F, 0.55F, 0.15F);
    jet.litresPerSecond = 4;
    jet.attributes = {{.name = "team", .x = kJet.x}};
    sources.sinks = {{.position = vec3(0.1F, 0.1F, 0.15F), .size = vec3(0.2F)}};
    sources.seconds = 2;
    const auto world = make(p, sources);
    ASSERT_TRUE(world);
    tagWithOrigins(*world);
    const std::map<uint32_t, Tag> first = tagsOf(*world);
    step(*world, 30);
    sources.emitters[0].params.attributes[0].x = 8;
    ASSERT_TRUE(world->setSources(sources));
    step(*world, 30);
    std::map<float, size_t> byTeam;
    for (const auto& [id, tag] : tagsOf(*world)) {
        ++byTeam[tag.team.x];
        if (tag.team == kJet || tag.team.x == 8)
            EXPECT_EQ(tag.origin, vec4(0.0F)) << "of the emitter, and not of whose slot it has";
        else
            EXPECT_EQ(tag.origin.w, static_cast<float>(id));
    }
    const FluidStats& stats = world->stats();
    const double volume = std::pow(double{kSpacing}, 3);
    const auto emitted = static_cast<size_t>(std::lround(stats.emitted / volume)) - first.size();
    EXPECT_GT(std::lround(stats.drained / volume), 20);
    EXPECT_GT(byTeam[7], 5U);
    EXPECT_GT(byTeam[8], 5U);
    EXPECT_EQ(byTeam[7] + byTeam[8], emitted);
}

TEST_P(Attributes, ArePaintedWhereAVolumeIs) {
    for (const Volume& inside : {Volume{.shape = Volume::sphere, .position = vec3(0.3F, 0.1F, 0.15F), .radius = 0.12F},
                                 Volume{.shape = Volume::box, .position = vec3(0.1F, 0.2F, 0.15F), .size = vec3(0.15F, 0.2F, 1)}}) {
        const auto world = make(dam());
        ASSERT_TRUE(world);
        step(*world, 10);
        const std::map<uint32_t, Tag> before = tagsOf(*world);
        ASSERT_TRUE(world->paint(kTeam, inside, kRed));
        const std::map<uint32_t, Tag> painted = tagsOf(*world);
        step(*world, 20);
        const std::map<uint32_t, Tag> after = tagsOf(*world);
        size_t red = 0;
        for (const auto& [id, tag] : painted) {
            const vec3 d = tag.position - inside.position;
            const bool in = inside.shape == Volume::sphere ? glm::dot(d, d) <= inside.radius * inside.radius
                                                           : glm::all(glm::lessThanEqual(glm::abs(d), 0.5F * inside.size));
            EXPECT_EQ(tag.team, in ? kRed : before.at(id).team);
            EXPECT_EQ(after.at(id).team, tag.team);
            red += in ? 1 : 0;
        }
        EXPECT_GT(red, 20U);
        EXPECT_LT(red, painted.size() / 2);
    }
}

// A saved state has them; a state without them leaves those of t = 0, and so does reset().
TEST_P(Attributes, AreSavedRestoredAndReset) {
    const auto world = make(dam());
    ASSERT_TRUE(world);
    const auto same = [](const std::map<uint32_t, Tag>& a, const std::map<uint32_t, Tag>& b) {
        return std::ranges::equal(a, b, [](const auto& x, const auto& y) {
            return x.first == y.first && x.second.origin == y.second.origin && x.second.team == y.second.team;
        });
    };
    const std::map<uint32_t, Tag> first = tagsOf(*world);
    tagWithOrigins(*world);
    step(*world, 10);
    const std::map<uint32_t, Tag> saved = tagsOf(*world);
    WorldState state;
    world->save(state);
    step(*world, 5);
    ASSERT_TRUE(world->paint(kOrigin, {.size = vec3(10.0F)}, kRed));
    ASSERT_FALSE(same(tagsOf(*world), saved));
    WorldState copy = state;
    Status restored = world->restore(copy);
    ASSERT_TRUE(restored) << restored.error().message;
    EXPECT_TRUE(same(tagsOf(*world), saved));
    step(*world, 5);
    EXPECT_TRUE(same(tagsOf(*world), saved)) << "they stay";
    world->reset();
    EXPECT_TRUE(same(tagsOf(*world), first));

    const auto other = make(dam());  // as on another machine
    ASSERT_TRUE(other);
    ASSERT_TRUE(other->restore(state));
    EXPECT_TRUE(same(tagsOf(*other), saved));

    FluidParams without = dam();
    without.attributes.clear();
    without.blocks[0].attributes.clear();
    const auto plain = make(without);
    ASSERT_TRUE(plain);
    step(*plain, 3);
    WorldState old;
    plain->save(old);
    for (const auto& [name, bytes] : old.sections()) EXPECT_EQ(name.find("attribute"), std::string::npos) << "none costs nothing";
    WorldState before = old;
    restored = other->restore(old);
    ASSERT_FALSE(restored);
    EXPECT_NE(restored.error().message.find("attributes"), std::string::npos) << restored.error().message;
    // Of a version without attributes.
    Result<std::string> params = before.takeText("world.params");
    ASSERT_TRUE(params);
    std::istringstream lines(*params);
    std::string earlier;
    for (std::string line; std::getline(lines, line);)
        if (line.find("attributes") == std::string::npos) earlier += line + "\n";
    before.putText("world.params", earlier);
    restored = other->restore(before);
    ASSERT_TRUE(restored) << restored.error().message;
    EXPECT_TRUE(same(tagsOf(*other), first));
}

// The motion does not depend on them, to the bit, and a world without them has neither buffers nor passes for them.
TEST_P(Attributes, HaveNoEffectOnTheWater) {
    FluidParams without = dam();
    without.attributes.clear();
    without.blocks[0].attributes.clear();
    const auto plain = make(without);
    ASSERT_TRUE(plain);
    step(*plain, 10);
    for (const std::string& kernel : gpu_.device->kernels()) {
        EXPECT_EQ(kernel.find("attribute"), std::string::npos) << kernel;
        EXPECT_EQ(kernel.find("gather_vectors"), std::string::npos) << kernel;
    }
    EXPECT_TRUE(std::ranges::all_of(plain->particles().attributes, [](const Buffer* b) { return b == nullptr; }));
    const auto world = make(dam());
    ASSERT_TRUE(world);
    tagWithOrigins(*world);
    step(*world, 10);
    EXPECT_EQ(readParticles(*world).position, readParticles(*plain).position);
}

INSTANTIATE_TEST_SUITE_P(Devices, Attributes, testing::Values("cpu", "gl", "cl"), [](const auto& row) { return std::string(row.param); });

// Buffers of OpenGL, from each device and in the order in which particles are drawn: row i of each is the same particle.
class AttributesInGl : public testing::TestWithParam<std::tuple<const char*, const char*>> {};
TEST_P(AttributesInGl, AreThoseThatAreReadBack) {
    const auto [name, quality] = GetParam();
    TestGpu gpu;
    std::optional<ContextEgl> context;
    if (name == std::string("cpu")) {
        gpu.device = makeTestCpu();
    } else {
        Result<TestGpu> made = makeTestGpu(name);
        if (!made) GTEST_SKIP() << made.error().message;
        gpu = std::move(*made);
    }
    if (name != std::string("gl")) {
        Result<ContextEgl> made = ContextEgl::create();
        if (!made) {
            ASSERT_EQ(std::getenv("RIVULET_TEST_DEVICES"), nullptr) << made.error().message;
            GTEST_SKIP() << made.error().message;
        }
        context.emplace(std::move(*made));
    }
    {
        FluidParams p = dam();
        const bool calm = name == std::string("cpu");
        if (calm) {  // what sleeps is not brought over again unless it is painted
            p.method = "dfsph";
            p.spacing = 0.02F;
            p.sleep.on = true;
            p.box.max = vec3(0.6F, 0.3F, 0.1F);
            p.blocks[0].max = vec3(0.6F, 0.1F, 0.1F);
            p.blocks.pop_back();
        }
        auto world = FluidWorld::create(*gpu.device, p, {}, {});
        ASSERT_TRUE(world);
        tagWithOrigins(**world);
        FluidUpload upload;
        FluidSnapshot snapshot;
        FluidLookParams look;
        look.quality = quality;
        const auto compare = [&](const FluidView& view) {
            const std::map<uint32_t, Tag> tags = tagsOf(**world);
            std::vector<vec4> position(view.count), origin(view.count), team(view.count);
            const auto bytes = static_cast<GLsizeiptr>(view.count * sizeof(vec4));
            for (const auto& [buffer, to] : {std::pair(view.position, &position), std::pair(view.attributes[kOrigin], &origin),
                                             std::pair(view.attributes[kTeam], &team)}) {
                ASSERT_NE(buffer, 0U);
                glGetNamedBufferSubData(buffer, 0, bytes, to->data());
            }
            EXPECT_EQ(view.attributes[2], 0U);
            size_t drawn = 0;
            for (size_t i = 0; i < view.count; ++i) {
                if (position[i].w < 0) continue;
                const auto at = tags.find(static_cast<uint32_t>(origin[i].w));
                ASSERT_NE(at, tags.end());
                EXPECT_EQ(origin[i], at->second.origin);
                EXPECT_EQ(team[i], at->second.team);
                EXPECT_EQ(vec3(position[i]), at->second.position);
                ++drawn;
            }
            EXPECT_EQ(drawn, tags.size());
        };
        for (int k = 0; k < 4; ++k) {
            step(**world, 2);
            for (int n = 0; calm && k == 1 && (*world)->particles().asleep == 0 && n < 300; ++n) step(**world, 1);
            const Result<FluidView> view = upload.view(**world, look);
            ASSERT_TRUE(view);
            compare(*view);
            ASSERT_TRUE((*world)->paint(kTeam, {.position = vec3(0.2F * static_cast<float>(k)), .size = vec3(0.5F)}, kRed * (k + 1.0F)));
            const Result<FluidView> painted = upload.view(**world, look);
            ASSERT_TRUE(painted);
            compare(*painted);
            EXPECT_EQ(painted->asleep > 0, calm && k > 0);
            ASSERT_TRUE(snapshot.take(**world));
            FluidUpload ofSnapshot;
            const Result<FluidView> copied = ofSnapshot.view(snapshot, look);
            ASSERT_TRUE(copied);
            compare(*copied);
        }
        EXPECT_EQ(glGetError(), GLenum{GL_NO_ERROR});
    }
    gpu.device.reset();
}
INSTANTIATE_TEST_SUITE_P(Devices, AttributesInGl, testing::Combine(testing::Values("cpu", "gl", "cl"), testing::Values("fine", "fast")),
                         [](const auto& row) { return std::string(std::get<0>(row.param)) + "_" + std::get<1>(row.param); });

// Neither a write that would be skipped is reported as done, nor does a stop that has ended matter.
TEST(AttributesAre, NotSetDuringAStop) {
    const auto device = makeTestCpu();
    auto world = FluidWorld::create(*device, dam(), {}, {});
    ASSERT_TRUE(world);
    std::atomic<bool> stop = true;
    device->stopOn(&stop);
    const uint32_t ids[] = {0};
    const Volume all{.size = vec3(100.0F)};
    EXPECT_FALSE((*world)->setAttribute(1, ids, std::span(&kRed, 1)));
    EXPECT_FALSE((*world)->paint(1, all, kRed));
    stop = false;
    EXPECT_TRUE((*world)->paint(1, all, kRed));
    const ParticleView view = (*world)->particles();
    size_t red = 0;
    for (const vec4& value : device->readAll<vec4>(*view.attributes[1], view.count)) red += value == kRed ? 1 : 0;
    EXPECT_GE(red, (*world)->stats().particles);
    device->stopOn(nullptr);
}

TEST(AttributesAre, RefusedInASentence) {
    const auto device = makeTestCpu();
    const auto refused = [&](const auto& change) {
        FluidParams p = dam();
        Sources sources;
        sources.emitters.resize(1);
        change(p, sources);
        const auto world = FluidWorld::create(*device, p, {}, {}, sources);
        return world ? std::string() : world.error().message;
    };
    EXPECT_EQ(refused([](FluidParams&, Sources&) {}), "");
    EXPECT_EQ(refused([](FluidParams& p, Sources&) { p.attributes.resize(5, {.name = "dye"}); }),
              "fluid.attributes has 5, and 4 are possible: put up to four numbers into one");
    EXPECT_EQ(refused([](FluidParams& p, Sources&) { p.attributes[1].name = "origin"; }),
              "fluid.attributes has 'origin' twice: give each its own name");
    EXPECT_EQ(refused([](FluidParams& p, Sources&) { p.attributes[1].name = ""; }), "fluid.attributes[1].name is empty: give it a name");
    EXPECT_EQ(refused([](FluidParams& p, Sources&) { p.blocks[0].attributes[0].name = "teem"; }),
              "fluid.blocks[0].attributes[0].name is 'teem', and fluid.attributes has origin, team: add it there");
    EXPECT_EQ(refused([](FluidParams&, Sources& s) { s.emitters[0].params.attributes = {{.name = "age"}}; }),
              "emitters[0].attributes[0].name is 'age', and fluid.attributes has origin, team: add it there");

    auto world = FluidWorld::create(*device, dam(), {}, {});
    ASSERT_TRUE(world);
    const auto said = [](const Status& s) { return s ? std::string() : s.error().message; };
    const uint32_t ids[] = {0, 100000};
    const vec4 values[] = {kRed, vec4(0, NAN, 0, 0)};
    EXPECT_EQ(said((*world)->setAttribute(2, {}, {})), "there is no attribute 2: fluid.attributes has 2");
    EXPECT_EQ(said((*world)->setAttribute(0, ids, std::span(values, 1))), "1 values were given for 2 particles: give one for each");
    EXPECT_EQ(said((*world)->setAttribute(0, ids, std::vector<vec4>{kRed, kRed})),
              "ids[1] is 100000, and ids are below " + std::to_string((*world)->particles().count) + ": use those of the particles now");
    EXPECT_EQ(said((*world)->setAttribute(0, std::vector<uint32_t>{0, 1}, values)), "values[1] of attribute 0 is not finite: correct it");
    EXPECT_EQ(said((*world)->paint(0, {}, values[1])), "the value of attribute 0 is not finite: correct it");
    EXPECT_EQ(said((*world)->paint(0, {.shape = Volume::sphere, .radius = -1}, kRed)),
              "the volume to paint has a position or size that is invalid: use metres, none negative");
    EXPECT_EQ(tagsOf(**world).at(0).origin, vec4(0.0F)) << "nothing has changed";
}

}  // namespace
}  // namespace rivulet::attributes_parity_test
