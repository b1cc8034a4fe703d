// The water seen from inside, with many particles, next to another renderer, and its intermediate views.
#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <cmath>

#include "tests/golden/look_fixture.h"

namespace rivulet::look_water_test {
namespace {

constexpr int kWidth = 320, kHeight = 180;

class LookWater : public LookTest {
  protected:
    void SetUp() override {
        LookTest::SetUp();
        if (IsSkipped()) return;
        settings.fluid.box = {.min = vec3(0.0F), .max = vec3(1.0F)};
        settings.background.showBox = false;
        camera.position = vec3(0.5F, 1.2F, 2.2F);
        camera.target = vec3(0.5F, 0.2F, 0.5F);
        camera.fieldOfView = 40.0F;
        camera.setPlanes(Bounds{vec3(0.0F), vec3(1.0F)});
    }
    static TestParticles pool(float height, float spacing = 0.025F) {
        TestParticles water;
        water.spacing = spacing;
        TestRandom random;
        for (float x = 0.5F * spacing; x < 1.0F; x += spacing)
            for (float z = 0.5F * spacing; z < 1.0F; z += spacing)
                for (float y = 0.5F * spacing; y < height; y += spacing) water.add(vec3(x, y, z) + 0.15F * spacing * random.inCube());
        return water;
    }
    FluidView bounded(const TestParticles& water) {
        FluidView view = upload(water);
        view.bounds = Bounds{vec3(0.0F), vec3(1.0F)};
        return view;
    }
    std::vector<uint8_t> shot(const FluidView& fluid) { return picture(camera, kWidth, kHeight, fluid); }
    static const uint8_t* at(const std::vector<uint8_t>& rgba, int x, int y) {
        return &rgba[(static_cast<size_t>(y) * kWidth + static_cast<size_t>(x)) * 4];
    }
    static int apart(const uint8_t* a, const uint8_t* b) {
        return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
    }
    Camera camera;
};

TEST_F(LookWater, withinTheWaterNoPixelIsAHole) {
    settings.look.absorption = vec3(200.0F, 4.0F, 2.0F);  // a hand's breadth lets no red through
    const FluidView water = bounded(pool(0.6F));
    for (const vec3& target : {vec3(0.5F, 0.3F, -1.0F), vec3(0.2F, 0.0F, 0.2F), vec3(0.9F, 0.35F, 0.1F)}) {
        camera.position = vec3(0.5F, 0.3F, 0.7F);
        camera.target = target;
        camera.setPlanes(Bounds{vec3(0.0F), vec3(1.0F)});
        const std::vector<uint8_t> dry = shot({}), wet = shot(water);
        int red = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const uint8_t* p = at(wet, x, y);
                red += p[0] > p[2] ? 1 : 0;  // as in the studio, not as in the water
            }
        EXPECT_LT(red, kWidth * kHeight / 500) << target.x;
        EXPECT_GT(meanAbsoluteError(dry, wet), 10.0);
    }
}

TEST_F(LookWater, fromBelowTheSurfaceIsAMirrorAboutSnellsWindow) {
    settings.look.absorption = vec3(0.5F);
    settings.background.zenith = vec3(3.0F);
    settings.background.horizon = vec3(3.0F);
    settings.background.floor = vec3(0.5F, 0.01F, 0.01F);  // which is what the surface mirrors
    camera.fieldOfView = 110.0F;
    camera.position = vec3(0.5F, 0.25F, 0.5F);
    camera.target = vec3(0.5F, 1.0F, 0.501F);
    camera.setPlanes(Bounds{vec3(0.0F), vec3(1.0F)});
    const std::vector<uint8_t> wet = shot(bounded(pool(0.4F)));
    const auto mean = [&](int x, int y, int channel) {
        int sum = 0;
        for (int dy = -4; dy <= 4; ++dy)
            for (int dx = -4; dx <= 4; ++dx) sum += at(wet, x + dx, y + dy)[channel];
        return sum / 81.0;
    };
    const auto brightness = [&](int x, int y) { return mean(x, y, 1); };
    // The picture's half height is 55 degrees, the window's edge asin(1 / 1.333) = 48.6.
    const double scale = 0.5 * kHeight / std::tan(55.0 * double{kPi} / 180.0);
    const auto off = [&](double degrees) { return static_cast<int>(scale * std::tan(degrees * double{kPi} / 180.0)); };
    const double middle = brightness(kWidth / 2, kHeight / 2);
    EXPECT_GT(brightness(kWidth / 2 + off(30.0), kHeight / 2), 0.8 * middle);
    EXPECT_LT(brightness(kWidth / 2 + off(57.0), kHeight / 2), 0.8 * middle);
    EXPECT_LT(brightness(kWidth / 2 - off(57.0), kHeight / 2), 0.8 * middle);
    EXPECT_GT(mean(kWidth / 2 + off(57.0), kHeight / 2, 0), 1.5 * brightness(kWidth / 2 + off(57.0), kHeight / 2));
    EXPECT_LT(mean(kWidth / 2 + off(30.0), kHeight / 2, 0), 1.2 * brightness(kWidth / 2 + off(30.0), kHeight / 2));
}

TEST_F(LookWater, zeroOneAndAMillionParticlesAreDrawn) {
    TestParticles one;
    one.add(vec3(0.5F, 0.2F, 0.5F));
    const std::vector<uint8_t> dry = shot(bounded({}));
    EXPECT_GT(meanAbsoluteError(dry, shot(bounded(one))), 0.0);
    const TestParticles many = pool(1.0F, 0.01F);
    EXPECT_GE(many.position.size(), 990000U);
    EXPECT_GT(meanAbsoluteError(dry, shot(bounded(many))), 5.0);
}

// A buffer's rows beyond what a GPU can read as a texture would be drawn anywhere: they are refused before anything is drawn.
TEST_F(LookWater, moreParticlesThanTheGpuReadsAreRefused) {
    Result<FluidPrograms> programs = FluidPrograms::create(ShaderFiles::developer());
    ASSERT_TRUE(programs) << programs.error().message;
    GLint most = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
    ASSERT_GE(most, 65536) << "what OpenGL 4.5 promises";
    const auto n = static_cast<uint32_t>(most);
    FluidView water;
    water.count = water.foamCount = n;
    water.dropCount = n / 2;
    EXPECT_TRUE(programs->fits(water));
    for (uint32_t FluidView::*count : {&FluidView::count, &FluidView::foamCount, &FluidView::dropCount}) {
        FluidView more;
        more.*count = (count == &FluidView::dropCount ? n / 2 : n) + 1;
        const Status refused = programs->fits(more);
        ASSERT_FALSE(refused);
        EXPECT_NE(refused.error().message.find(std::to_string(more.*count)), std::string::npos) << refused.error().message;
        EXPECT_FALSE(renderer().draw(frameViewOf(camera, settings.light, 8, 8, 0), more, scene, settings));
    }
}

TEST_F(LookWater, everyViewShowsItsOwn) {
    camera.position = vec3(0.5F, 3.0F, 0.52F);
    camera.target = vec3(0.5F, 0.0F, 0.5F);
    const FluidView water = bounded(pool(0.3F));
    std::vector<std::vector<uint8_t>> shown;
    for (const ViewRow& row : waterViews().rows) {
        settings.look.view = row.name;
        shown.push_back(shot(water));
        for (size_t k = 0; k + 1 < shown.size(); ++k) EXPECT_GT(meanAbsoluteError(shown[k], shown.back()), 0.02) << row.name;
        if (row.view != WaterView::normals) continue;
        const uint8_t* middle = at(shown.back(), kWidth / 2, kHeight / 2);  // of a level surface: green
        EXPECT_GT(middle[1], 200);
        EXPECT_LT(middle[0], 90);
        EXPECT_LT(middle[2], 90);
    }
    settings.look.view = "oil";
    const Status drawn = renderer().draw(frameViewOf(camera, settings.light, 8, 8, 0), {}, scene, settings);
    ASSERT_FALSE(drawn);
    EXPECT_NE(drawn.error().message.find("'oil'"), std::string::npos);
}

TEST_F(LookWater, aSplitsHalvesAreThoseOfTheTwoRenderers) {
    const FluidView water = bounded(pool(0.3F));
    const std::vector<uint8_t> left = shot(water);
    settings.look.renderer = "points";
    const std::vector<uint8_t> right = shot(water);
    settings.look.renderer = "screen_space";
    settings.look.split = "points";
    const std::vector<uint8_t> both = shot(water);
    double worst = 0, off = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            if (std::abs(x - kWidth / 2) < 4) continue;
            const bool first = x < kWidth / 2;
            const int d = apart(at(both, x, y), at(first ? left : right, x, y));
            if (first) worst = std::max(worst, double(d));
            // The scene under it is lit through the first renderer's water.
            else
                off += d;
        }
    EXPECT_EQ(worst, 0.0);
    EXPECT_LT(off / (kWidth * kHeight / 2.0), 6.0);
    EXPECT_GT(meanAbsoluteError(left, both), 2.0);
    settings.look.split = "oil";
    EXPECT_FALSE(renderer().draw(frameViewOf(camera, settings.light, 8, 8, 0), {}, scene, settings));
}

// The reference takes seconds, and is found once for what does not change.
TEST_F(LookWater, theTruthIsMarchedOnceForWaterAtRest) {
    const FluidView water = bounded(pool(0.3F, 0.05F));
    settings.look.renderer = "reference";
    int told = 0;
    bool on = true;
    renderer().onProgress([&](double) {
        ++told;
        return on;
    });
    const std::vector<uint8_t> first = shot(water);
    const int once = told;
    EXPECT_GT(once, 0);
    EXPECT_EQ(shot(water), first);
    EXPECT_EQ(told, once);
    camera.position.x += 0.1F;
    on = false;
    (void)shot(water);  // given up
    EXPECT_GT(told, once);
    on = true;
    const std::vector<uint8_t> moved = shot(water);
    EXPECT_GT(meanAbsoluteError(first, moved), 0.1);
    EXPECT_EQ(shot(water), moved);
    renderer().onProgress([](double) { return true; });
}

TEST_F(LookWater, goldenNormals) {
    TestParticles water = pool(0.25F);
    for (vec4& p : water.position) p.y *= 1.0F + 0.3F * std::sin(9.0F * p.x) * std::cos(7.0F * p.z);
    water.findEllipsoids();
    settings.look.view = "normals";
    compareWith("normals", kWidth, kHeight, shot(bounded(water)), 0.6);
}

TEST_F(LookWater, goldenWithinTheWater) {
    camera.fieldOfView = 90.0F;
    camera.position = vec3(0.5F, 0.25F, 0.8F);
    camera.target = vec3(0.5F, 0.6F, 0.3F);
    camera.setPlanes(Bounds{vec3(0.0F), vec3(1.0F)});
    compareWith("within", kWidth, kHeight, shot(bounded(pool(0.6F))), 0.6);
}

TEST_F(LookWater, fastIsTheSamePictureButForDetail) {
    const FluidView water = bounded(pool(0.3F));
    settings.look.quality = "fine";
    const std::vector<uint8_t> fine = shot(water);
    settings.look.quality = "fast";
    const std::vector<uint8_t> fast = shot(water);
    EXPECT_GT(meanAbsoluteError(fine, fast), 0.0);
    EXPECT_LT(meanAbsoluteError(fine, fast), 4.0);
}

// Half of an odd size is rounded up; the surface found there still lies over the water.
TEST_F(LookWater, fastAtOddSizesIsStillTheSamePicture) {
    const FluidView water = bounded(pool(0.3F));
    for (const ivec2 size : {ivec2(641, 359), ivec2(33, 17), ivec2(1, 1)}) {
        settings.look.caustics = size.x > 1;  // their map is finer in one than in the other, and one pixel shows no mean
        settings.look.quality = "fine";
        const std::vector<uint8_t> fine = picture(camera, size.x, size.y, water), dry = picture(camera, size.x, size.y, bounded({}));
        settings.look.quality = "fast";
        const std::vector<uint8_t> fast = picture(camera, size.x, size.y, water);
        ASSERT_EQ(fast.size(), fine.size());
        EXPECT_LT(meanAbsoluteError(fine, fast), 4.0) << size.x;
        if (size.x == 1) continue;  // what one pixel shows may be no water at all
        EXPECT_LT(meanAbsoluteError(fine, fast), 0.3 * meanAbsoluteError(fine, dry)) << size.x;
    }
}

// Flecks need no particle to be seen, and a slot without one shows nothing.
TEST_F(LookWater, foamIsDrawnWithoutParticles) {
    const std::vector<uint8_t> dry = shot({});
    for (const char* name : {"screen_space", "points", "reference"}) {
        settings.look.renderer = name;
        for (const float life : {0.0F, 1.0F}) {
            const std::vector<vec4> flecks(5, vec4(0.5F, 0.3F, 0.5F, life)), velocities(5, vec4(0.0F, 0.0F, 0.0F, 1.9F));
            const gpu::Buffer places = std::move(*gpu::Buffer::from(flecks)), speeds = std::move(*gpu::Buffer::from(velocities));
            FluidView foam;
            foam.spacing = 0.1F;
            foam.foam = {places.name(), speeds.name()};
            foam.foamCount = 5;
            const double changed = meanAbsoluteError(dry, shot(foam));
            if (life > 0)
                EXPECT_GT(changed, 0.001) << name;
            else
                EXPECT_EQ(changed, 0.0) << name;
        }
    }
}

// Seen from the side, foam is wide and low; a fleck of spray is as high as wide, unless it moves during the exposure.
TEST_F(LookWater, foamLiesOnTheWaterAndSprayIsDrawnOutAlongItsPath) {
    camera.position = vec3(0.5F, 0.45F, 1.5F);
    camera.target = vec3(0.5F, 0.3F, 0.5F);
    camera.setPlanes(Bounds{vec3(0.0F), vec3(1.0F)});
    const std::vector<uint8_t> dry = shot({});
    const auto shape = [&](const vec4& velocity) {  // of what changed: width over height
        const gpu::Buffer place = std::move(*gpu::Buffer::from(std::vector<vec4>{vec4(0.5F, 0.3F, 0.5F, 9.0F)}));
        const gpu::Buffer speed = std::move(*gpu::Buffer::from(std::vector<vec4>{velocity}));
        FluidView foam;
        foam.spacing = 0.3F;
        foam.foam = {place.name(), speed.name()};
        foam.foamCount = 1;
        const std::vector<uint8_t> wet = shot(foam);
        ivec2 low(kWidth, kHeight), high(-1);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                if (std::abs(at(wet, x, y)[1] - at(dry, x, y)[1]) > 3) {
                    low = glm::min(low, ivec2(x, y));
                    high = glm::max(high, ivec2(x, y));
                }
        EXPECT_GT(high.x, low.x);
        return static_cast<float>(high.x - low.x + 1) / static_cast<float>(high.y - low.y + 1);
    };
    EXPECT_GT(shape(vec4(0.0F, 0.0F, 0.0F, 2.9F)), 2.0F);
    EXPECT_NEAR(shape(vec4(0.0F, 0.0F, 0.0F, 1.9F)), 1.0F, 0.2F);
    EXPECT_GT(shape(vec4(12.0F, 0.0F, 0.0F, 1.9F)), 2.0F);  // 0.1 m in 1/120 s
    EXPECT_LT(shape(vec4(0.0F, 12.0F, 0.0F, 1.9F)), 0.5F);
}

}  // namespace
}  // namespace rivulet::look_water_test
