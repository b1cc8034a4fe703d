// Water under the lights, the shadow map and the fog of a host's scene.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "fluid/render/renderers.h"
#include "tests/unit/host_pool.h"

namespace rivulet::host_lighting_test {
namespace {

using testing::PoolPicture;

class LightOfAHost : public testing::PoolInAHost {
  protected:
    void SetUp() override {
        PoolInAHost::SetUp();
        if (!renderer_) return;
        const HdrImage black{.name = "black", .width = 2, .height = 1, .texels = {vec3(0.0F), vec3(0.0F)}};
        ASSERT_TRUE(renderer_->setSurroundings({.image = black}));
    }
    void TearDown() override {
        for (gpu::Buffer* buffer : {&foam_[0], &foam_[1], &drops_, &pendants_}) *buffer = {};
        PoolInAHost::TearDown();
    }
    // A drop in the air, a drop that hangs, flecks of spray and foam, and particles by themselves, which are droplets: all that is lit.
    void addMedia() {
        fillPool({{-0.4F, 0.5F, 0.9F, 0.3F}, {-0.6F, 0.4F, 0.7F, 0.3F}, {0.3F, 0.3F, 0.2F, 0.35F}});
        const auto fill = [](gpu::Buffer& buffer, const std::vector<vec4>& rows) {
            Result<gpu::Buffer> made = gpu::Buffer::from(rows);
            ASSERT_TRUE(made);
            buffer = std::move(*made);
        };
        std::vector<vec4> flecks, speeds;
        flecks.reserve(40);
        speeds.reserve(40);
        for (int k = 0; k < 40; ++k) {
            flecks.emplace_back(-1.0F + 0.05F * static_cast<float>(k), k % 2 == 0 ? 0.02F : 0.3F, 0.6F, 2.0F);
            speeds.emplace_back(0.2F, 0.0F, 0.0F, k % 2 == 0 ? 2.9F : 1.9F);
        }
        fill(foam_[0], flecks);
        fill(foam_[1], speeds);
        fill(drops_, {{0.1F, 0.6F, 1.0F, 0.06F}, {0.0F, -1.0F, 0.0F, 0.0F}});
        fill(pendants_,
             {{0.5F, 0.8F, 1.0F, 0.1F}, {0.0F, -1.0F, 0.0F, 1.0F}, {4.0e-3F, 1.0e-3F, 2.0e-3F, 0.0F}, {0.0F, 0.0F, 0.0F, 0.06F}, {}});
        pool_.foam = {foam_[0].name(), foam_[1].name()};
        pool_.foamCount = 40;
        pool_.drops = drops_.name();
        pool_.dropCount = 1;
        pool_.pendants = pendants_.name();
        pool_.pendantCount = 1;
    }
    std::vector<vec4> draw(const char* name, const FrameView& view, const HostLighting& lighting, const FluidLook& look,
                           const PoolPicture::Scene& scene, const RendererRow* row = nullptr) {
        const PoolPicture host(view, scene);
        const Status drawn = renderer_->draw(view, pool_, look, host.target(), row, lighting);
        EXPECT_TRUE(drawn) << drawn.error().message;
        std::vector<vec4> pixels = host.pixels();
        keep(name, pixels);
        return pixels;
    }
    static FluidLook cloudy() {
        FluidLook look = clear();
        look.scattering = vec3(2.0F);
        look.absorption = vec3(0.5F, 0.2F, 0.1F);
        return look;
    }

    gpu::Buffer foam_[2], drops_, pendants_;
};

// Towards lights whose highlights are in the picture.
const vec3 kSun(0.1F, 0.62F, -0.78F), kLow(0.35F, 0.5F, -0.8F), kLeft(-0.4F, 0.6F, -0.7F), kAbove(0.2F, 1.0F, 0.3F),
    kBehind(-0.3F, 0.7F, 1.6F);

// Radiance is linear: each light adds its own, whichever comes first.
TEST_F(LightOfAHost, IsTheSumOfItsLights) {
    addMedia();
    const PoolPicture::Scene scene = empty(vec3(0.3F, 0.2F, 0.1F));
    for (const char* name : {"screen_space", "points"}) {
        SCOPED_TRACE(name);
        const RendererRow* row = renderers().find(name);
        const auto picture = [&](const char* file, const vec3& sun, std::vector<HostLight> lights) {
            FrameView view = camera();
            view.lightDirWorld = kSun;
            view.lightColour = sun;
            return draw(fmt::format("lights_{}_{}", file, name).c_str(), view, {.lights = lights}, cloudy(), scene, row);
        };
        const vec3 sun(1.0F, 0.9F, 0.8F);
        const std::vector<HostLight> lights = {
            {kLow, {0.2F, 0.9F, 0.3F}}, {kLeft, {0.9F, 0.3F, 0.3F}}, {3.0F * kAbove, {0.3F, 0.3F, 0.9F}}};
        const std::vector<vec4> none = picture("none", vec3(0.0F), {}), all = picture("all", sun, lights);
        std::vector<std::vector<vec4>> single = {picture("sun", sun, {})};
        for (size_t k = 0; k < lights.size(); ++k) single.push_back(picture(fmt::format("{}", k).c_str(), vec3(0.0F), {lights[k]}));
        std::array<size_t, 4> lit{};
        for (size_t p = 0; p < none.size(); ++p) {
            vec3 sum(none[p]);
            for (size_t k = 0; k < single.size(); ++k) {
                const vec3 own = vec3(single[k][p]) - vec3(none[p]);
                sum += own;
                lit[k] += std::max({own.x, own.y, own.z}) > 0.05F ? 1 : 0;
            }
            // Half floats have 11 bits, and several are blended.
            EXPECT_LT(glm::length(vec3(all[p]) - sum), 0.004F * (1.0F + glm::length(sum))) << p;
        }
        for (const size_t count : lit) EXPECT_GT(count, 200U);
    }
}

// A direction has any length but 0: squares of the smallest floats are 0, those of the largest infinite.
TEST_F(LightOfAHost, ComesFromItsDirectionOfAnyLength) {
    const auto picture = [&](float length) {
        FrameView view = camera();
        view.lightDirWorld = length * kSun;
        view.lightColour = vec3(1.0F);
        const std::vector<HostLight> lights = {{length * kLow, vec3(0.5F)}};
        return draw("direction", view, {.lights = lights}, cloudy(), empty(vec3(0.1F)));
    };
    const std::vector<vec4> plain = picture(1);
    for (const float length : {0x1p-84F, 0x1p-100F, 0x1p100F}) EXPECT_EQ(picture(length), plain) << length;
}

TEST_F(LightOfAHost, WithoutColourChangesNoBit) {
    addMedia();
    FrameView view = camera();
    view.lightDirWorld = kSun;
    view.lightColour = vec3(2.0F);
    const PoolPicture::Scene scene = empty(vec3(0.3F, 0.2F, 0.1F));
    const std::vector<HostLight> dark = {{kLow, vec3(0.0F)}, {kLeft, vec3(0.0F)}};
    EXPECT_EQ(draw("dark", view, {.lights = dark}, cloudy(), scene), draw("alone", view, {}, cloudy(), scene));
}

// A map of one half plane: beyond x = `edge` the light is blocked 1 m above the water.
struct ShadowMap {
    GLuint texture = 0;
    HostShadow shadow;
};
ShadowMap shadowMap(const vec3& towards, float edge, bool zeroToOne, bool reversed, int side, GLenum format, float unit) {
    const vec3 d = glm::normalize(towards);
    const mat4 view = glm::lookAt(10.0F * d, vec3(0.0F), vec3(0, 1, 0));
    mat4 projection =
        zeroToOne ? glm::orthoRH_ZO(-3.0F, 3.0F, -3.0F, 3.0F, 1.0F, 20.0F) : glm::ortho(-3.0F, 3.0F, -3.0F, 3.0F, 1.0F, 20.0F);
    if (reversed) {
        mat4 turned(1.0F);
        turned[2].z = -1;
        if (zeroToOne) turned[3].z = 1;
        projection = turned * projection;
    }
    const mat4 clip = projection * view, back = glm::inverse(clip);
    std::vector<float> depths;
    depths.reserve(static_cast<size_t>(side * side));
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const vec4 at = back * vec4((2 * static_cast<float>(x) + 1) / static_cast<float>(side) - 1,
                                        (2 * static_cast<float>(y) + 1) / static_cast<float>(side) - 1, 0.0F, 1.0F);
            const vec3 blocker = vec3(at) + d * ((1.0F - at.y) / d.y);
            const vec4 seen = clip * vec4(blocker, 1.0F);
            const float z = zeroToOne ? seen.z : 0.5F * seen.z + 0.5F;
            // Where the ray that passes the blocker reaches the water.
            const vec3 shaded = vec3(at) - d * (at.y / d.y);
            depths.push_back(shaded.x > edge ? z : reversed ? 0.0F : 1.0F);
        }
    ShadowMap map;
    glCreateTextures(GL_TEXTURE_2D, 1, &map.texture);
    glTextureStorage2D(map.texture, 1, format, side, side);
    glTextureSubImage2D(map.texture, 0, 0, 0, side, side, format == GL_R32F ? GL_RED : GL_DEPTH_COMPONENT, GL_FLOAT, depths.data());
    glTextureParameteri(map.texture, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);  // as a host's shader reads it
    mat4 metres(1 / unit);
    metres[3].w = 1;
    map.shadow = {.texture = map.texture, .projection = clip * metres, .zeroToOne = zeroToOne, .reversed = reversed, .bias = 0.002F};
    return map;
}

// Where the map says shade there is no light of the sun, elsewhere all of it, and the border lies within a texel of the blocker's edge.
TEST_F(LightOfAHost, IsShadedWhereTheShadowMapSays) {
    constexpr float kEdge = 0.15F;
    constexpr int kSide = 256;
    const vec3 towards(0.2F, 0.8F, -0.5F);
    const float texel = 6.0F / kSide;
    const struct {
        const char* name;
        bool zeroToOne, reversed;
        GLenum format;
        float unit;
        HostLight other;
    } rows[] = {{"plain", false, false, GL_DEPTH_COMPONENT24, 1, {}},
                {"zero_to_one", true, false, GL_DEPTH_COMPONENT32F, 1, {}},
                {"reversed", true, true, GL_DEPTH_COMPONENT32F, 1, {}},
                {"reversed_symmetric", false, true, GL_DEPTH_COMPONENT24, 1, {}},
                {"floats", false, false, GL_R32F, 1, {}},
                {"centimetres", false, false, GL_DEPTH_COMPONENT24, 100, {}},
                {"another_light", false, false, GL_DEPTH_COMPONENT24, 1, {kLeft, vec3(0.5F)}}};
    // Milk shows the light at each place.
    FluidLook milk = clear();
    milk.scattering = vec3(4000.0F);
    const PoolPicture::Scene scene = empty(vec3(0.1F));
    for (const auto& row : rows) {
        SCOPED_TRACE(row.name);
        FrameView view = camera();
        view.lightDirWorld = towards;
        const auto picture = [&](const char* what, float sun, const HostShadow& shadow) {
            view.lightColour = vec3(sun);
            FrameView own = view;
            if (row.unit != 1) {
                own.view[3] = vec4(row.unit * vec3(own.view[3]), 1.0F);
                own.nearPlane *= row.unit;
                own.farPlane *= row.unit;
                own.unitsPerMetre = row.unit;
                own.projection = glm::perspective(0.8F, static_cast<float>(kWidth) / kHeight, own.nearPlane, own.farPlane);
                own.cameraPosWorld *= row.unit;
            }
            return draw(fmt::format("shadow_{}_{}", row.name, what).c_str(), own,
                        {.lights = std::span(&row.other, row.other.colour == vec3(0.0F) ? 0 : 1), .shadow = shadow}, milk, scene);
        };
        const ShadowMap map = shadowMap(towards, kEdge, row.zeroToOne, row.reversed, kSide, row.format, row.unit);
        const std::vector<vec4> dark = picture("dark", 0, {}), lit = picture("lit", 1, {}), half = picture("half", 1, map.shadow);
        view.lightColour = vec3(1.0F);
        const PoolPicture host(view, scene);
        size_t shaded = 0, bright = 0, highlight = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                float length = 0;
                const vec3 d = host.ray(x, y);
                if (!meets(view.cameraPosWorld, d, length)) continue;
                const auto k = static_cast<size_t>(y * kWidth + x);
                const float at = view.cameraPosWorld.x + length * d.x - kEdge;
                if (at > 0.5F * kSpacing + texel) {
                    EXPECT_LT(glm::length(vec3(half[k]) - vec3(dark[k])), 0.004F) << x << " " << y;
                    ++shaded;
                    highlight += lit[k].x > 0.5F ? 1 : 0;
                } else if (at < -0.5F * kSpacing - texel) {
                    EXPECT_EQ(half[k], lit[k]) << x << " " << y;
                    ++bright;
                }
            }
        EXPECT_GT(shaded, 2000U);
        EXPECT_GT(bright, 2000U);
        EXPECT_GT(highlight, 20U) << "that the shade takes away";
    }
}

// In shade of the whole pool, nothing that is drawn has light of the sun: not foam, spray and drops either. A sun before the eye gives
// highlights, one behind it the glint of the far side of a drop that hangs.
TEST_F(LightOfAHost, ReachesNothingInTheShade) {
    addMedia();
    for (const vec3& sun : {kSun, kBehind})
        for (const char* name : {"screen_space", "points"}) {
            SCOPED_TRACE(name);
            FrameView view = camera();
            view.lightDirWorld = sun;
            const ShadowMap map = shadowMap(sun, -10.0F, false, false, 64, GL_DEPTH_COMPONENT24, 1);
            const auto picture = [&](float light, const HostShadow& shadow) {
                view.lightColour = vec3(light);
                return draw(fmt::format("shade_{}_{}_{}", name, sun.z < 0 ? "before" : "behind", shadow.texture != 0 ? 2 : light).c_str(),
                            view, {.shadow = shadow}, cloudy(), empty(vec3(0.1F)), renderers().find(name));
            };
            const std::vector<vec4> dark = picture(0, {});
            EXPECT_NE(picture(1, {}), dark);
            EXPECT_EQ(picture(1, map.shadow), dark);
        }
}

// The picture's own fog, computed here. `passes`: the share of light that comes through.
struct Fog {
    const char* name;
    HostFog fog;
    float passes(float distance) const {
        const float thick = fog.density * distance;
        if (fog.kind == HostFog::exponential) return std::exp(-thick);
        if (fog.kind == HostFog::exponentialSquared) return std::exp(-thick * thick);
        return std::clamp((fog.end - distance) / (fog.end - fog.start), 0.0F, 1.0F);
    }
    static float display(float c) { return c < 0.0031308F ? 12.92F * c : 1.055F * std::pow(c, 1 / 2.4F) - 0.055F; }
    static float linear(float c) { return c < 0.04045F ? c / 12.92F : std::pow((c + 0.055F) / 1.055F, 2.4F); }
    vec3 mixed(const vec3& c, float passes) const {
        if (!fog.display) return glm::mix(fog.colour, c, passes);
        const vec3 m = glm::mix(fog.colour, vec3(display(c.x), display(c.y), display(c.z)), passes);
        return {linear(m.x), linear(m.y), linear(m.z)};
    }
};
const vec3 kFogColour(0.6F, 0.65F, 0.7F);
const Fog kFogs[] = {{"exponential", {.kind = HostFog::exponential, .colour = kFogColour, .density = 0.25F}},
                     {"squared", {.kind = HostFog::exponentialSquared, .colour = kFogColour, .density = 0.25F}},
                     {"linear", {.kind = HostFog::linear, .colour = kFogColour, .start = 1.0F, .end = 9.0F}},
                     {"along_view", {.kind = HostFog::exponential, .colour = kFogColour, .density = 0.25F, .alongView = true}},
                     {"display", {.kind = HostFog::exponential, .colour = kFogColour, .density = 0.25F, .display = true}}};

// A chequered floor 0.8 m below the water and a wall behind, in fog.
PoolPicture::Scene foggy(const Fog& fog, const vec3& forward) {
    return [fog, forward](const vec3& eye, const vec3& dir, float& length) {
        const float floor = dir.y < 0 ? (-0.8F - eye.y) / dir.y : INFINITY, wall = dir.z < 0 ? (-6.0F - eye.z) / dir.z : INFINITY;
        length = std::min(floor, wall);
        const vec3 at = eye + length * dir;
        const bool odd = (static_cast<int>(std::floor(2 * at.x) + std::floor(2 * (floor < wall ? at.z : at.y))) & 1) != 0;
        const vec3 c = odd ? vec3(0.3F, 0.1F, 0.05F) : vec3(0.05F, 0.1F, 0.3F);
        return fog.mixed(c, fog.passes(fog.fog.alongView ? length * glm::dot(dir, forward) : length));
    };
}

// Water that neither absorbs, scatters nor bends light is not seen, in any fog.
TEST_F(LightOfAHost, LeavesFogAsItIsWhereWaterIsAsAir) {
    FluidLook air = clear();
    air.refractiveIndex = 1.0F;
    const FrameView view = camera();
    const vec3 forward(-glm::transpose(mat3(view.view))[2]);
    for (const Fog& row : kFogs) {
        SCOPED_TRACE(row.name);
        const PoolPicture::Scene scene = foggy(row, forward);
        const std::vector<vec4> dry = PoolPicture(view, scene).pixels();
        keep(fmt::format("fog_dry_{}", row.name).c_str(), dry);
        const std::vector<vec4> wet = draw(fmt::format("fog_air_{}", row.name).c_str(), view, {.fog = row.fog}, air, scene);
        // At the picture's edge refraction reads one pixel further in.
        for (int y = 1; y < kHeight - 1; ++y)
            for (int x = 1; x < kWidth - 1; ++x) {
                const auto k = static_cast<size_t>(y * kWidth + x);
                EXPECT_LT(glm::length(vec3(wet[k]) - vec3(dry[k])), 0.003F) << x << " " << y;
            }
    }
}

// Black water, in which no light returns: what is seen of it is the fog in front of it, 1 - passes of it.
TEST_F(LightOfAHost, FogsWaterByItsOwnDistance) {
    FluidLook ink = clear();
    ink.absorption = vec3(1.0e4F);
    ink.refractiveIndex = 1.0F;
    const struct {
        const char* name;
        float unit;
        bool srgb;
        std::function<void(FrameView&)> camera;
    } views[] = {
        {"plain", 1, false, [](FrameView&) {}},
        // Without an eye: distances are depths.
        {"orthographic", 1, false, [](FrameView& v) { v.projection = glm::ortho(-1.6F, 1.6F, -1.2F, 1.2F, v.nearPlane, v.farPlane); }},
        {"mirrored", 1, false, [](FrameView& v) { v.projection = glm::scale(mat4(1.0F), vec3(1, -1, 1)) * v.projection; }},
        {"centimetres", 100, false, [](FrameView&) {}},
        {"srgb", 1, true, [](FrameView&) {}}};
    for (const auto& seen : views)
        for (const Fog& row : kFogs) {
            SCOPED_TRACE(fmt::format("{}, {}", seen.name, row.name));
            FrameView view = camera();
            seen.camera(view);
            const vec3 forward(-glm::transpose(mat3(view.view))[2]);
            const PoolPicture::Scene linear = foggy(row, forward);
            const PoolPicture::Scene stored = [&](const vec3& eye, const vec3& dir, float& length) {
                const vec3 c = linear(eye, dir, length);
                return seen.srgb ? vec3(Fog::display(c.x), Fog::display(c.y), Fog::display(c.z)) : c;
            };
            const PoolPicture host(view, stored, seen.srgb ? GL_RGBA8 : GL_RGBA16F);
            FrameView theirs = view;  // clip depths do not change with the unit
            HostFog fog = row.fog;
            theirs.unitsPerMetre = seen.unit;
            theirs.view[3] = vec4(seen.unit * vec3(view.view[3]), 1.0F);
            theirs.nearPlane *= seen.unit;
            theirs.farPlane *= seen.unit;
            if (seen.unit != 1)
                theirs.projection = glm::perspective(0.8F, static_cast<float>(kWidth) / kHeight, theirs.nearPlane, theirs.farPlane);
            fog.density /= seen.unit;
            fog.start *= seen.unit;
            fog.end *= seen.unit;
            const Status drawn = renderer_->draw(theirs, pool_, ink, host.target(), nullptr, {.fog = fog});
            ASSERT_TRUE(drawn) << drawn.error().message;
            std::vector<vec4> pixels = host.pixels();
            if (seen.srgb)
                for (vec4& p : pixels) p = vec4(Fog::linear(p.x), Fog::linear(p.y), Fog::linear(p.z), p.w);
            keep(fmt::format("fog_black_{}_{}", seen.name, row.name).c_str(), pixels);
            size_t count = 0;
            for (int y = 0; y < kHeight; ++y)
                for (int x = 0; x < kWidth; ++x) {
                    float length = 0;
                    const vec3 d = host.ray(x, y);
                    if (!meets(host.eye(x, y), d, length)) continue;
                    ++count;
                    const vec3 expected = row.mixed(vec3(0.0F), row.passes(row.fog.alongView ? length * glm::dot(d, forward) : length));
                    EXPECT_LT(glm::length(vec3(pixels[static_cast<size_t>(y * kWidth + x)]) - expected), 0.01F) << x << " " << y;
                }
            EXPECT_GT(count, 4000U);
        }
}

// Far away everything is fog: water, spray and drops too, as exp(-density distance) says of how much is left.
TEST_F(LightOfAHost, EndsInFogFarAway) {
    addMedia();
    FrameView view = camera();
    view.lightDirWorld = kSun;
    view.lightColour = vec3(1.0F);
    const vec3 away = 30.0F * glm::normalize(view.cameraPosWorld);
    view.cameraPosWorld += away;
    view.view = glm::lookAt(view.cameraPosWorld, vec3(0.0F), vec3(0, 1, 0));
    view.farPlane = 100;
    view.projection = glm::perspective(0.09F, static_cast<float>(kWidth) / kHeight, view.nearPlane, view.farPlane);
    for (const char* name : {"screen_space", "points"}) {
        const auto picture = [&](const char* file, const HostFog& fog) {
            return draw(fmt::format("fog_{}_{}", file, name).c_str(), view, {.fog = fog}, cloudy(), empty(kFogColour),
                        renderers().find(name));
        };
        size_t water = 0;
        for (const vec4& p : picture("none", {})) water += glm::length(vec3(p) - kFogColour) > 0.05F ? 1 : 0;
        EXPECT_GT(water, 4000U) << name;
        const HostFog far{.kind = HostFog::exponential, .colour = kFogColour, .density = 0.2F};
        // Nearer than 30 m is nothing; the brightest light of the scene is a glint of 8.
        const float most = 8.0F * std::exp(-0.2F * 29.0F);
        for (const vec4& p : picture("far", far)) EXPECT_LT(glm::length(vec3(p) - kFogColour), most + 0.001F);
    }
}

// Where water reflects the scene, what it shows of it is fogged for the way from the surface, and then for its own distance: with
// exponential fog, a mirror shows the fog of the whole way. Where the picture's fog has hidden more than that, it cannot be found again.
TEST_F(LightOfAHost, ReflectsTheSceneInItsFog) {
    const Fog fogs[] = {{"exponential", {.kind = HostFog::exponential, .colour = kFogColour, .density = 0.3F}},
                        {"squared", {.kind = HostFog::exponentialSquared, .colour = kFogColour, .density = 0.3F}},
                        {"linear", {.kind = HostFog::linear, .colour = kFogColour, .start = 0.5F, .end = 6.0F}},
                        {"hidden", {.kind = HostFog::linear, .colour = kFogColour, .start = 0.5F, .end = 4.0F}}};
    const vec3 paint(2.0F, 0.5F, 0.1F);
    FluidLook ink = clear();
    ink.absorption = vec3(1.0e4F);
    FrameView view = camera();
    view.cameraPosWorld = vec3(0.0F, 0.5F, 2.4F);
    view.view = glm::lookAt(view.cameraPosWorld, vec3(0.0F, 0.1F, -1.0F), vec3(0, 1, 0));
    const PoolPicture host(view, empty(vec3(0.0F)));
    // A bright wall behind the pool, seen in it.
    const auto scene = [&](const Fog* fog) {
        return [fog, paint](const vec3& eye, const vec3& dir, float& length) {
            const float wall = dir.z < 0 ? (-2.2F - eye.z) / dir.z : INFINITY;
            length = eye.y + wall * dir.y < 3.0F ? wall : INFINITY;
            if (!std::isfinite(length)) return fog != nullptr ? kFogColour : vec3(0.0F);
            return fog != nullptr ? fog->mixed(paint, fog->passes(length)) : paint;
        };
    };
    const std::vector<vec4> bare = draw("mirror_clear", view, {}, ink, scene(nullptr));
    for (const Fog& fog : fogs) {
        SCOPED_TRACE(fog.name);
        const std::vector<vec4> fogged = draw(fmt::format("mirror_{}", fog.name).c_str(), view, {.fog = fog.fog}, ink, scene(&fog));
        size_t seen = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                float length = 0;
                const vec3 d = host.ray(x, y);
                const auto k = static_cast<size_t>(y * kWidth + x);
                if (!meets(view.cameraPosWorld, d, length)) continue;
                const vec3 at = view.cameraPosWorld + length * d;
                const float onwards = (-2.2F - at.z) / d.z, share = reflectance(-d.y, FluidLook().refractiveIndex);
                // Where it mirrors the wall alone.
                const float met = bare[k].x / (paint.x * share);
                if (met < 0.97F || met > 1.03F) continue;
                const float own = glm::distance(view.cameraPosWorld, at + onwards * vec3(d.x, -d.y, d.z));
                const float passes = std::min(fog.passes(onwards), fog.passes(own) / fog.passes(length));
                const vec3 expected = fog.mixed(share * fog.mixed(paint, passes), fog.passes(length));
                EXPECT_LT(glm::length(vec3(fogged[k]) - expected), 0.02F) << x << " " << y;
                ++seen;
            }
        EXPECT_GT(seen, 400U);
    }
}

TEST_F(LightOfAHost, IsRefusedInASentence) {
    const FrameView view = camera();
    const PoolPicture host(view, empty(vec3(0.1F)));
    const auto refused = [&](const char* word, const HostLighting& lighting) {
        const Status drawn = renderer_->draw(view, pool_, {}, host.target(), nullptr, lighting);
        ASSERT_FALSE(drawn) << word;
        EXPECT_NE(drawn.error().message.find(word), std::string::npos) << drawn.error().message;
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<HostLight> many(8);
    refused("7 at most", {.lights = many});
    const HostLight none{vec3(0.0F), vec3(1.0F)}, lost{vec3(0, 1, 0), vec3(nan)};
    refused("lights[0]: the direction is 0", {.lights = std::span(&none, 1)});
    const HostLight two[] = {{vec3(0, 1, 0), vec3(1.0F)}, {vec3(0, 1, 0), vec3(-1.0F)}};
    refused("lights[0]: the colour is negative or not finite", {.lights = std::span(&lost, 1)});
    refused("lights[1]: the colour is negative or not finite", {.lights = two});
    refused("not a texture", {.shadow = {.texture = 54321}});
    GLuint array = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &array);
    refused("as a texture view", {.shadow = {.texture = array}});
    const auto map = [](GLenum format) {
        GLuint name = 0;
        glCreateTextures(GL_TEXTURE_2D, 1, &name);
        glTextureStorage2D(name, 2, format, 2, 2);
        return name;
    };
    for (const GLenum format : {GL_R32UI, GL_R16I, GL_STENCIL_INDEX8}) refused("read as floats", {.shadow = {.texture = map(format)}});
    const GLuint stencil = map(GL_DEPTH24_STENCIL8), swizzled = map(GL_DEPTH_COMPONENT24), higher = map(GL_DEPTH_COMPONENT24);
    glTextureParameteri(stencil, GL_DEPTH_STENCIL_TEXTURE_MODE, GL_STENCIL_INDEX);
    refused("stencils", {.shadow = {.texture = stencil}});
    glTextureParameteri(swizzled, GL_TEXTURE_SWIZZLE_R, GL_ONE);
    refused("GL_TEXTURE_SWIZZLE_R", {.shadow = {.texture = swizzled}});
    glTextureParameteri(higher, GL_TEXTURE_BASE_LEVEL, 1);
    refused("level 0 is read", {.shadow = {.texture = higher}});
    refused("not finite", {.shadow = {.texture = array, .projection = mat4(nan)}});
    refused("ends beyond its start", {.fog = {.kind = HostFog::linear, .start = 2, .end = 2}});
    refused("give 0 or more", {.fog = {.kind = HostFog::exponential, .density = -1}});
    refused("fog: the colour", {.fog = {.kind = HostFog::exponential, .colour = vec3(nan)}});
}

}  // namespace
}  // namespace rivulet::host_lighting_test
