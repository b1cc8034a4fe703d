// Watched volumes: at all times their count equals the particles inside, and those that entered minus those that left.
#include "fluid/sim/query/volumes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/parity/devices.h"

namespace rivulet::volumes_test {
namespace {

constexpr float kSpacing = 0.03125F;
constexpr double kOne = 0x1p-15;  // m^3, of a particle

// A column that falls over, in a box of 0.5 m.
FluidParams column() {
    FluidParams p;
    p.method = "pbf";
    p.spacing = kSpacing;
    p.box.max = vec3(0.5F);
    p.blocks = {{vec3(0.0F), vec3(0.1875F, 0.4F, 0.5F), vec3(0.0F)}};
    return p;
}

std::unique_ptr<FluidWorld> make(Device& device, const Sources& sources = {}) {
    auto world = FluidWorld::create(device, column(), {}, {}, sources);
    EXPECT_TRUE(world) << (world ? "" : world.error().message);
    return world ? std::move(*world) : nullptr;
}

const std::vector<Volume> kThree = {{7, Volume::box, vec3(0.35F, 0.1F, 0.25F), vec3(0.2F, 0.2F, 0.4F)},
                                    {3, Volume::sphere, vec3(0.1F, 0.2F, 0.2F), {}, 0.12F},
                                    {40, Volume::box, vec3(0.25F), vec3(5.0F)}};

// Ids of the particles inside a volume.
std::map<uint32_t, bool> held(FluidWorld& world, const Volume& v) {
    const ParticleView view = world.particles();
    const std::vector<vec4> x = world.device().readAll<vec4>(*view.position, view.slots);
    const std::vector<uint32_t> id = world.device().readAll<uint32_t>(*view.id, view.slots);
    std::map<uint32_t, bool> in;
    for (size_t i = 0; i < x.size(); ++i) {
        const dvec3 d = dvec3(x[i]) - dvec3(v.position);
        const dvec3 half = 0.5 * dvec3(v.size);
        const bool inside = v.shape == Volume::sphere ? glm::dot(d, d) <= double{v.radius} * double{v.radius}
                                                      : std::abs(d.x) <= half.x && std::abs(d.y) <= half.y && std::abs(d.z) <= half.z;
        if (!(x[i].w < 0) && inside) in[id[i]] = true;
    }
    return in;
}

TEST(Volumes, CountsEqualTheParticlesInsideAfterEachStep) {
    auto device = makeTestCpu();
    auto world = make(*device);
    std::vector<Volume> volumes = kThree;
    ASSERT_TRUE(world->setVolumes(volumes));
    for (const VolumeCount& c : world->volumes()) EXPECT_EQ(c.inside + c.entered + c.left, 0U) << "nothing is counted before a step";
    std::vector<std::map<uint32_t, bool>> before(3);
    std::vector<uint64_t> entered(3), left(3);
    for (int frame = 0; frame < 40; ++frame) {
        volumes[1].position.x += 0.008F;  // it moves, through the water
        ASSERT_TRUE(world->setVolumes(volumes));
        world->step({}, 1.0 / 60);
        const std::vector<VolumeCount> counts = world->volumes();
        ASSERT_EQ(counts.size(), 3U);
        std::map<uint32_t, VolumeCount> events;
        for (const VolumeCount& e : world->takeVolumeEvents()) events[e.id] = e;
        for (size_t k = 0; k < 3; ++k) {
            const std::map<uint32_t, bool> now = held(*world, volumes[k]);
            uint64_t came = 0, went = 0;
            for (const auto& [id, in] : now) came += before[k].count(id) == 0 ? 1 : 0;
            for (const auto& [id, in] : before[k]) went += now.count(id) == 0 ? 1 : 0;
            entered[k] += came;
            left[k] += went;
            before[k] = now;
            EXPECT_EQ(counts[k].id, volumes[k].id);
            EXPECT_EQ(counts[k].inside, now.size()) << frame << " " << k;
            EXPECT_EQ(counts[k].entered, entered[k]) << frame << " " << k;
            EXPECT_EQ(counts[k].left, left[k]) << frame << " " << k;
            EXPECT_EQ(counts[k].time, world->time());
            EXPECT_NEAR(counts[k].volumeInside(), static_cast<double>(now.size()) * kOne, 1e-12);
            EXPECT_EQ(events.count(volumes[k].id), came + went > 0 ? 1U : 0U);
            if (came + went > 0) {
                EXPECT_EQ(events[volumes[k].id].entered, came);
                EXPECT_EQ(events[volumes[k].id].left, went);
                EXPECT_EQ(events[volumes[k].id].inside, now.size());
            }
        }
    }
    for (size_t k = 0; k < 2; ++k) EXPECT_GT(entered[k], 50U) << k;
    EXPECT_GT(left[1], 50U);
    EXPECT_EQ(left[2], 0U) << "nobody leaves the box";
    EXPECT_TRUE(world->takeVolumeEvents().empty());
}

// Emitters, sinks and exchange: a spawned or removed particle counts as entered or left.
TEST(Volumes, SpawnedParticlesEnterAndRemovedOnesLeave) {
    auto device = makeTestCpu();
    Sources sources;
    sources.expectedDeposit = 100 * kOne;
    sources.sinks.push_back({.shape = "box", .position = vec3(0.45F, 0.05F, 0.25F), .size = vec3(0.1F, 0.1F, 0.5F)});
    sources.emitters.push_back(
        {.params = {.litresPerSecond = 4.0F, .position = vec3(0.4F, 0.45F, 0.25F), .radius = 0.06F}, .triangles = {}});
    auto world = make(*device, sources);
    ASSERT_TRUE(world->setVolumes(kThree));
    for (int frame = 0; frame < 40; ++frame) {
        if (frame % 10 == 5) {
            std::vector<uint32_t> slots;
            for (const WorldParticle& p : world->within({vec3(0.0F), vec3(0.2F, 0.1F, 0.3F)})) slots.push_back(p.slot);
            world->withdraw(slots);
        }
        world->step({}, 1.0 / 60);
        const std::vector<VolumeCount> counts = world->volumes();
        for (size_t k = 0; k < 3; ++k) {
            EXPECT_EQ(counts[k].inside, held(*world, kThree[k]).size()) << frame << " " << k;
            EXPECT_EQ(counts[k].inside, counts[k].entered - counts[k].left);
        }
    }
    EXPECT_GT(world->stats().drained, 10 * kOne);
    EXPECT_GT(world->stats().withdrawn, 10 * kOne);
    const VolumeCount all = world->volumes()[2];
    EXPECT_NEAR(static_cast<double>(all.inside) * kOne, world->stats().emitted - world->stats().drained - world->stats().withdrawn, 1e-12);
    EXPECT_GT(all.left, 20U);
}

TEST(Volumes, AVolumeThatReplacesAnotherBeginsEmpty) {
    auto device = makeTestCpu();
    auto world = make(*device);
    ASSERT_TRUE(world->setVolumes(kThree));
    world->step({}, 1.0 / 60);
    const uint64_t whole = world->volumes()[2].inside;
    EXPECT_GT(whole, 100U);
    EXPECT_GT(world->volumes()[1].inside, 50U);
    // Volume 3, which held particles, is removed; 40 and 7 stay; 8 is new and reuses the bit of 3.
    std::vector<Volume> next = {kThree[1], kThree[2], kThree[0]};
    next[0].id = 8;
    next[0].shape = Volume::box;
    next[0].position = vec3(0.25F);
    next[0].size = vec3(5.0F);
    ASSERT_TRUE(world->setVolumes(next));
    EXPECT_EQ(world->volumes()[0].inside, 0U);
    EXPECT_EQ(world->volumes()[1].inside, whole);
    world->step({}, 1.0 / 60);
    EXPECT_EQ(world->volumes()[0].entered, whole);
    EXPECT_EQ(world->volumes()[1].entered, whole);
    world->reset();
    EXPECT_EQ(world->volumes()[1].entered, 0U);
    world->step({}, 1.0 / 60);
    EXPECT_EQ(world->volumes()[1].inside, whole);
    ASSERT_TRUE(world->setVolumes({}));
    EXPECT_TRUE(world->volumes().empty());
}

TEST(Volumes, InvalidVolumesAreRefused) {
    auto device = makeTestCpu();
    auto world = make(*device);
    ASSERT_TRUE(world->setVolumes(kThree));
    std::vector<Volume> wrong = kThree;
    wrong[1].id = 7;
    EXPECT_NE(world->setVolumes(wrong).error().message.find("two volumes have the id 7"), std::string::npos);
    wrong = kThree;
    wrong[0].size.y = -1;
    EXPECT_FALSE(world->setVolumes(wrong));
    wrong = kThree;
    wrong[0].position.x = NAN;
    EXPECT_FALSE(world->setVolumes(wrong));
    wrong.clear();
    for (uint32_t k = 0; k < 33; ++k) wrong.push_back({k});
    EXPECT_FALSE(world->setVolumes(wrong));
    EXPECT_EQ(world->volumes().size(), 3U) << "all stays as it was";
}

// A saved world keeps its counts, for any volumes of the world that restores it.
TEST(Volumes, ASavedWorldKeepsItsCounts) {
    auto device = makeTestCpu();
    auto a = make(*device), b = make(*device);
    ASSERT_TRUE(a->setVolumes(kThree));
    ASSERT_TRUE(b->setVolumes(std::vector<Volume>{{99}, {7}}));
    for (int k = 0; k < 12; ++k) a->step({}, 1.0 / 60);
    (void)a->takeVolumeEvents();
    for (int k = 0; k < 3; ++k) a->step({}, 1.0 / 60);
    b->step({}, 1.0 / 60);
    WorldState state;
    a->save(state);
    const Status restored = b->restore(state);
    ASSERT_TRUE(restored) << restored.error().message;
    for (int k = 0; k < 10; ++k)
        for (FluidWorld* w : {a.get(), b.get()}) w->step({}, 1.0 / 60);
    const std::vector<VolumeCount> x = a->volumes(), y = b->volumes(), e = a->takeVolumeEvents(), f = b->takeVolumeEvents();
    ASSERT_EQ(x.size(), y.size());
    ASSERT_EQ(e.size(), f.size());
    for (size_t k = 0; k < x.size(); ++k) {
        EXPECT_EQ(x[k].id, y[k].id);
        EXPECT_EQ(x[k].entered, y[k].entered);
        EXPECT_EQ(x[k].left, y[k].left);
        EXPECT_EQ(y[k].inside, held(*b, kThree[k]).size());
    }
    for (size_t k = 0; k < e.size(); ++k) EXPECT_EQ(e[k].entered, f[k].entered);
    // Modified counts are detected.
    WorldState wrong;
    a->save(wrong);
    std::vector<uint64_t> numbers = *wrong.take<uint64_t>("volumes.numbers", 15);
    ++numbers[1];
    wrong.put<uint64_t>("volumes.numbers", numbers);
    EXPECT_FALSE(b->restore(wrong));
}

}  // namespace
}  // namespace rivulet::volumes_test
