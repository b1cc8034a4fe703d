// Shared by tests of panels and windows: an OpenGL context whose errors fail the test, a framebuffer to draw into, and the InputEvents
// of a person who begins with the mouse elsewhere.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "engine/app/context_egl.h"
#include "engine/app/input_events.h"
#include "engine/gpu/debug.h"
#include "engine/gpu/framebuffer.h"

namespace rivulet::testing {

class FramebufferFixture : public ::testing::Test {
  protected:
    // `window`: as InputEvents::size; `pixels`: of the framebuffer.
    void open(const ivec2& window, const ivec2& pixels) {
        Result<ContextEgl> made = ContextEgl::create();
        ASSERT_TRUE(made) << made.error().message;
        context_.emplace(std::move(*made));
        messages_.emplace(Log{});
        input_.size = window;
        input_.framebuffer = pixels;
        gpu::TextureDesc desc;
        desc.width = pixels.x;
        desc.height = pixels.y;
        auto picture = gpu::Texture::create(desc);
        ASSERT_TRUE(picture) << picture.error().message;
        picture_ = std::move(*picture);
        target_ = gpu::Framebuffer(picture_, nullptr);
    }
    void TearDown() override {
        if (messages_) {
            EXPECT_EQ(messages_->errors(), 0) << messages_->lastError();
        }
    }
    // Presses, wheel and text hold for one frame.
    void endFrame() {
        input_.mouseDelta = input_.wheel = vec2(0.0F);
        input_.keysPressed.clear();
        input_.text.clear();
        for (bool* each : {input_.buttonPressed, input_.buttonReleased}) std::fill(each, each + 3, false);
    }

    std::optional<ContextEgl> context_;  // first: it goes last
    std::optional<gpu::DebugMessages> messages_;
    gpu::Texture picture_;
    gpu::Framebuffer target_;
    InputEvents input_;
};

}  // namespace rivulet::testing
