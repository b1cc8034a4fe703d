// Water that reflects the surroundings of a host: from an image, an equirectangular texture or a cube map, in any view.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/unit/host_pool.h"

namespace rivulet::host_surroundings_test {
namespace {

using testing::PoolPicture;

using Sky = std::function<vec3(const vec3& dir)>;

HdrImage imageOf(const Sky& sky, int height) {
    HdrImage image{.name = "sky", .width = 2 * height, .height = height, .texels = {}};
    image.texels.reserve(static_cast<size_t>(2 * height * height));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < 2 * height; ++x) {
            const float turn = ((static_cast<float>(x) + 0.5F) / static_cast<float>(height) - 1) * kPi;
            const float up = ((static_cast<float>(y) + 0.5F) / static_cast<float>(height) - 0.5F) * kPi;
            image.texels.push_back(sky(vec3(std::cos(up) * std::sin(turn), std::sin(up), -std::cos(up) * std::cos(turn))));
        }
    return image;
}

GLuint textureOf(const HdrImage& image) {
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &name);
    glTextureStorage2D(name, 1, GL_RGB16F, image.width, image.height);
    glTextureSubImage2D(name, 0, 0, 0, image.width, image.height, GL_RGB, GL_FLOAT, image.texels.data());
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    return name;
}

// By OpenGL's table of the faces (specification 4.5, 8.13): of each its axis, and the axes of s and t.
GLuint cubeOf(const Sky& sky, int side) {
    const mat3 faces[] = {{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},
                          {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}}, {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}};
    GLuint name = 0;
    glCreateTextures(GL_TEXTURE_CUBE_MAP, 1, &name);
    glTextureStorage2D(name, 1, GL_RGBA16F, side, side);
    for (int face = 0; face < 6; ++face) {
        std::vector<vec4> texels;
        texels.reserve(static_cast<size_t>(side * side));
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) {
                const vec2 at = (vec2(x, y) + 0.5F) * (2.0F / static_cast<float>(side)) - 1.0F;
                texels.emplace_back(sky(glm::normalize(faces[face][0] + at.x * faces[face][1] + at.y * faces[face][2])), 1.0F);
            }
        glTextureSubImage3D(name, 0, 0, 0, face, side, side, 1, GL_RGBA, GL_FLOAT, texels.data());
    }
    return name;
}

class SurroundingsOfAHost : public testing::PoolInAHost {
  protected:
    std::vector<vec4> draw(const char* name, const FrameView& view, const vec3& background) {
        const PoolPicture host(view, empty(background));
        const Status drawn = renderer_->draw(view, pool_, clear(), host.target());
        EXPECT_TRUE(drawn) << drawn.error().message;
        std::vector<vec4> pixels = host.pixels();
        keep(name, pixels);
        return pixels;
    }
};

// Radiance `around` from everywhere, `behind` through the water: what is reflected and what is refracted, by Fresnel.
TEST_F(SurroundingsOfAHost, ThatAreUniformAreReflectedByFresnelsShare) {
    const FrameView view = camera();
    const vec3 around(2.0F, 1.0F, 0.5F), behind(0.25F, 0.5F, 0.75F);
    const HdrImage image = imageOf([&](const vec3&) { return around; }, 64);
    ASSERT_TRUE(renderer_->setSurroundings({.image = image}));
    const std::vector<vec4> pixels = draw("uniform_sky", view, behind);
    const PoolPicture host(view, empty(behind));
    size_t seen = 0;
    double sum = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            float length = 0;
            const vec3 d = host.ray(x, y);
            if (!meets(view.cameraPosWorld, d, length)) continue;
            const float share = reflectance(-d.y, FluidLook().refractiveIndex);
            const vec3 expected = glm::mix(behind, around, share), is(pixels[static_cast<size_t>(y * kWidth + x)]);
            ++seen;
            const float off = glm::length(is - expected) / glm::length(expected);
            sum += double{off};
            EXPECT_LT(off, 0.05F) << x << " " << y;
        }
    EXPECT_GT(seen, pixels.size() / 5);
    EXPECT_LT(sum / static_cast<double>(seen), 0.004);
    // With what is behind as bright as what is around, water without light of its own is not seen (white furnace).
    for (const vec4& p : draw("furnace", view, around)) EXPECT_LT(glm::length(vec3(p) - around), 0.004F);
}

// One half of all directions is bright. Each pixel shows the half that the law of reflection says.
TEST_F(SurroundingsOfAHost, AreSeenInTheMirrorsDirection) {
    const vec3 axis = glm::normalize(vec3(0.8F, 0.35F, -0.5F));
    const auto side = [axis](const vec3& d) { return glm::dot(d, axis) - 0.3F; };
    const mat3 zUp(glm::rotate(mat4(1.0F), glm::radians(90.0F), vec3(1, 0, 0)));
    const auto sky = [side](const mat3& toWorld) {
        return [side, toWorld](const vec3& d) { return vec3(side(toWorld * d) > 0 ? 4.0F : 0.0F); };
    };
    const struct {
        const char* name;
        mat3 turn;
        bool mirrorX;
        std::function<void(FrameView&)> camera;
    } views[] = {
        {"plain", mat3(1.0F), false, [](FrameView&) {}},
        {"z_up", zUp, false, [&](FrameView& v) { v.view = v.view * mat4(glm::transpose(zUp)) * mat4(zUp); }},
        {"left_handed", mat3(1.0F), true,
         [](FrameView& v) {
             v.view = glm::lookAtLH(v.cameraPosWorld, vec3(0.0F, 0.0F, 0.3F), vec3(0, 1, 0));
             v.projection = glm::perspectiveLH(0.8F, static_cast<float>(kWidth) / kHeight, v.nearPlane, v.farPlane);
         }},
        {"mirrored_world", mat3(glm::scale(mat4(1.0F), vec3(1, 1, -1))), false, [](FrameView&) {}},
    };
    for (const auto& row : views) {
        FrameView view = camera();
        row.camera(view);
        const Sky hosts = sky(glm::transpose(row.turn));
        const HdrImage image = imageOf(hosts, 128);
        const HostSurroundings forms[] = {{.image = image, .turn = row.turn},
                                          {.texture = textureOf(image), .turn = row.turn},
                                          {.texture = cubeOf(hosts, 64), .turn = row.turn}};
        for (size_t form = 0; form < 3; ++form) {
            SCOPED_TRACE(fmt::format("{}, form {}", row.name, form));
            const Status set = renderer_->setSurroundings(forms[form]);
            ASSERT_TRUE(set) << set.error().message;
            const std::vector<vec4> pixels = draw(fmt::format("half_sky_{}_{}", row.name, form).c_str(), view, vec3(0.0F));
            const PoolPicture host(view, empty(vec3(0.0F)));
            size_t bright = 0, dark = 0, wrong = 0;
            for (int y = 0; y < kHeight; ++y)
                for (int x = 0; x < kWidth; ++x) {
                    float length = 0;
                    const vec3 d = host.ray(x, y);
                    if (!meets(view.cameraPosWorld, d, length)) continue;
                    const float is = side(vec3(d.x, -d.y, d.z)), share = reflectance(-d.y, FluidLook().refractiveIndex);
                    if (std::abs(is) < 0.06F) continue;  // near the border: texels, and ripples of the particles
                    (is > 0 ? bright : dark) += 1;
                    wrong += (pixels[static_cast<size_t>(y * kWidth + x)].x > 2.0F * share) == (is > 0) ? 0 : 1;
                }
            EXPECT_GT(bright, pixels.size() / 20);
            EXPECT_GT(dark, pixels.size() / 20);
            EXPECT_EQ(wrong, 0U);
        }
    }
}

// The light of all directions on what is matte: a cosine's integral over a sky that is bright above and dark below.
TEST_F(SurroundingsOfAHost, LightWhatIsMatte) {
    const HdrImage image = imageOf([](const vec3& d) { return vec3(d.y > 0 ? 1.0F : 0.0F); }, 256);
    ASSERT_TRUE(renderer_->setSurroundings({.image = image}));
    // Milk: opaque and white, so that it shows the light on it; reflection and refraction aside, 0.9 and more of it.
    FluidLook milk = clear();
    milk.scattering = vec3(4000.0F);
    FrameView view = camera();
    const PoolPicture host(view, empty(vec3(0.0F)));
    ASSERT_TRUE(renderer_->draw(view, pool_, milk, host.target()));
    const std::vector<vec4> pixels = host.pixels();
    keep("milk", pixels);
    float length = 0;
    const vec3 d = host.ray(kWidth / 2, kHeight / 2);
    ASSERT_TRUE(meets(view.cameraPosWorld, d, length));
    EXPECT_NEAR(pixels[kHeight / 2 * kWidth + kWidth / 2].x, 1.0F, 0.05F);
}

// An image counts while it is read: its texels on the GPU, 16 bytes each, beside the map.
TEST_F(SurroundingsOfAHost, KeepToTheMemoryLimitWithTheirImage) {
    constexpr int kWide = 1024;
    const HdrImage image{
        .name = "", .width = kWide, .height = 2 * kWide, .texels = std::vector<vec3>(size_t{2} * kWide * kWide, vec3(1.0F))};
    const size_t texels = size_t{16} * image.texels.size();
    const auto set = [&](size_t limit) {
        auto water = WaterRenderer::create({.memoryLimit = limit});
        EXPECT_TRUE(water) << water.error().message;
        const size_t before = (*water)->bytes();
        Status taken = (*water)->setSurroundings({.image = image});
        if (!taken) EXPECT_EQ((*water)->bytes(), before);
        return std::pair(taken, (*water)->bytes());
    };
    const auto [all, bytes] = set(SIZE_MAX);
    ASSERT_TRUE(all) << all.error().message;
    EXPECT_LT(bytes, texels);
    EXPECT_TRUE(set(bytes + texels).first);
    const Status refused = set(bytes + texels - 1).first;
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().message.find("give a smaller image"), std::string::npos) << refused.error().message;
}

TEST_F(SurroundingsOfAHost, AreRefusedInASentence) {
    HdrImage image = imageOf([](const vec3&) { return vec3(1.0F); }, 16);
    const auto refused = [&](const char* word, const HostSurroundings& surroundings) {
        const Status set = renderer_->setSurroundings(surroundings);
        ASSERT_FALSE(set) << word;
        EXPECT_NE(set.error().message.find(word), std::string::npos) << set.error().message;
    };
    refused("give one of the two", {});
    refused("give one of the two", {.image = image, .texture = 1});
    refused("perpendicular", {.image = image, .turn = mat3(2.0F)});
    refused("not a texture", {.texture = 12345});
    GLuint volume = 0;
    glCreateTextures(GL_TEXTURE_3D, 1, &volume);
    refused("use GL_TEXTURE_2D", {.texture = volume});
    glCreateTextures(GL_TEXTURE_2D, 1, &volume);
    refused("no level 0", {.texture = volume});
    glTextureStorage2D(volume, 1, GL_RGBA8UI, 4, 4);
    refused("read as floats", {.texture = volume});
    GLuint cube = 0;
    glGenTextures(1, &cube);
    glBindTexture(GL_TEXTURE_CUBE_MAP, cube);
    const auto face = [](GLenum k, GLenum format, int side) {
        glTexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + k, 0, static_cast<GLint>(format), side, side, 0, GL_RGB, GL_FLOAT, nullptr);
    };
    for (GLenum k = 0; k < 5; ++k) face(k, GL_RGB16F, 4);
    refused("six square faces", {.texture = cube});
    face(5, GL_RGB16F, 8);
    refused("six square faces", {.texture = cube});
    face(5, GL_RGB32F, 4);
    refused("six square faces", {.texture = cube});
    face(5, GL_RGB16F, 4);
    glTextureParameteri(cube, GL_TEXTURE_BASE_LEVEL, 1);
    refused("level 0 is read", {.texture = cube});
    glTextureParameteri(cube, GL_TEXTURE_BASE_LEVEL, 0);
    const Status whole = renderer_->setSurroundings({.texture = cube});
    EXPECT_TRUE(whole) << whole.error().message;
    image.texels[5].y = -1;
    refused("texel 5", {.image = image});
    image.texels[5].y = std::numeric_limits<float>::quiet_NaN();
    refused("texel 5", {.image = image});
    image.texels.pop_back();
    refused("width times height", {.image = image});
}

}  // namespace
}  // namespace rivulet::host_surroundings_test
