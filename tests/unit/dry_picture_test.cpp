// Volumes that stay dry, in a host's picture: the eye looks from above into a well in the water and sees the host's floor.
#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <cmath>
#include <memory>
#include <vector>

#include "engine/gpu/buffer.h"
#include "fluid/render/fluid_snapshot.h"
#include "fluid/render/fluid_upload.h"
#include "shaders/fluid/solids/body_state.h"
#include "tests/unit/host_water.h"

namespace rivulet::dry_picture_test {
namespace {

using testing::HostScene;
constexpr int kWidth = 240, kHeight = 240;

// Straight down from 2 m above the middle.
void fromAbove(FrameView& v) {
    v.cameraPosWorld = vec3(0.5F, 2.0F, 0.5F);
    v.view = glm::lookAt(v.cameraPosWorld, vec3(0.5F, 0.0F, 0.5F), vec3(0, 0, -1));
}

struct Changed {
    size_t within = 0, seen = 0, elsewhere = 0;  // pixels of the well that show water, of all of them; other pixels that do
};

class DryPicture : public testing::HostWater {
  protected:
    DryPicture() : HostWater(0) {}
    // `isWell`: whether the floor at x, z is seen through the volume alone.
    template <class Well>
    Changed draw(const FluidView& fluid, const FluidLookParams& params, const Well& isWell) {
        const HostScene host(kWidth, kHeight, {.camera = fromAbove});
        const std::vector<vec4> before = host.pixels();
        const std::vector<float> depths = host.depths();
        const std::vector<vec3> places = host.places();
        const Result<FluidLook> look = fluidLookOf(params, "");
        EXPECT_TRUE(look);
        const Status drawn = renderer_->draw(host.view(), fluid, *look, host.target());
        EXPECT_TRUE(drawn) << drawn.error().message;
        const std::vector<vec4> after = host.pixels();
        const std::vector<float> now = host.depths();
        Changed changed;
        for (size_t k = 0; k < before.size(); ++k) {
            const bool water = after[k] != before[k] || now[k] != depths[k];
            const bool well = isWell(vec2(places[k].x, places[k].z));
            changed.seen += well ? 1 : 0;
            (well ? changed.within : changed.elsewhere) += water ? 1 : 0;
        }
        return changed;
    }
};

TEST_F(DryPicture, ShowsNoWaterInAWell) {
    // They reach from below the floor to above the water, which is 0.4 m deep: both shapes are as wide at the floor as at its surface.
    const DryParams box{.position = vec3(0.5F, 0.2F, 0.5F), .rotation = vec3(0, 25, 0), .size = vec3(0.32F, 1.2F, 0.22F)};
    const DryParams round{.shape = "ellipsoid", .position = vec3(0.5F, 0.2F, 0.5F), .size = vec3(0.3F, 1.2F, 0.24F)};
    const auto inBox = [](vec2 p) {
        const float angle = glm::radians(25.0F), x = p.x - 0.5F, z = p.y - 0.5F;
        return std::abs(std::cos(angle) * x - std::sin(angle) * z) < 0.158F && std::abs(std::sin(angle) * x + std::cos(angle) * z) < 0.108F;
    };
    const auto inRound = [](vec2 p) { return glm::length((p - 0.5F) / vec2(0.15F, 0.12F)) < 0.93F; };  // sqrt(1 - (0.2 / 0.6)^2): 0.943
    for (const char* quality : {"fine", "fast"})
        for (const bool isBox : {true, false}) {
            FluidParams p = testing::hostWater();
            p.spacing = 0.03F;
            Sources sources{.dry = {isBox ? box : round}};
            auto world = FluidWorld::create(*device_, p, {}, {}, sources);
            ASSERT_TRUE(world) << world.error().message;
            FluidLookParams look;
            look.quality = quality;
            const auto well = [&](vec2 at) { return isBox ? inBox(at) : inRound(at); };
            FluidUpload upload;
            const Result<FluidView> fluid = upload.view(**world, look);
            ASSERT_TRUE(fluid);
            const Changed cut = draw(*fluid, look, well);
            EXPECT_EQ(cut.within, 0U) << quality << (isBox ? ", box, of " : ", ellipsoid, of ") << cut.seen;
            EXPECT_GT(cut.seen, 500U);
            EXPECT_GT(cut.elsewhere, 5000U) << "the water around it is drawn";

            FluidView whole = *fluid;
            whole.dry.clear();
            const Changed uncut = draw(whole, look, well);
            EXPECT_GT(uncut.within, 50U) << "the surface reaches beyond its particles";
            EXPECT_GT(static_cast<double>(cut.elsewhere), 0.9 * static_cast<double>(uncut.elsewhere)) << "no more is cut than its rim";

            FluidSnapshot snapshot;
            ASSERT_TRUE(snapshot.take(**world));
            const Result<FluidView> taken = upload.view(snapshot, look);
            ASSERT_TRUE(taken);
            EXPECT_EQ(draw(*taken, look, well).within, 0U);

            // It moves away: the picture follows with the next view.
            sources.dry[0].position.y = 3;
            ASSERT_TRUE((*world)->setSources(sources));
            const Result<FluidView> moved = upload.view(**world, look);
            ASSERT_TRUE(moved);
            EXPECT_EQ(draw(*moved, look, well).within, uncut.within);
        }
}

// A volume of a body that a GPU moves is given in the body's frame: the picture cuts it where the rows on the device have the body, and not
// where another body is.
TEST_F(DryPicture, CutsWhereTheDeviceHasTheBody) {
    FluidParams p = testing::hostWater();
    p.spacing = 0.03F;
    const DryParams box{.position = vec3(0.5F, 0.2F, 0.5F), .rotation = vec3(0, 25, 0), .size = vec3(0.32F, 1.2F, 0.22F)};
    auto world = FluidWorld::create(*device_, p, {}, {}, Sources{.dry = {box}});
    ASSERT_TRUE(world) << world.error().message;
    FluidLookParams look;
    FluidUpload upload;
    Result<FluidView> fluid = upload.view(**world, look);
    ASSERT_TRUE(fluid);
    const auto well = [](vec2 at) {
        const float angle = glm::radians(25.0F), x = at.x - 0.5F, z = at.y - 0.5F;
        return std::abs(std::cos(angle) * x - std::sin(angle) * z) < 0.158F && std::abs(std::sin(angle) * x + std::cos(angle) * z) < 0.108F;
    };
    const Changed inWorld = draw(*fluid, look, well);
    const Pose body{vec3(0.3F, 0.4F, 0.9F), glm::angleAxis(1.1F, glm::normalize(vec3(1, -2, 0.5F)))};
    std::vector<DeviceBody> rows(2, DeviceBody{});
    rows[0].position = vec4(5, 5, 5, 0);
    rows[0].rotation = vec4(0, 0, 0, 1);
    rows[1].position = vec4(body.position, 0.0F);
    rows[1].rotation = vec4(body.rotation.x, body.rotation.y, body.rotation.z, body.rotation.w);
    const Result<gpu::Buffer> onDevice = gpu::Buffer::from(rows);
    ASSERT_TRUE(onDevice) << onDevice.error().message;
    fluid->bodies = onDevice->name();
    fluid->bodyCount = 2;
    fluid->bodiesMoved = std::make_shared<const char>();
    DryVolume& v = fluid->dry.at(0);
    const quat turn = glm::conjugate(body.rotation) * quat(v.turn.w, v.turn.x, v.turn.y, v.turn.z);
    v.centre = vec4(body.toOwn(vec3(v.centre)), v.centre.w);
    v.turn = vec4(turn.x, turn.y, turn.z, turn.w);
    v.reach.w = 2;
    const Changed moved = draw(*fluid, look, well);
    EXPECT_EQ(moved.within, 0U);
    EXPECT_NEAR(static_cast<double>(moved.elsewhere), static_cast<double>(inWorld.elsewhere), 20);
    v.reach.w = 1;
    EXPECT_GT(draw(*fluid, look, well).within, 50U) << "the other body is far away";
}

}  // namespace
}  // namespace rivulet::dry_picture_test
