// Model files as colliders are drawn: where a texture's alpha cuts a hole, what is behind is seen, and lit through it.
#include <gtest/gtest.h>

#include <cmath>

#include "fluid/scene/collider_model.h"
#include "fluid/sim/world/cpu_kernels.h"
#include "tests/golden/look_fixture.h"
#include "tests/unit/gltf_file.h"

namespace rivulet::look_file_test {
namespace {

constexpr int kWidth = 320, kHeight = 180;

class LookFile : public LookTest {
  protected:
    void SetUp() override {
        LookTest::SetUp();
        if (IsSkipped()) return;
        folder_ = std::filesystem::temp_directory_path() / ("rivulet_look_file_" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
        settings.background.showBox = false;
        settings.fluid.box = {.min = vec3(-1, 0, -1), .max = vec3(1, 1, 1)};
    }
    void TearDown() override {
        std::filesystem::remove_all(folder_);
        LookTest::TearDown();
    }
    // A green pane of 1 x 1 m that stands on the ground at z = 0; its picture has alpha 0 in a disc about its middle, of radius 0.25.
    std::string pane() {
        constexpr int kTexels = 128;
        std::string texels(
            {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, static_cast<char>(kTexels), 0, static_cast<char>(kTexels), 0, 32, 8});  // TGA
        for (int y = 0; y < kTexels; ++y)
            for (int x = 0; x < kTexels; ++x) {
                const vec2 at = (vec2(x, y) + 0.5F) / static_cast<float>(kTexels) - 0.5F;
                texels += {char{40}, static_cast<char>(200), char{20}, static_cast<char>(glm::length(at) < 0.25F ? 0 : 255)};
            }
        std::ofstream(folder_ / "hole.tga", std::ios::binary) << texels;
        GltfFile file;
        const int position = file.floats("VEC3", {-0.5F, 0, 0, 0.5F, 0, 0, 0.5F, 1, 0, -0.5F, 1, 0});
        const int index = file.shorts({0, 1, 2, 0, 2, 3});
        std::vector<float> uvs{0, 1, 1, 1, 1, 0, 0, 0};
        const int uv = file.floats("VEC2", uvs);
        return file.write(folder_, "pane",
                          fmt::format(R"("scenes":[{{"nodes":[0]}}],"nodes":[{{"name":"pane","mesh":0}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{},"TEXCOORD_0":{}}},"indices":{},"material":0}}]}}],
"materials":[{{"name":"lace","alphaMode":"MASK","doubleSided":true,"pbrMetallicRoughness":{{"metallicFactor":0,"baseColorTexture":{{"index":0}}}}}}],
"textures":[{{"source":0}}],"images":[{{"uri":"hole.tga"}}])",
                                      position, uv, index));
    }
    std::filesystem::path folder_;
};

TEST_F(LookFile, WhereAlphaIsZeroTheBackgroundIsVisibleAndLit) {
    const auto device = makeCpuDevice(cpuKernels());
    Camera camera;
    camera.position = vec3(0, 0.5F, 3);
    camera.target = vec3(0, 0.5F, 0);
    camera.fieldOfView = 30;
    camera.nearPlane = 0.1F;
    camera.farPlane = 50;
    settings.light.direction = vec3(0, 1, 1.0e-3F + 1.0F);  // its shadow falls behind it, the disc's light about 0.5 m back
    const std::vector<uint8_t> empty = picture(camera, kWidth, kHeight, {});
    ColliderParams collider;
    collider.mesh = pane();
    Result<ColliderModel> model = ColliderModel::create(collider, "", *device, scene);
    ASSERT_TRUE(model) << model.error().message;
    const std::vector<uint8_t> shown = picture(camera, kWidth, kHeight, {});
    const float metre = kHeight / (2 * 3 * std::tan(15 * kPi / 180));  // pixels, at z = 0
    int holes = 0, greens = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const vec2 at = vec2(x + 0.5F - kWidth / 2, kHeight / 2 - y - 0.5F) / metre;  // m, from the pane's middle
            const uint8_t* p = &shown[static_cast<size_t>(4 * (y * kWidth + x))];
            const uint8_t* e = &empty[static_cast<size_t>(4 * (y * kWidth + x))];
            const bool green = p[1] > p[0] + 60 && p[1] > p[2] + 40;
            if (glm::length(at) < 0.22F) {
                ++holes;
                EXPECT_FALSE(green) << x << ", " << y;
                if (at.y > 0.05F) {  // the sky: as if there were no pane
                    for (int c = 0; c < 3; ++c) EXPECT_NEAR(p[c], e[c], 3) << x << ", " << y;
                }
            } else if (std::max(std::abs(at.x), std::abs(at.y)) < 0.47F && glm::length(at) > 0.28F) {
                ++greens;
                EXPECT_TRUE(green) << x << ", " << y << ": " << int{p[0]} << " " << int{p[1]} << " " << int{p[2]};
            }
        }
    EXPECT_GT(holes, 500);
    EXPECT_GT(greens, 2000);
    // From above: its shadow on the ground has a hole, too.
    camera.position = vec3(0, 4, -0.501F);
    camera.target = vec3(0, 0, -0.5F);
    const std::vector<uint8_t> above = picture(camera, kWidth, kHeight, {});
    scene = Scene();
    const std::vector<uint8_t> bare = picture(camera, kWidth, kHeight, {});
    const float unit = kHeight / (2 * 4 * std::tan(15 * kPi / 180));
    const auto share = [&](const vec2& from) {  // of the light, at (x, z) on the ground; +z is down in this picture
        const int x = static_cast<int>(kWidth / 2 - from.x * unit), y = static_cast<int>(kHeight / 2 - (from.y + 0.5F) * unit);
        const size_t at = static_cast<size_t>(4 * (y * kWidth + x) + 1);
        return static_cast<float>(above[at]) / static_cast<float>(bare[at]);
    };
    EXPECT_GT(share({0, -0.5F}), 0.9F) << "lit through the disc";
    EXPECT_LT(share({0.38F, -0.5F}), 0.85F) << "in the pane's shadow";
    EXPECT_LT(share({-0.38F, -0.5F}), 0.85F);
    EXPECT_GT(share({0.8F, -0.5F}), 0.95F) << "beside it";
    scene = Scene();
}

TEST_F(LookFile, ALampEmitsTheRadianceOfItsFile) {
    const auto device = makeCpuDevice(cpuKernels());
    GltfFile file;
    const int position = file.floats("VEC3", {-0.5F, 0, 0, 0.5F, 0, 0, 0.5F, 1, 0, -0.5F, 1, 0});
    const int index = file.shorts({0, 1, 2, 0, 2, 3});
    const auto lamp = [&](const std::string& name, const std::string& emission) {
        return file.write(folder_, name,
                          fmt::format(R"("scenes":[{{"nodes":[0]}}],"nodes":[{{"name":"pane","mesh":0}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{}}},"indices":{},"material":0}}]}}],
"materials":[{{"name":"lamp","pbrMetallicRoughness":{{"metallicFactor":0,"baseColorFactor":[0,0,0,1]}},"emissiveFactor":{}}}])",
                                      position, index, emission));
    };
    Camera camera;
    camera.position = vec3(0, 0.5F, 3);
    camera.target = vec3(0, 0.5F, 0);
    camera.fieldOfView = 30;
    settings.light.intensity = 0;
    settings.background.horizon = settings.background.zenith = settings.background.floor = vec3(0.0F);
    const auto middle = [&](const std::string& path) {
        scene = Scene();
        ColliderParams collider;
        collider.mesh = path;
        EXPECT_TRUE(ColliderModel::create(collider, "", *device, scene));
        const std::vector<uint8_t> rgba = picture(camera, kWidth, kHeight, {});
        scene = Scene();
        const size_t at = 4 * (static_cast<size_t>(kHeight / 2) * kWidth + kWidth / 2);
        return vec3(rgba[at], rgba[at + 1], rgba[at + 2]);
    };
    const vec3 dark = middle(lamp("dark", "[0,0,0]")), red = middle(lamp("red", "[1,0,0]")), dim = middle(lamp("dim", "[0.25,0,0]"));
    EXPECT_LT(dark.x, 40);
    EXPECT_GT(red.x, 150);
    EXPECT_GT(red.x, dim.x + 30);
    EXPECT_GT(dim.x, dark.x + 30);
    EXPECT_LT(red.z, red.x / 2);
}

}  // namespace
}  // namespace rivulet::look_file_test
