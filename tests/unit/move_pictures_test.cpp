// Pictures of a material on new UVs show what they showed on the old ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/scene/import_model.h"
#include "fluid/flow/flow_maps.h"
#include "fluid/flow/unwrap.h"
#include "fluid/scene/move_pictures.h"

namespace rivulet::move_pictures_test {
namespace {

vec4 at(const Image& image, const vec2& uv) {
    const auto x = std::min(static_cast<size_t>(uv.x * static_cast<float>(image.width)), static_cast<size_t>(image.width) - 1);
    const auto y = std::min(static_cast<size_t>(uv.y * static_cast<float>(image.height)), static_cast<size_t>(image.height) - 1);
    const uint8_t* t = &image.rgba[4 * (y * static_cast<size_t>(image.width) + x)];
    return {t[0], t[1], t[2], t[3]};
}

// MediaPipe's face with the right half's UVs on the left one's: the colours of a smooth picture stay at their places on the skin.
TEST(MovePictures, ColoursStayAtTheirPlaces) {
    Result<Mesh> face = importMesh(std::string(RIVULET_SOURCE_DIR) + "/assets/meshes/canonical_face_model.obj");
    ASSERT_TRUE(face);
    for (vec2& uv : face->uvs) uv.x = 0.02F + std::abs(uv.x - 0.5F);
    const Result<FlowMesh> mesh = makeFlowMesh(face->view());
    ASSERT_TRUE(mesh);
    const Result<SkinUvs> uvs = skinUvs(*mesh, face->view(), 512);
    ASSERT_TRUE(uvs);
    ASSERT_TRUE(uvs->unwrapped);
    auto picture = std::make_shared<Image>();
    picture->width = 300;
    picture->height = 200;
    for (int y = 0; y < 200; ++y)
        for (int x = 0; x < 300; ++x)
            for (const double value : {127 + 120 * std::sin(x / 40.0), 127 + 120 * std::sin(y / 40.0), 255.0 * x / 300, 255.0})
                picture->rgba.push_back(static_cast<uint8_t>(value));
    Material material;
    material.colour = material.normals = picture;
    const std::vector<vec2> old = cornerUvs(*mesh, face->view());
    ASSERT_TRUE(movePictures(material, old, uvs->uvs, 512));
    EXPECT_EQ(material.normals, nullptr);
    ASSERT_NE(material.colour, picture);
    double sum = 0;
    size_t count = 0;
    for (size_t t = 0; t < mesh->triangleCount(); ++t)
        for (const vec2& share : {vec2(0.33F, 0.33F), vec2(0.1F, 0.1F), vec2(0.8F, 0.1F), vec2(0.02F, 0.96F)}) {
            const auto mix = [&](const std::vector<vec2>& of) {
                return (1 - share.x - share.y) * of[3 * t] + share.x * of[3 * t + 1] + share.y * of[3 * t + 2];
            };
            const vec4 before = at(*picture, mix(old)), after = at(*material.colour, mix(uvs->uvs));
            for (int k = 0; k < 4; ++k) {
                EXPECT_LT(std::abs(before[k] - after[k]), 16) << t << " " << k;
                sum += std::abs(before[k] - after[k]);
                ++count;
            }
        }
    EXPECT_LT(sum / static_cast<double>(count), 2.0);
    // Without pictures there is nothing to move.
    Material plain;
    EXPECT_FALSE(movePictures(plain, old, uvs->uvs, 512));
}

}  // namespace
}  // namespace rivulet::move_pictures_test
