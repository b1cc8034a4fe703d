// Whole pictures: what must not change them, what must, and what they looked like when somebody last looked at them.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine/scene/import_model.h"
#include "engine/scene/transform.h"
#include "tests/golden/look_fixture.h"

namespace rivulet::look_picture_test {
namespace {

constexpr int kWidth = 320, kHeight = 180;

class LookPicture : public LookTest {
  protected:
    void SetUp() override {
        LookTest::SetUp();
        if (IsSkipped()) return;
        settings.fluid.box = {.min = vec3(0.0F), .max = vec3(1.0F)};
        camera.position = vec3(1.79F, 0.99F, 2.65F);
        camera.target = vec3(0.48F, 0.3F, 0.55F);
        camera.fieldOfView = 32.0F;
        camera.setPlanes(Bounds{vec3(0.0F), vec3(1.0F)});
    }
    void addSpot() {
        Result<Mesh> mesh = importMesh(std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/spot.obj");
        ASSERT_TRUE(mesh) << mesh.error().message;
        Node node;
        node.local = Transform::fitted(mesh->bounds(), 0.55F, vec3(0.5F, 0.2706F, 0.5F), vec3(0.0F, -90.0F, 0.0F));
        node.mesh = std::make_shared<const Mesh>(std::move(*mesh));
        scene.add(std::move(node));
    }
    // A pool with waves, and drops above it.
    static TestParticles pool(float height = 0.12F) {
        TestParticles water;
        TestRandom random;
        for (float x = 0.01F; x < 1.0F; x += water.spacing)
            for (float z = 0.01F; z < 1.0F; z += water.spacing) {
                const float top = height + 0.03F * std::sin(9.0F * x + 2.0F * z) * std::cos(7.0F * z);
                for (float y = 0.01F; y < top; y += water.spacing) water.add(vec3(x, y, z) + 0.2F * water.spacing * random.inCube());
            }
        for (int i = 0; i < 200; ++i) water.add(vec3(0.5F, 0.3F, 0.6F) + vec3(0.45F, 0.2F, 0.35F) * random.inCube(), 0.4F);
        return water;
    }
    static size_t offset(int x, int y) { return (static_cast<size_t>(y) * kWidth + static_cast<size_t>(x)) * 4; }
    std::vector<uint8_t> shot(const FluidView& fluid) { return picture(camera, kWidth, kHeight, fluid); }

    Camera camera;
};

TEST_F(LookPicture, withoutWaterTheSceneIsDrawn) {
    addSpot();
    for (const char* renderer : {"points", "screen_space", "reference"}) {
        settings.look.renderer = renderer;
        const std::vector<uint8_t> rgba = shot({});
        ASSERT_EQ(rgba.size(), size_t{kWidth} * kHeight * 4);
        int least = 255, most = 0;
        for (size_t i = 0; i < rgba.size(); i += 4) {
            least = std::min<int>(least, rgba[i]);
            most = std::max<int>(most, rgba[i]);
            EXPECT_EQ(rgba[i + 3], 255);
        }
        EXPECT_LT(least, 120);  // the cow's shadow
        EXPECT_GT(most, 200);   // and its lit side
    }
}

TEST_F(LookPicture, waterChangesThePictureOnlyWhereItIs) {
    settings.background.showBox = false;
    TestParticles cube;
    for (float x = 0.3F; x < 0.6F; x += cube.spacing)
        for (float y = 0.3F; y < 0.6F; y += cube.spacing)
            for (float z = 0.3F; z < 0.6F; z += cube.spacing) cube.add(vec3(x, y, z));
    const mat4 toClip = camera.projection(static_cast<float>(kWidth) / kHeight) * camera.view();
    vec2 low(1e9F), high(-1e9F);
    for (const vec4& p : cube.position) {
        const vec4 clip = toClip * vec4(vec3(p), 1.0F);
        const vec2 pixel((clip.x / clip.w * 0.5F + 0.5F) * kWidth, (0.5F - clip.y / clip.w * 0.5F) * kHeight);
        low = glm::min(low, pixel);
        high = glm::max(high, pixel);
    }
    const std::vector<uint8_t> dry = shot({});
    for (const char* renderer : {"points", "screen_space", "reference"}) {
        settings.look.renderer = renderer;
        const std::vector<uint8_t> wet = shot(upload(cube));  // without bounds: it throws no shadow
        int inside = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const vec2 p(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
                const bool differs = std::abs(wet[offset(x, y)] - dry[offset(x, y)]) > 3;
                if (p.x < low.x - 8 || p.y < low.y - 8 || p.x > high.x + 8 || p.y > high.y + 8)
                    EXPECT_FALSE(differs) << renderer << " at " << x << " " << y;
                else
                    inside += differs ? 1 : 0;
            }
        EXPECT_GT(inside, 0.4F * (high.x - low.x) * (high.y - low.y)) << renderer;
    }
}

TEST_F(LookPicture, particlesThatAreNotNumbersAreLeftOut) {
    TestParticles water = pool();
    for (const char* renderer : {"points", "screen_space", "reference"}) {
        settings.look.renderer = renderer;
        FluidView view = upload(water);
        view.bounds = Bounds{vec3(0.0F), vec3(1.0F)};
        const std::vector<uint8_t> clean = shot(view);
        TestParticles dirty = water;
        const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
        for (const vec3& p : {vec3(nan), vec3(0.5F, nan, 0.5F), vec3(inf, 0.0F, 0.0F), vec3(0.0F, -inf, 0.0F)}) dirty.add(p);
        dirty.position.emplace_back(1e30F, 0.0F, 0.0F, nan);
        view = upload(dirty);
        view.bounds = Bounds{vec3(0.0F), vec3(1.0F)};
        EXPECT_EQ(clean, shot(view)) << renderer;
    }
}

TEST_F(LookPicture, aSphereIsHiddenByTheMeshBeforeItAndHidesTheOneBehindIt) {
    addSpot();
    settings.look.renderer = "points";
    settings.look.colourBy = "density";
    TestParticles one;
    one.spacing = 0.04F;
    one.add(vec3(0.42F, 0.26F, 0.5F));  // inside the cow
    const std::vector<uint8_t> dry = shot({});
    EXPECT_LT(meanAbsoluteError(dry, shot(upload(one))), 0.02);
    one.position[0] = vec4(camera.position + 1.6F * glm::normalize(camera.target - camera.position), 1.0F);
    EXPECT_GT(meanAbsoluteError(dry, shot(upload(one))), 0.05);
}

TEST_F(LookPicture, theTopRowComesFirst) {
    settings.look.renderer = "points";
    settings.background.showBox = false;
    TestParticles one;
    one.spacing = 0.3F;
    one.add(vec3(0.48F, 0.7F, 0.55F));
    const std::vector<uint8_t> dry = shot({}), wet = shot(upload(one));
    double up = 0, count = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            if (std::abs(wet[offset(x, y)] - dry[offset(x, y)]) > 3) {
                up += y;
                count += 1;
            }
    ASSERT_GT(count, 0);
    EXPECT_LT(up / count, kHeight / 2.0);
}

TEST_F(LookPicture, anySizeIsDrawnAndShadersReloadWithoutChangingThePicture) {
    addSpot();
    FluidView view = upload(pool());
    view.bounds = Bounds{vec3(0.0F), vec3(1.0F)};
    const std::vector<uint8_t> first = shot(view);
    for (const ivec2 size : {ivec2(1, 1), ivec2(0, 0), ivec2(33, 17), ivec2(7, 200)})
        EXPECT_EQ(picture(camera, size.x, size.y, view).size(), size_t(std::max(size.x, 1)) * size_t(std::max(size.y, 1)) * 4);
    const Result<size_t> reloaded = renderer().reload();
    ASSERT_TRUE(reloaded) << reloaded.error().message;
    EXPECT_EQ(first, shot(view));
}

TEST_F(LookPicture, anUnknownRendererIsNamed) {
    settings.look.renderer = "oil";
    const Status drawn = renderer().draw(frameViewOf(camera, settings.light, 8, 8, 0), {}, scene, settings);
    ASSERT_FALSE(drawn);
    EXPECT_NE(drawn.error().message.find("'oil'"), std::string::npos);
}

TEST_F(LookPicture, goldenScreenSpace) {
    addSpot();
    FluidView view = upload(pool());
    view.bounds = Bounds{vec3(0.0F), vec3(1.0F)};
    compareWith("screen_space", kWidth, kHeight, shot(view));
}

TEST_F(LookPicture, goldenPoints) {
    addSpot();
    settings.look.renderer = "points";
    FluidView view = upload(pool(0.06F));
    view.bounds = Bounds{vec3(0.0F), vec3(1.0F)};
    compareWith("points", kWidth, kHeight, shot(view));
}

}  // namespace
}  // namespace rivulet::look_picture_test
