// Glass, cloudy liquids and skies, and what the scenes made of them looked like when somebody last looked at them.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/render/made_sky.h"
#include "fluid/render/fluid_upload.h"
#include "fluid/session/session.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "tests/golden/look_fixture.h"

namespace rivulet::look_scenes_test {
namespace {

constexpr int kWidth = 320, kHeight = 180;

class LookScenes : public LookTest {
  protected:
    void SetUp() override {
        LookTest::SetUp();
        if (IsSkipped()) return;
        settings.fluid.box = {.min = vec3(0.0F), .max = vec3(1.0F)};
        settings.background.showBox = settings.background.showFloor = false;
        camera.position = vec3(0.5F, 0.5F, 2.6F);
        camera.target = vec3(0.5F, 0.5F, 0.5F);
        camera.fieldOfView = 36.0F;
        camera.setPlanes(Bounds{vec3(-0.5F), vec3(1.5F)});
    }
    static TestParticles cloud() {
        TestParticles water;
        TestRandom random;
        for (float x = 0.3F; x < 0.7F; x += water.spacing)
            for (float y = 0.3F; y < 0.7F; y += water.spacing)
                for (float z = 0.4F; z < 0.6F; z += water.spacing) water.add(vec3(x, y, z) + 0.15F * water.spacing * random.inCube());
        return water;
    }
    // A square pane, 5 mm thick, its middle at `middle`.
    Node pane(const vec3& middle, float half, const vec3& colour, float opacity) {
        Mesh box;
        const vec3 size(half, half, 0.0025F);
        for (int k = 0; k < 8; ++k)
            box.positions.push_back(middle + size * vec3((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1));
        const std::array<std::array<uint32_t, 4>, 6> sides = {
            {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
        Mesh flat;  // each side has corners of its own
        for (const auto& side : sides) {
            const auto first = static_cast<uint32_t>(flat.positions.size());
            const vec3 a = box.positions[side[0]], n = glm::normalize(glm::cross(box.positions[side[1]] - a, box.positions[side[2]] - a));
            for (const uint32_t corner : side) {
                flat.positions.push_back(box.positions[corner]);
                flat.normals.push_back(n);
            }
            for (const uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) flat.indices.push_back(first + k);
        }
        Node node;
        node.mesh = std::make_shared<const Mesh>(std::move(flat));
        node.material.baseColour = colour;
        node.material.opacity = opacity;
        node.material.roughness = 0.0F;
        node.material.clear = node.material.blended = true;
        return node;
    }
    // Drawn by a renderer of its own, amid `around`.
    std::vector<uint8_t> amid(const HdrImage& around, const FluidView& fluid) {
        auto own = SceneRenderer::create(ShaderFiles::developer(), &around);
        EXPECT_TRUE(own) << (own ? "" : own.error().message);
        const Status drawn = (*own)->draw(frameViewOf(camera, settings.light, kWidth, kHeight, 0), fluid, scene, settings);
        EXPECT_TRUE(drawn) << (drawn ? "" : drawn.error().message);
        return (*own)->pixels();
    }
    static const uint8_t* at(const std::vector<uint8_t>& rgba, int x, int y) {
        return &rgba[(static_cast<size_t>(y) * kWidth + static_cast<size_t>(x)) * 4];
    }
    static int mostApart(const std::vector<uint8_t>& a, const std::vector<uint8_t>& b) {
        int most = 0;
        for (size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
        return most;
    }

    // A shipped scene, coarser, after so many seconds, against its golden picture.
    void compareScene(const std::string& name, double seconds, const std::vector<std::string>& coarser, double tolerance) {
        Result<SceneFile> file = loadScene(name, coarser);
        ASSERT_TRUE(file) << file.error().message;
        const std::vector<CpuKernelRow> rows = cpuKernels();
        const std::unique_ptr<Device> device = makeCpuDevice(rows, {});
        auto session = Session::create(*file, *device, {});
        ASSERT_TRUE(session) << session.error().message;
        const auto frames = static_cast<int>(std::lround(seconds / frameSeconds(*file)));
        for (int k = 0; k < frames; ++k) (*session)->step(frameSeconds(*file), true);
        const auto around = surroundingsOf(*file);
        ASSERT_TRUE(around);
        auto own = SceneRenderer::create(ShaderFiles::developer(), *around ? &**around : nullptr);
        ASSERT_TRUE(own) << own.error().message;
        FluidUpload particles;
        const Result<FluidView> fluid = particles.view((*session)->world(), file->look);
        ASSERT_TRUE(fluid) << fluid.error().message;
        const FrameView view = frameViewOf(cameraOf(file->camera, (*session)->bounds()), file->light, kWidth, kHeight, 0);
        const Status drawn = (*own)->draw(view, *fluid, (*session)->solids(), *file);
        ASSERT_TRUE(drawn) << drawn.error().message;
        compareWith(name, kWidth, kHeight, (*own)->pixels(), tolerance);
    }

    Camera camera;
};

// The furnace: where as much light comes from everywhere, what absorbs nothing cannot be seen, however it mirrors, bends or scatters.
TEST_F(LookScenes, whatAbsorbsNothingIsNotSeenInAFurnace) {
    const HdrImage furnace{.name = "furnace", .width = 16, .height = 8, .texels = std::vector<vec3>(128, vec3(0.6F))};
    settings.light.intensity = 0;
    settings.look.absorption = vec3(0.0F);
    settings.look.scattering = vec3(0.0F);
    const FluidView water = upload(cloud());
    const std::vector<uint8_t> empty = amid(furnace, {});
    EXPECT_LE(mostApart(empty, amid(furnace, water)), 2) << "clear water";
    for (const float scattering : {1.0F, 10.0F, 300.0F, 3000.0F}) {
        settings.look.scattering = vec3(scattering);
        EXPECT_LE(mostApart(empty, amid(furnace, water)), 2) << scattering << " 1/m";
    }
    for (const float z : {0.9F, 0.1F}) scene.add(pane({0.5F, 0.5F, z}, 0.3F, vec3(1.0F), 0.0F));
    EXPECT_LE(mostApart(empty, amid(furnace, water)), 2) << "milk between panes";
    settings.look.absorption = vec3(0.0F, 0.0F, 2000.0F);
    const std::vector<uint8_t> yellow = amid(furnace, water);
    const uint8_t *middle = at(yellow, kWidth / 2, kHeight / 2), *sky = at(empty, kWidth / 2, kHeight / 2);
    EXPECT_NEAR(middle[0], sky[0], 2) << "what absorbs blue leaves red";
    EXPECT_LT(middle[2], sky[2] - 40);
}

// Through a red pane all is red; through milk nothing is seen. So a red pane before milk leaves it red, and one behind it as it was; behind
// clear water it is seen.
TEST_F(LookScenes, aPaneIsBeforeTheWaterOrBehindIt) {
    const FluidView water = upload(cloud());
    const auto middle = [&](const std::vector<uint8_t>& rgba) {
        const uint8_t* p = at(rgba, kWidth / 2 + 20, kHeight / 2 + 8);
        return std::array<int, 3>{p[0], p[1], p[2]};
    };
    for (const auto& [name, quality] :
         {std::pair("screen_space", "fine"), std::pair("screen_space", "fast"), std::pair("reference", "fine")})
        for (const bool milk : {true, false}) {
            settings.look.renderer = name;
            settings.look.quality = quality;
            settings.look.absorption = vec3(0.0F);
            settings.look.scattering = vec3(milk ? 3000.0F : 0.0F);
            scene = Scene();
            const auto wet = middle(picture(camera, kWidth, kHeight, water));
            const auto with = [&](float z) {
                scene = Scene();
                scene.add(pane({0.5F, 0.5F, z}, 0.5F, vec3(1.0F, 0.02F, 0.02F), 0.0F));
                return middle(picture(camera, kWidth, kHeight, water));
            };
            const auto before = with(0.9F), behind = with(0.1F);
            EXPECT_LT(before[1], wet[1] / 3) << name << ": green comes through no red pane";
            EXPECT_NEAR(before[0], wet[0], 25) << name << ": red does";
            if (milk)
                for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(behind[k], wet[k], 2) << name << ": milk hides what is behind it";
            else
                EXPECT_LT(behind[1], wet[1] / 2) << name << ": clear water does not";
        }
}

// A white fleck behind a green pane is green, also where there is no water about it; one before it is white.
TEST_F(LookScenes, foamBehindAPaneIsSeenThroughIt) {
    TestParticles corner;  // some water, elsewhere
    for (int k = 0; k < 8; ++k) corner.add(vec3(0.05F) + corner.spacing * vec3(k & 1, (k >> 1) & 1, k >> 2));
    settings.light.intensity = 2.0F;
    settings.background.horizon = settings.background.zenith = vec3(0.05F);
    scene.add(pane({0.5F, 0.5F, 0.5F}, 0.4F, vec3(0.1F, 1.0F, 0.1F), 0.0F));
    for (const char* name : {"screen_space", "reference"})
        for (const char* quality : {"fine", "fast"}) {
            settings.look.renderer = name;
            settings.look.quality = quality;
            FluidView water = upload(corner);
            water.spacing = 0.3F;  // flecks of some pixels
            const auto dry = picture(camera, kWidth, kHeight, water);
            const auto added = [&](float z) {
                const std::vector<vec4> flecks(12, vec4(0.5F, 0.5F, z, 1.0F)), velocities(12, vec4(0.0F, 0.0F, 0.0F, 2.99F));
                const gpu::Buffer places = std::move(*gpu::Buffer::from(flecks)), speeds = std::move(*gpu::Buffer::from(velocities));
                water.foam = {places.name(), speeds.name()};
                water.foamCount = 12;
                const auto rgba = picture(camera, kWidth, kHeight, water);
                std::array<double, 3> more = {0, 0, 0};
                for (int y = kHeight / 2 - 4; y < kHeight / 2 + 4; ++y)
                    for (int x = kWidth / 2 - 4; x < kWidth / 2 + 4; ++x)
                        for (size_t k = 0; k < 3; ++k) more[k] += at(rgba, x, y)[k] - at(dry, x, y)[k];
                return more;
            };
            const auto behind = added(0.2F), before = added(0.8F);
            EXPECT_GT(behind[1], 300.0) << name << ' ' << quality;
            EXPECT_LT(behind[0], 0.6 * behind[1]) << name << ' ' << quality << ": no red comes through";
            EXPECT_GT(before[0], 0.8 * before[1]) << name << ' ' << quality << ": it is white";
        }
}

TEST_F(LookScenes, aMadeSkyIsBrightestAboutTheSunAndCloudsCoverIt) {
    const vec3 sun = glm::normalize(vec3(0.3F, 0.5F, -0.6F));
    const auto skyOf = [&](float clouds) { return makeSky({.sun = sun, .sunlight = vec3(3.0F), .clouds = clouds}); };
    const HdrImage clear = skyOf(0.0F), half = skyOf(0.5F), full = skyOf(1.0F);
    const auto towards = [&](int x, int y) {
        const float up = ((static_cast<float>(y) + 0.5F) / static_cast<float>(clear.height) - 0.5F) * kPi;
        const float turn = ((static_cast<float>(x) + 0.5F) / static_cast<float>(clear.width) - 0.5F) * 2 * kPi;
        return vec3(std::cos(up) * std::sin(turn), std::sin(up), -std::cos(up) * std::cos(turn));
    };
    vec3 brightest(0.0F);
    float most = 0;
    double covered[2] = {0, 0}, texels = 0;
    for (int y = 0; y < clear.height; ++y)
        for (int x = 0; x < clear.width; ++x) {
            const size_t i = static_cast<size_t>(y) * static_cast<size_t>(clear.width) + static_cast<size_t>(x);
            ASSERT_TRUE(glm::all(glm::greaterThan(clear.texels[i], vec3(0.0F))));
            if (clear.texels[i].y > most) {
                most = clear.texels[i].y;
                brightest = towards(x, y);
            }
            if (y < clear.height / 2) {
                EXPECT_EQ(clear.texels[i], full.texels[i]) << "no clouds below the horizon";
                continue;
            }
            const vec3 d = towards(x, y);
            if (d.y < 0.35F) continue;  // lower they fade into haze
            const double area = std::sqrt(1.0 - double{d.y} * double{d.y});
            texels += area;
            covered[0] += glm::distance(clear.texels[i], half.texels[i]) > 0.02F ? area : 0;
            covered[1] += glm::distance(clear.texels[i], full.texels[i]) > 0.02F ? area : 0;
        }
    EXPECT_GT(glm::dot(brightest, sun), std::cos(1.0F * kPi / 180));
    EXPECT_NEAR(covered[0] / texels, 0.5, 0.15);
    EXPECT_GT(covered[1] / texels, 0.95);
}

TEST_F(LookScenes, goldenGlass) { compareScene("glass", 0.9, {"fluid.spacing=0.0036"}, 1.0); }
TEST_F(LookScenes, goldenFountain) { compareScene("fountain", 0.5, {"fluid.spacing=0.018"}, 0.4); }
TEST_F(LookScenes, goldenCove) { compareScene("cove", 0.7, {"fluid.spacing=0.09"}, 0.4); }
TEST_F(LookScenes, goldenSplashCrown) { compareScene("splash_crown", 0.012, {"fluid.spacing=0.0007", "timeScale=0.05"}, 0.8); }

}  // namespace
}  // namespace rivulet::look_scenes_test
