// Shadows of meshes.
#include <gtest/gtest.h>

#include <cmath>

#include "engine/scene/import_model.h"
#include "engine/scene/transform.h"
#include "tests/golden/look_fixture.h"

namespace rivulet::look_shadow_test {
namespace {

using LookShadow = LookTest;

// Across the edge of a shadow on a floor it only gets lighter, however low the light, from the caster's foot outwards.
TEST_F(LookShadow, noRingOfLightIsInIt) {
    Result<Mesh> basin = importMesh(std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/basin.obj");
    ASSERT_TRUE(basin) << basin.error().message;
    constexpr float kSize = 0.8F;
    Node node;
    node.local = Transform::fitted(basin->bounds(), kSize, vec3(0.0F), vec3(0.0F));  // its longest side, m
    const Bounds placed = transformBounds(node.local, basin->bounds());
    node.mesh = std::make_shared<const Mesh>(std::move(*basin));
    scene.add(std::move(node));
    settings.fluid.box = {.min = placed.min, .max = placed.max};
    settings.background.floorHeight = placed.min.y;
    settings.background.showBox = false;
    constexpr int kSide = 400;
    Camera camera;
    camera.position = vec3(0.0F, 6.0F, 0.01F);
    camera.target = vec3(0.0F);
    camera.fieldOfView = 20.0F;
    camera.setPlanes(Bounds{vec3(-2.0F, placed.min.y, -2.0F), vec3(2.0F, placed.max.y, 2.0F)});
    for (const float elevation : {25.0F, 40.0F, 60.0F}) {
        settings.light.direction = vec3(-1.0F, std::tan(glm::radians(elevation)), 0.0F);
        const std::vector<uint8_t> rgba = picture(camera, kSide, kSide, {});
        // From the basin's edge along +x, over twice the length of its shadow.
        const float perPixel = 2.0F * std::tan(glm::radians(10.0F)) * (6.0F - placed.min.y) / kSide;
        const auto column = [&](float x) { return kSide / 2 + static_cast<int>(x / perPixel); };
        const float length = placed.size().y / std::tan(glm::radians(elevation));
        int most = 0, first = -1;
        for (int x = column(placed.max.x) + 3; x < std::min(column(placed.max.x + 2.0F * length), kSide); ++x) {
            const int light = rgba[(static_cast<size_t>(kSide / 2) * kSide + static_cast<size_t>(x)) * 4 + 1];
            if (first < 0) first = light;
            EXPECT_GE(light, most - 12) << "elevation " << elevation << ", column " << x;
            most = std::max(most, light);
        }
        EXPECT_GT(most, first + 40) << elevation;
    }
}

}  // namespace
}  // namespace rivulet::look_shadow_test
