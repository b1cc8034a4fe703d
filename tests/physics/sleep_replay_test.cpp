// A session with sleeping water: two runs with the same changes of sliders are equal, a run continued from a saved state is equal to them,
// and a replay of the recording shows the same frames.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "fluid/session/session.h"
#include "tests/physics/worlds.h"

namespace rivulet::sleep_replay_test {
namespace {

constexpr int kFrames = 130, kLook = 45, kTilt = 50, kSaved = 84, kFriction = 90, kJet = 110;

// A pool with a ball that floats, and a jet that begins later.
SceneFile scene(const std::string& method) {
    SceneFile s;
    s.name = "calm";
    s.fluid.method = method;
    s.fluid.spacing = 0.04F;
    s.fluid.ellipsoids = true;
    s.fluid.sleep.on = true;
    s.fluid.sleep.speed = 0.15F;  // soon
    s.fluid.sleep.after = 1.5F;
    s.fluid.box.max = vec3(0.64F, 0.6F, 0.32F);
    s.fluid.blocks = {{.min = vec3(0.0F), .max = vec3(0.64F, 0.2F, 0.32F)}};
    s.emitters.resize(1);
    s.emitters[0].position = vec3(0.5F, 0.45F, 0.16F);
    s.emitters[0].litresPerSecond = 2;
    s.emitters[0].start = static_cast<float>(kJet) / 60;
    s.bodies.resize(1);
    s.bodies[0].shape = "sphere";
    s.bodies[0].radius = 0.06F;
    s.bodies[0].position = vec3(0.15F, 0.2F, 0.16F);
    return s;
}

// The sliders as a person leaves them before frame k.
void drag(SceneFile& s, int k) {
    if (k == 20) s.fluid.artificialViscosity = 0.05F;
    if (k == kLook) s.look.smoothing = 0.5F;
    if (k == kTilt) s.fluid.gravity = vec3(0.3F, -9.81F, 0);
    if (k == kFriction) s.fluid.collision.friction = 0.1F;
    if (k == kJet + 8) s.emitters[0].litresPerSecond = 3;
}

std::unique_ptr<Session> open(Device& device, const SceneFile& scene) {
    auto session = Session::create(scene, device, {});
    EXPECT_TRUE(session) << (session ? "" : session.error().message);
    return session ? std::move(*session) : nullptr;
}

template <class T>
bool sameBits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}
bool same(const RecordedFrame& a, const RecordedFrame& b) {
    bool all = a.time == b.time;
    for (size_t k = 0; k < a.ellipsoids.size(); ++k) all = all && sameBits(a.ellipsoids[k], b.ellipsoids[k]);
    return all && sameBits(a.position, b.position) && sameBits(a.velocity, b.velocity) && sameBits(a.id, b.id) &&
           sameBits(a.places, b.places);
}

struct Course {
    std::vector<RecordedFrame> frames;
    std::vector<uint32_t> asleep;
};
// Frames `first` to kFrames. `saved`: receives the state before frame kSaved.
Course play(Session& session, SceneFile sliders, int first, std::string* saved = nullptr) {
    Course c;
    for (int k = first; k < kFrames; ++k) {
        if (k == kSaved && saved != nullptr) {
            WorldState state;
            session.save(state);
            Result<std::string> bytes = packState(state);
            EXPECT_TRUE(bytes);
            if (bytes) *saved = *bytes;
        }
        drag(sliders, k);
        session.apply(sliders);
        session.step(1.0 / 60, true);
        c.frames.push_back(frameOf(session));
        c.asleep.push_back(session.world().stats().asleep);
    }
    return c;
}

class SleepReplay : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Methods, SleepReplay, testing::Values("dfsph", "pbf", "wcsph"),
                         [](const auto& of) { return std::string(of.param); });

TEST_P(SleepReplay, SlidersASavedStateAndARecordingChangeNoBit) {
    auto device = cpu();
    const SceneFile start = scene(GetParam());
    SceneFile later = start;
    for (int k = 0; k < kSaved; ++k) drag(later, k);
    auto first = open(*device, start), second = open(*device, start), third = open(*device, later);
    ASSERT_TRUE(first && second && third);
    std::string bytes;
    const Course a = play(*first, start, 0), b = play(*second, start, 0, &bytes);
    for (size_t k = 0; k < kFrames; ++k) ASSERT_TRUE(same(a.frames[k], b.frames[k])) << "frame " << k;

    Result<WorldState> state = unpackState(std::as_bytes(std::span(bytes)), "state");
    ASSERT_TRUE(state) << state.error().message;
    const Status back = third->restore(*state);
    ASSERT_TRUE(back) << back.error().message;
    const Course c = play(*third, later, kSaved);
    for (size_t k = kSaved; k < kFrames; ++k) ASSERT_TRUE(same(a.frames[k], c.frames[k - kSaved])) << "frame " << k << ", continued";

    const std::string path = (std::filesystem::path(testing::TempDir()) / fmt::format("sleep_{}.rrec", GetParam())).string();
    Result<RecordingWriter> file = RecordingWriter::open(path, aboutOf(start));
    ASSERT_TRUE(file);
    for (const RecordedFrame& frame : a.frames) ASSERT_TRUE(file->add(frame));
    ASSERT_TRUE(file->close());
    Result<Replay> replay = Replay::open(path, start, {});
    ASSERT_TRUE(replay) << replay.error().message;
    ASSERT_TRUE(second->replay(std::move(*replay)));
    for (size_t k = 0; k < kFrames; ++k) {
        second->step(1.0 / 60, true);
        const RecordedFrame& frame = second->replaying()->shown();
        ASSERT_TRUE(same(frame, a.frames[k])) << "frame " << k << ", recorded";
        const auto n = std::count_if(frame.velocity.begin(), frame.velocity.end(), [](const vec4& v) { return v.w < 0; });
        EXPECT_EQ(static_cast<uint32_t>(n), a.asleep[k]) << "what sleeps is drawn as such";
    }
    std::filesystem::remove(path);

    // The course has all of it: water that sleeps, before the state is saved and after; that sleeps on while a slider of the look moves;
    // that a slider of the fluid wakes, and the jet.
    const auto asleep = [&](size_t k) { return a.asleep[k]; };
    EXPECT_GT(asleep(kLook - 1), 100U);
    EXPECT_GE(asleep(kLook), asleep(kLook - 1));
    EXPECT_EQ(asleep(kTilt), 0U) << "all of it is disturbed";
    EXPECT_GT(asleep(kSaved - 1), 0U);
    EXPECT_EQ(asleep(kFriction), 0U);
    EXPECT_GT(asleep(kJet - 1), 100U);
    EXPECT_LT(asleep(kFrames - 1), asleep(kJet - 1));
    EXPECT_GT(a.frames.back().id.size(), a.frames.front().id.size()) << "the jet runs";
}

}  // namespace
}  // namespace rivulet::sleep_replay_test
