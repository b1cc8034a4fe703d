// A host's picture made on the CPU, a flat pool of resting particles drawn into it, and what geometry says of each pixel of its surface.
#pragma once

#include <gtest/gtest.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <memory>
#include <numeric>
#include <vector>

#include "engine/gpu/buffer.h"
#include "engine/render/frame_view.h"
#include "fluid/render/water_renderer.h"
#include "tests/unit/host_water.h"
#include "tests/unit/opengl_test.h"

namespace rivulet::testing {

// A picture of floats, linear, with depth: of a host.
class PoolPicture {
  public:
    static constexpr int kWidth = 160, kHeight = 120;
    // The colour of a ray and its length, m; infinite: nothing is met.
    using Scene = std::function<vec3(const vec3& eye, const vec3& dir, float& length)>;
    PoolPicture(const FrameView& view, const Scene& scene, GLenum format = GL_RGBA16F) : view_(view) {
        std::vector<vec4> colours;
        std::vector<float> depths;
        colours.reserve(size_t{kWidth} * kHeight);
        depths.reserve(size_t{kWidth} * kHeight);
        const mat4 clip = view.projection * view.view;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                float length = INFINITY;
                const vec3 from = eye(x, y), d = ray(x, y), c = scene(from, d, length);
                colours.emplace_back(c, 1.0F);
                const vec4 at = clip * vec4(from + (std::isfinite(length) ? length : 0.0F) * d, 1.0F);
                depths.push_back(std::isfinite(length) ? std::min(0.5F * at.z / at.w + 0.5F, 1.0F) : 1.0F);
            }
        glCreateFramebuffers(1, &framebuffer_);
        const auto attach = [&](GLenum where, GLenum made, GLenum layout, const void* texels) {
            GLuint name = 0;
            glCreateTextures(GL_TEXTURE_2D, 1, &name);
            glTextureStorage2D(name, 1, made, kWidth, kHeight);
            glTextureSubImage2D(name, 0, 0, 0, kWidth, kHeight, layout, GL_FLOAT, texels);
            glNamedFramebufferTexture(framebuffer_, where, name, 0);
        };
        attach(GL_COLOR_ATTACHMENT0, format, GL_RGBA, colours.data());
        attach(GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, depths.data());
    }
    HostTarget target() const { return {.framebuffer = framebuffer_, .width = kWidth, .height = kHeight}; }
    const FrameView& view() const { return view_; }
    std::vector<vec4> pixels() const {
        std::vector<vec4> all(size_t{kWidth} * kHeight);
        glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
        glReadPixels(0, 0, kWidth, kHeight, GL_RGBA, GL_FLOAT, all.data());
        return all;
    }
    // Unit, world: through the middle of a pixel.
    vec3 ray(int x, int y) const { return parallel() ? forward() : glm::normalize(through(x, y) - view_.cameraPosWorld); }
    // Where it starts: with an orthographic projection, at depth 0.
    vec3 eye(int x, int y) const {
        const vec3 at = through(x, y);
        return parallel() ? at - glm::dot(at - view_.cameraPosWorld, forward()) * forward() : view_.cameraPosWorld;
    }
    vec3 forward() const { return -glm::transpose(mat3(view_.view))[2]; }

  private:
    bool parallel() const { return view_.projection[3][3] == 1; }
    // A point within any clip space.
    vec3 through(int x, int y) const {
        const glm::dmat4 back = glm::inverse(glm::dmat4(view_.projection) * glm::dmat4(view_.view));
        const glm::dvec4 at = back * glm::dvec4((2 * x + 1.0) / kWidth - 1, (2 * y + 1.0) / kHeight - 1, 0.5, 1);
        return vec3(glm::dvec3(at) / at.w);
    }

    FrameView view_;
    GLuint framebuffer_ = 0;
};

class PoolInAHost : public OpenGlTest {
  protected:
    static constexpr int kWidth = PoolPicture::kWidth, kHeight = PoolPicture::kHeight;
    static constexpr float kSpacing = 0.05F, kHalf = 2.0F;  // m; half the side of the pool
    static constexpr int kLayers = 6;

    void SetUp() override {
        OpenGlTest::SetUp();
        if (!context_) return;
        fillPool({});
        auto renderer = WaterRenderer::create({});
        ASSERT_TRUE(renderer) << renderer.error().message;
        renderer_ = std::move(*renderer);
    }
    void TearDown() override {
        OpenGlTest::TearDown();
        for (gpu::Buffer* buffer : {&position_, &velocity_, &id_}) *buffer = {};
        renderer_.reset();
    }
    // The pool, and other particles: xyz m, w density over rest density.
    void fillPool(const std::vector<vec4>& strays) {
        std::vector<vec4> places = strays;
        const int side = static_cast<int>(std::lround(2 * kHalf / kSpacing));
        places.reserve(strays.size() + static_cast<size_t>(side * side * kLayers));
        for (int y = 0; y < kLayers; ++y)
            for (int z = 0; z < side; ++z)
                for (int x = 0; x < side; ++x)
                    places.emplace_back((static_cast<float>(x) + 0.5F) * kSpacing - kHalf, -(static_cast<float>(y) + 0.5F) * kSpacing,
                                        (static_cast<float>(z) + 0.5F) * kSpacing - kHalf, 1.0F);
        std::vector<uint32_t> ids(places.size());
        std::iota(ids.begin(), ids.end(), 0U);
        const auto fill = [](gpu::Buffer& buffer, const auto& rows) {
            auto made = gpu::Buffer::from(rows);
            ASSERT_TRUE(made);
            buffer = std::move(*made);
        };
        fill(position_, places);
        fill(velocity_, std::vector<vec4>(places.size(), vec4(0.0F)));
        fill(id_, ids);
        pool_.position = position_.name();
        pool_.velocity = velocity_.name();
        pool_.id = id_.name();
        pool_.count = static_cast<uint32_t>(places.size());
        pool_.spacing = kSpacing;
        pool_.radius = 0.55F * kSpacing;
    }
    // From 1.5 m above the pool, which covers the lower part of the picture.
    static FrameView camera() {
        FrameView v;
        v.cameraPosWorld = vec3(0.2F, 1.5F, 2.6F);
        v.view = glm::lookAt(v.cameraPosWorld, vec3(0.0F, 0.0F, 0.3F), vec3(0, 1, 0));
        v.nearPlane = 0.1F;
        v.farPlane = 40.0F;
        v.projection = glm::perspective(0.8F, static_cast<float>(kWidth) / kHeight, v.nearPlane, v.farPlane);
        v.lightColour = vec3(0.0F);
        return v;
    }
    static FluidLook clear() {
        FluidLook look;
        look.absorption = look.scattering = vec3(0.0F);
        return look;
    }
    // Whether a ray meets the pool's surface, at least half a metre from its sides; the distance, m.
    static bool meets(const vec3& eye, const vec3& dir, float& length) {
        length = -eye.y / dir.y;
        const vec3 at = eye + length * dir;
        return dir.y < 0 && std::max(std::abs(at.x), std::abs(at.z)) < kHalf - 0.5F;
    }
    // Exact for unpolarised light, from air (Fresnel 1823). `c`: cosine of the angle of incidence.
    static float reflectance(float c, float index) {
        const float t = std::sqrt(1 - (1 - c * c) / (index * index));
        const float s = (c - index * t) / (c + index * t), p = (index * c - t) / (index * c + t);
        return 0.5F * (s * s + p * p);
    }
    // A uniform background, endlessly far away.
    static PoolPicture::Scene empty(const vec3& colour) {
        return [colour](const vec3&, const vec3&, float&) { return colour; };
    }
    // As a screen shows it: see keepPicture().
    static void keep(const char* name, std::vector<vec4> pixels) {
        for (vec4& p : pixels)
            for (int k = 0; k < 3; ++k) p[k] = std::pow(std::max(p[k], 0.0F), 1 / 2.2F);
        keepPicture(name, pixels, kWidth, kHeight);
    }

    std::unique_ptr<WaterRenderer> renderer_;
    gpu::Buffer position_, velocity_, id_;
    FluidView pool_;
};

}  // namespace rivulet::testing
