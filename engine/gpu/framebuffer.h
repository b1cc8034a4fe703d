// Framebuffer: textures as render targets. Passes of a frame graph rarely need one, because PassContext::drawTo creates it.
#pragma once

#include <span>

#include "engine/core/math.h"
#include "engine/gpu/gl_object.h"
#include "engine/gpu/texture.h"

namespace rivulet::gpu {

// One level of a texture. layer -1: all layers (flat textures have one).
struct Attachment {
    const Texture* texture = nullptr;
    int mip = 0;
    int layer = -1;
};

class Framebuffer {
  public:
    Framebuffer() = default;
    // colours[k] is the fragment shader's output k; a null texture leaves an output unused. No attachment at all is a programming
    // error, and so is a framebuffer that GL reports as incomplete (ASSERT names the attachments).
    Framebuffer(std::span<const Attachment> colours, const Attachment& depth);
    Framebuffer(const Texture& colour, const Texture* depth);

    unsigned name() const { return name_.name(); }
    int width() const { return width_; }
    int height() const { return height_; }
    explicit operator bool() const { return static_cast<bool>(name_); }

    void bind() const;  // also sets the viewport to the whole framebuffer
    void clearColour(const vec4& value, int index = 0) const;
    void clearDepth(float value = 1) const;
    // Copies colour 0 to another framebuffer (0: the window), scaled to width x height with linear filtering.
    void blitTo(unsigned framebuffer, int width, int height) const;

  private:
    FramebufferName name_;
    int width_ = 0, height_ = 0;
};

}  // namespace rivulet::gpu
