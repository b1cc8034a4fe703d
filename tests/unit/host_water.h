// HostWater: a context of its own, a world on backend gl and a renderer, for tests that draw into a HostScene.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#include "engine/app/capture.h"
#include "engine/gpu/device_gl.h"
#include "fluid/render/fluid_view.h"
#include "fluid/render/water_renderer.h"
#include "fluid/sim/world/fluid_world.h"
#include "tests/unit/host_fixture.h"
#include "tests/unit/opengl_test.h"

namespace rivulet::testing {

// Writes colours of a screen, the bottom row first, to $RIVULET_PICTURES/NAME.png, for a person to look at.
inline void keepPicture(const char* name, const std::vector<vec4>& pixels, int width, int height) {
    const char* folder = std::getenv("RIVULET_PICTURES");
    if (folder == nullptr) return;
    std::vector<uint8_t> rgba;
    rgba.reserve(4 * pixels.size());
    for (int y = height - 1; y >= 0; --y)
        for (int x = 0; x < width; ++x)
            for (int k = 0; k < 4; ++k) {
                const float c = std::clamp(pixels[static_cast<size_t>(y * width + x)][k], 0.0F, 1.0F);
                rgba.push_back(k == 3 ? 255 : static_cast<uint8_t>(255 * c + 0.5F));
            }
    EXPECT_TRUE(writePng(fmt::format("{}/{}.png", folder, name), rgba, width, height));
}

// A block of water that is about to fall.
inline FluidParams hostWater() {
    FluidParams f;
    f.spacing = 0.04F;
    f.box.max = vec3(1.0F, 1.0F, 1.0F);
    f.blocks = {{vec3(0.1F, 0.0F, 0.2F), vec3(0.9F, 0.4F, 0.8F), vec3(0.0F)}};
    return f;
}

// Of a world on backend gl.
inline FluidView viewOf(const FluidWorld& world) {
    const ParticleView p = world.particles();
    FluidView v;
    v.position = static_cast<unsigned>(p.drawn->handle());
    v.velocity = static_cast<unsigned>(p.velocity->handle());
    v.id = static_cast<unsigned>(p.id->handle());
    v.count = p.slots;
    v.spacing = p.spacing;
    v.radius = 0.55F * p.spacing;
    v.bounds.add(world.params().box.min);
    v.bounds.add(world.params().box.max);
    return v;
}

class HostWater : public OpenGlTest {
  protected:
    explicit HostWater(int frames) : frames_(frames) {}
    void SetUp() override {
        OpenGlTest::SetUp();
        if (!context_) return;
        device_ = makeGlDevice(ShaderFiles::developer());
        auto world = FluidWorld::create(*device_, hostWater(), {}, {});
        ASSERT_TRUE(world) << world.error().message;
        world_ = std::move(*world);
        for (int k = 0; k < frames_; ++k) world_->step({}, 1.0 / 60);
        device_->finish();
        auto renderer = WaterRenderer::create({});
        ASSERT_TRUE(renderer) << renderer.error().message;
        renderer_ = std::move(*renderer);
    }
    void TearDown() override {
        OpenGlTest::TearDown();
        if (context_) glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
        renderer_.reset();
        world_.reset();
        device_.reset();
    }

    int frames_;  // of 1/60 s that the water has fallen
    std::unique_ptr<Device> device_;
    std::unique_ptr<FluidWorld> world_;
    std::unique_ptr<WaterRenderer> renderer_;
};

}  // namespace rivulet::testing
