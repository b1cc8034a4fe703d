// Files that version 0.1.0 wrote (before fluid/bridge became scene, session and viewer) are still read: tests/unit/version_0_1_0/ holds
//     rivulet run small.json --headless --no-render --backend cpu --frames 2 --save small.rstate --record small.rrec
//     rivulet voxelize tetrahedron.obj --resolution 8 --out small.rvox
// The defaults of fluid.supportSpacings and fluid.blocks[].jitter have changed since, so small.json names the old ones.
// A change of a format either reads these, or refuses them with a sentence that names both versions; then this test says so.
#include <gtest/gtest.h>

#include <bit>

#include "fluid/render/backend.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/world_state.h"
#include "fluid/voxel/voxel_file.h"

namespace rivulet::version_0_1_0_test {
namespace {

const std::string kFolder = RIVULET_SOURCE_DIR "/tests/unit/version_0_1_0/";
constexpr double kSaved = 2.0 / kFramesPerSecond;  // s

class Version010 : public ::testing::Test {
  protected:
    void SetUp() override {
        Result<SceneFile> scene = loadScene(kFolder + "small.json", {});
        ASSERT_TRUE(scene) << scene.error().message;
        Result<std::unique_ptr<Session>> session = Session::create(*scene, *device_, {});
        ASSERT_TRUE(session) << session.error().message;
        session_ = std::move(*session);
    }

    std::unique_ptr<Device> device_ = makeCpu();
    std::unique_ptr<Session> session_;
};

TEST_F(Version010, AStateIsReadAndContinues) {
    Result<WorldState> state = readState(kFolder + "small.rstate");
    ASSERT_TRUE(state) << state.error().message;
    const Status restored = session_->restore(*state);
    ASSERT_TRUE(restored) << restored.error().message;
    EXPECT_TRUE(state->allTaken()) << "a section that nothing reads";
    EXPECT_NEAR(session_->time(), kSaved, 1e-6);
    EXPECT_EQ(session_->world().particles().count, 60U);
    session_->step(kSaved, true);
    EXPECT_NEAR(session_->time(), 2 * kSaved, 1e-6);
    EXPECT_EQ(session_->world().stats().lost, 0U);
}

TEST_F(Version010, ARecordingIsShown) {
    Result<Replay> replay = Replay::open(kFolder + "small.rrec", session_->scene(), {});
    ASSERT_TRUE(replay) << replay.error().message;
    EXPECT_EQ(replay->frames(), 2U);
    EXPECT_EQ(replay->shown().position.size(), 60U);
    const Status shown = session_->replay(std::move(*replay));
    ASSERT_TRUE(shown) << shown.error().message;
    session_->seek(1);
    session_->step(kSaved, true);
    EXPECT_TRUE(session_->replayed());
    EXPECT_NEAR(session_->time(), kSaved, 1e-6);
}

TEST(Version010Voxels, AreRead) {
    const Result<VoxelFile> file = readVoxelFile(kFolder + "small.rvox");
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->mode, VoxelMode::solid);
    EXPECT_EQ(file->bits.size, ivec3(8));
    size_t set = 0;
    for (const uint8_t byte : file->bits.bits) set += static_cast<size_t>(std::popcount(byte));
    EXPECT_EQ(set, 162U) << "158 voxels of the surface and 4 inside, as 0.1.0 printed";
}

}  // namespace
}  // namespace rivulet::version_0_1_0_test
