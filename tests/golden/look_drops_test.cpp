// Drops in the air: their size, the inverted image in them, occlusion by objects in front, and elongation at high speed.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/golden/look_fixture.h"

namespace rivulet::look_drops_test {
namespace {

constexpr int kSize = 200;

class LookDrops : public LookTest {
  protected:
    void SetUp() override {
        LookTest::SetUp();
        if (IsSkipped()) return;
        settings.background.showBox = settings.background.showFloor = false;
        settings.background.horizon = settings.background.zenith = vec3(0.8F);
        settings.fluid.box = {.min = vec3(-0.05F), .max = vec3(0.05F)};
        camera.position = vec3(0, 0, 0.4F);
        camera.target = vec3(0.0F);
        camera.fieldOfView = 30;
        camera.nearPlane = 0.01F;
        camera.farPlane = 50;
    }
    // A black one, across the line of sight.
    void addWall(const vec3& low, const vec3& high) {
        Mesh mesh;
        mesh.positions = {low, vec3(high.x, low.y, low.z), high, vec3(low.x, high.y, low.z)};
        mesh.normals.assign(4, vec3(0, 0, 1));
        mesh.indices = {0, 1, 2, 0, 2, 3};
        Node wall;
        wall.mesh = std::make_shared<const Mesh>(std::move(mesh));
        wall.material.baseColour = vec3(0.01F);
        scene.add(std::move(wall));
    }
    std::vector<uint8_t> with(std::vector<vec4> drops) {
        FluidView view;
        gpu::Buffer buffer;
        if (!drops.empty()) {
            buffer = std::move(*gpu::Buffer::from(drops));
            view.drops = buffer.name();
            view.dropCount = static_cast<uint32_t>(drops.size() / 2);
        }
        return picture(camera, kSize, kSize, view);
    }
    struct Changed {
        int count = 0, wide = 0, high = 0;
    };
    static Changed between(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b, bool upright = false) {
        Changed c;
        int low[2] = {kSize, kSize}, top[2] = {-1, -1};
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x) {
                if (std::abs((upright ? x : y) - kSize / 2) < 4) continue;  // the wall's edge is smoothed otherwise
                int off = 0;
                for (size_t k = 0; k < 3; ++k) {
                    const size_t at = 4 * (static_cast<size_t>(y) * kSize + static_cast<size_t>(x)) + k;
                    off = std::max(off, std::abs(int{a[at]} - int{b[at]}));
                }
                if (off < 6) continue;
                ++c.count;
                low[0] = std::min(low[0], x), top[0] = std::max(top[0], x);
                low[1] = std::min(low[1], y), top[1] = std::max(top[1], y);
            }
        if (c.count > 0) c.wide = top[0] - low[0] + 1, c.high = top[1] - low[1] + 1;
        return c;
    }
    static int bright(const std::vector<uint8_t>& p, int x, int y) {
        return p[4 * (static_cast<size_t>(y) * kSize + static_cast<size_t>(x)) + 1];
    }
    Camera camera;
};

TEST_F(LookDrops, AreAsLargeAsTheyAreAndTurnThingsUpsideDown) {
    addWall(vec3(-1, -1, -0.1F), vec3(1, 0, -0.1F));  // bright above, dark below
    const float radius = 0.02F, pixels = 0.5F * kSize / std::tan(0.5F * camera.fieldOfView * 0.01745329F) / 0.4F * radius;
    const std::vector<uint8_t> none = with({}), one = with({vec4(0, 0, 0, radius), vec4(0.0F)});
    const Changed c = between(none, one);
    EXPECT_NEAR(c.wide, 2 * pixels, 4);
    EXPECT_NEAR(c.high, 2 * pixels, 4);
    EXPECT_GT(c.count, 0.6 * 3.14159 * static_cast<double>(pixels * pixels));
    const int off = static_cast<int>(0.5F * pixels), middle = kSize / 2;
    EXPECT_GT(bright(none, middle, middle - off), bright(none, middle, middle + off) + 60);
    EXPECT_LT(bright(one, middle, middle - off) + 60, bright(one, middle, middle + off));
}

TEST_F(LookDrops, AreDrawnOutAlongTheirWay) {
    addWall(vec3(-1, -1, -0.1F), vec3(0, 1, -0.1F));
    const std::vector<uint8_t> none = with({});
    const auto seen = [&](const vec3& velocity) { return between(none, with({vec4(0, 0, 0, 0.01F), vec4(velocity, 0.0F)}), true); };
    const Changed still = seen(vec3(0.0F)), fast = seen(vec3(0, -5, 0));
    EXPECT_NEAR(still.wide, still.high, 3);
    // 5 m/s in 1/250 s: 20 mm.
    const float pixels = 0.5F * kSize / std::tan(0.5F * camera.fieldOfView * 0.01745329F) / 0.4F * 0.02F;
    EXPECT_NEAR(fast.high - still.high, pixels, 4);
    EXPECT_NEAR(fast.wide, still.wide, 3);
}

TEST_F(LookDrops, AreHiddenByObjectsInFront) {
    addWall(vec3(-0.1F, -0.1F, 0.1F), vec3(0.1F, 0.1F, 0.1F));
    const std::vector<uint8_t> none = with({});
    EXPECT_EQ(between(none, with({vec4(0, 0, 0, 0.01F), vec4(0.0F)})).count, 0);
    EXPECT_GT(between(none, with({vec4(0, 0, 0.15F, 0.01F), vec4(0.0F)})).count, 50);
    // Behind the eye, in it, nowhere: no GL error, and nothing.
    EXPECT_EQ(between(none, with({vec4(0, 0, 0.5F, 0.01F), vec4(0.0F), vec4(0, 0, 0.4F, 0.01F), vec4(0.0F), vec4(NAN), vec4(NAN)})).count,
              0);
}

}  // namespace
}  // namespace rivulet::look_drops_test
