#include "engine/gpu/framebuffer.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <array>
#include <new>
#include <string>

#include "engine/core/assert.h"
#include "engine/gpu/gl_error.h"

namespace rivulet::gpu {
namespace {

constexpr size_t kMostColours = 8;  // the minimum that GL guarantees

void attach(GLuint framebuffer, GLenum point, const Attachment& a) {
    if (a.layer < 0)
        glNamedFramebufferTexture(framebuffer, point, a.texture->name(), a.mip);
    else
        glNamedFramebufferTextureLayer(framebuffer, point, a.texture->name(), a.mip, a.layer);
}

std::string describe(std::span<const Attachment> colours, const Attachment& depth) {
    std::string text;
    const auto add = [&](std::string_view point, const Attachment& a) {
        if (a.texture)
            text += fmt::format("{}{} {} {} x {}", text.empty() ? "" : ", ", point, formatInfo(a.texture->desc().format).name,
                                a.texture->width(a.mip), a.texture->height(a.mip));
    };
    for (const Attachment& colour : colours) add("colour", colour);
    add("depth", depth);
    return text;
}

}  // namespace

Framebuffer::Framebuffer(std::span<const Attachment> colours, const Attachment& depth) {
    ASSERT(colours.size() <= kMostColours, "draw into at most 8 colours at once");
    GLuint name = 0;
    glCreateFramebuffers(1, &name);
    name_ = FramebufferName(name);
    std::array<GLenum, kMostColours> outputs{};
    const auto fit = [&](const Attachment& a) {
        width_ = width_ == 0 ? a.texture->width(a.mip) : std::min(width_, a.texture->width(a.mip));
        height_ = height_ == 0 ? a.texture->height(a.mip) : std::min(height_, a.texture->height(a.mip));
    };
    for (size_t k = 0; k < colours.size(); ++k) {
        outputs[k] = GL_NONE;
        if (!colours[k].texture) continue;
        outputs[k] = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(k);
        attach(name, outputs[k], colours[k]);
        fit(colours[k]);
    }
    if (depth.texture) {
        attach(name, GL_DEPTH_ATTACHMENT, depth);
        fit(depth);
    }
    glNamedFramebufferDrawBuffers(name, static_cast<GLsizei>(colours.size()), outputs.data());
    glNamedFramebufferReadBuffer(name, colours.empty() ? GL_NONE : outputs[0]);
    const GLenum status = glCheckNamedFramebufferStatus(name, GL_DRAW_FRAMEBUFFER);
    // The driver lacks memory, or the context is lost; neither is an error of the program.
    if (status == 0 || (status == GL_FRAMEBUFFER_UNSUPPORTED && takeGlError() == GL_OUT_OF_MEMORY)) throw std::bad_alloc();
    ASSERT(status == GL_FRAMEBUFFER_COMPLETE,
           fmt::format("attach textures that may be drawn into together, of the same size; these are: {} (GL status {:#x})",
                       describe(colours, depth), status)
               .c_str());
}

Framebuffer::Framebuffer(const Texture& colour, const Texture* depth) : Framebuffer(std::array{Attachment{&colour}}, Attachment{depth}) {}

void Framebuffer::bind() const {
    glBindFramebuffer(GL_FRAMEBUFFER, name());
    glViewportIndexedf(0, 0, 0, static_cast<float>(width_), static_cast<float>(height_));  // no other viewport is used
}

void Framebuffer::clearColour(const vec4& value, int index) const { glClearNamedFramebufferfv(name(), GL_COLOR, index, &value.x); }

void Framebuffer::clearDepth(float value) const { glClearNamedFramebufferfv(name(), GL_DEPTH, 0, &value); }

void Framebuffer::blitTo(GLuint framebuffer, int width, int height) const {
    if (width <= 0 || height <= 0) return;  // a minimised window
    const GLenum filter = width == width_ && height == height_ ? GL_NEAREST : GL_LINEAR;
    glBlitNamedFramebuffer(name(), framebuffer, 0, 0, width_, height_, 0, 0, width, height, GL_COLOR_BUFFER_BIT, filter);
}

}  // namespace rivulet::gpu
