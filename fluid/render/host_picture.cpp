#include "fluid/render/host_picture.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <vector>

#include "engine/core/readable_bytes.h"
#include "engine/gpu/gl_error.h"

namespace rivulet {
namespace {

constexpr uint64_t kKeepDraws = 24;  // pictures of a size not drawn for this many draws are freed

GLint asked(GLuint framebuffer, GLenum attachment, GLenum what) {
    GLint value = 0;
    glGetNamedFramebufferAttachmentParameteriv(framebuffer, attachment, what, &value);
    return value;
}

// Returns possible formats of a copy of the depth buffer, the likeliest first; a blit needs equal formats. Empty: there is no depth buffer.
std::vector<GLenum> depthFormats(GLuint framebuffer) {
    const GLenum depth = framebuffer == 0 ? GL_DEPTH : GL_DEPTH_ATTACHMENT;
    const GLenum stencil = framebuffer == 0 ? GL_STENCIL : GL_STENCIL_ATTACHMENT;
    const GLint kind = asked(framebuffer, depth, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE);
    if (kind == GL_NONE) return {};
    GLint format = 0;
    if (kind == GL_RENDERBUFFER)
        glGetNamedRenderbufferParameteriv(static_cast<GLuint>(asked(framebuffer, depth, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME)),
                                          GL_RENDERBUFFER_INTERNAL_FORMAT, &format);
    if (kind == GL_TEXTURE)
        glGetTextureLevelParameteriv(static_cast<GLuint>(asked(framebuffer, depth, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_NAME)),
                                     asked(framebuffer, depth, GL_FRAMEBUFFER_ATTACHMENT_TEXTURE_LEVEL), GL_TEXTURE_INTERNAL_FORMAT,
                                     &format);
    std::vector<GLenum> all;
    if (format != 0 && format != GL_DEPTH_COMPONENT && format != GL_DEPTH_STENCIL) all.push_back(static_cast<GLenum>(format));
    const GLint bits = asked(framebuffer, depth, GL_FRAMEBUFFER_ATTACHMENT_DEPTH_SIZE);
    if (bits == 0 && all.empty()) return {};  // a window without depth
    const bool floats = asked(framebuffer, depth, GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE) == GL_FLOAT;
    const bool both = asked(framebuffer, stencil, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) != GL_NONE &&
                      asked(framebuffer, stencil, GL_FRAMEBUFFER_ATTACHMENT_STENCIL_SIZE) > 0;
    const GLenum alone = floats       ? GL_DEPTH_COMPONENT32F
                         : bits == 16 ? GL_DEPTH_COMPONENT16
                         : bits == 24 ? GL_DEPTH_COMPONENT24
                                      : GL_DEPTH_COMPONENT32;
    const GLenum together = floats ? GL_DEPTH32F_STENCIL8 : GL_DEPTH24_STENCIL8;
    for (const GLenum one : {both ? together : alone, both ? alone : together}) all.push_back(one);
    return all;
}

// Error (badInput): water cannot be drawn into the target.
Status usable(const HostTarget& t) {
    if (t.width <= 0 || t.height <= 0)
        return badInput(fmt::format("the target is {} x {} pixels; skip the frame while a window is closed", t.width, t.height));
    constexpr int kFurthest = 1 << 20;  // pixels: no framebuffer is as large
    if (t.x < -kFurthest || t.y < -kFurthest || t.x > kFurthest || t.y > kFurthest || t.width > kFurthest || t.height > kFurthest)
        return badInput(fmt::format("the target of {} x {} pixels at {}, {} is outside any framebuffer", t.width, t.height, t.x, t.y));
    if (t.framebuffer != 0 && glIsFramebuffer(t.framebuffer) == GL_FALSE)
        return badInput(fmt::format("{} is not a framebuffer of the current context", t.framebuffer));
    const GLenum status = glCheckNamedFramebufferStatus(t.framebuffer, GL_DRAW_FRAMEBUFFER);
    if (status == GL_FRAMEBUFFER_UNDEFINED) return badInput("the current context has no window; name a framebuffer");
    if (status != GL_FRAMEBUFFER_COMPLETE)
        return badInput(fmt::format("framebuffer {} is not complete (glCheckNamedFramebufferStatus gives {:#x})", t.framebuffer, status));
    return ok();
}

}  // namespace

Status HostPicture::nothingUnderWay() {
    GLboolean active = GL_FALSE, paused = GL_FALSE;
    glGetBooleanv(GL_TRANSFORM_FEEDBACK_ACTIVE, &active);
    if (active == GL_TRUE) glGetBooleanv(GL_TRANSFORM_FEEDBACK_PAUSED, &paused);
    if (active == GL_TRUE && paused == GL_FALSE) return badInput("transform feedback is active; pause or end it before drawing water");
    for (const GLenum counts : {GL_SAMPLES_PASSED, GL_ANY_SAMPLES_PASSED, GL_ANY_SAMPLES_PASSED_CONSERVATIVE, GL_PRIMITIVES_GENERATED,
                                GL_TRANSFORM_FEEDBACK_PRIMITIVES_WRITTEN}) {
        GLint query = 0;
        glGetQueryiv(counts, GL_CURRENT_QUERY, &query);
        if (query != 0)
            return badInput("a query counts samples or primitives; end it before drawing water, or it would count Rivulet's as well");
    }
    return ok();
}

Result<HostPicture> HostPicture::create(const ShaderFiles& files) {
    HostPicture p;
    const std::string full = "shaders/render/fullscreen.vert", folder = "shaders/screen_space/";
    std::pair<gpu::Program*, Result<gpu::Program>> made[] = {
        {&p.in_, gpu::Program::create(files, {full, folder + "host_in.frag"})},
        {&p.out_, gpu::Program::create(files, {full, folder + "host_out.frag"})},
        {&p.outOpaque_, gpu::Program::create(files, {full, folder + "host_out.frag"}, {{"OPAQUE", "1"}})},
    };
    for (auto& [program, result] : made) {
        if (!result) return result.error();
        *program = std::move(*result);
    }
    p.none_ = gpu::VertexArray::create();
    glGetIntegerv(GL_MAX_DRAW_BUFFERS, &p.mostOutputs_);
    return p;
}

size_t HostPicture::Pictures::bytes() const {
    // And a copy of the host's depth in its own format.
    return raw.desc().bytes() + colour.desc().bytes() + depth.desc().bytes() * (1 + std::max<size_t>(rawDepths.size(), 1));
}

Status HostPicture::fit(int width, int height) {
    ++draws_;
    std::erase_if(all_, [&](const auto& p) { return p->used + kKeepDraws < draws_; });
    const auto at =
        std::find_if(all_.begin(), all_.end(), [&](const auto& p) { return p->colour.width() == width && p->colour.height() == height; });
    now_ = at != all_.end() ? at->get() : nullptr;
    if (now_ != nullptr) {
        now_->used = draws_;
        return ok();
    }
    auto made = std::make_unique<Pictures>();
    const std::pair<gpu::Texture*, gpu::Format> wanted[] = {
        {&made->raw, gpu::Format::rgba16f}, {&made->colour, gpu::Format::rgba16f}, {&made->depth, gpu::Format::depth32f}};
    size_t needed = gpu::TextureDesc{.width = width, .height = height, .format = gpu::Format::depth32f}.bytes();  // as bytes()
    for (const auto& [texture, format] : wanted) needed += gpu::TextureDesc{.width = width, .height = height, .format = format}.bytes();
    if (bytes() + needed > most_) all_.clear();
    if (needed > most_)
        return failed(fmt::format("a picture of {} x {} pixels needs {}, and {} are allowed for pictures; allow more, or draw fewer pixels",
                                  width, height, readableBytes(needed), readableBytes(most_)));
    for (const auto& [texture, format] : wanted) {
        Result<gpu::Texture> texels = gpu::Texture::create({.width = width, .height = height, .format = format});
        if (!texels) return texels.error();
        *texture = std::move(*texels);
    }
    made->raw.setSampling({.min = gpu::Filter::nearest, .mag = gpu::Filter::nearest});
    made->rawTarget = gpu::Framebuffer(made->raw, nullptr);
    made->target = gpu::Framebuffer(made->colour, &made->depth);
    made->used = draws_;
    all_.push_back(std::move(made));
    now_ = all_.back().get();
    return ok();
}

Status HostPicture::takeDepth(const HostTarget& t) {
    const std::vector<GLenum> formats = depthFormats(t.framebuffer);
    rawDepth_ = 0;
    std::vector<RawDepth>& kept = now_->rawDepths;
    for (const GLenum format : formats) {
        auto raw = std::find_if(kept.begin(), kept.end(), [&](const RawDepth& r) { return r.format == format; });
        gpu::clearGlErrors();
        if (raw == kept.end()) {
            RawDepth made{.format = format, .texture = {}, .framebuffer = {}};
            GLuint name = 0;
            glCreateTextures(GL_TEXTURE_2D, 1, &name);
            made.texture = gpu::TextureName(name);
            glTextureStorage2D(name, 1, format, now_->raw.width(), now_->raw.height());
            if (gpu::takeGlError() != GL_NO_ERROR) continue;
            glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
            glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
            const bool both = format == GL_DEPTH24_STENCIL8 || format == GL_DEPTH32F_STENCIL8;
            glCreateFramebuffers(1, &name);
            made.framebuffer = gpu::FramebufferName(name);
            glNamedFramebufferTexture(name, both ? GL_DEPTH_STENCIL_ATTACHMENT : GL_DEPTH_ATTACHMENT, made.texture.name(), 0);
            glNamedFramebufferDrawBuffer(name, GL_NONE);
            raw = kept.insert(kept.end(), std::move(made));
        }
        glBlitNamedFramebuffer(t.framebuffer, raw->framebuffer.name(), t.x, t.y, t.x + t.width, t.y + t.height, 0, 0, t.width, t.height,
                               GL_DEPTH_BUFFER_BIT, GL_NEAREST);
        if (gpu::takeGlError() == GL_NO_ERROR) {
            rawDepth_ = raw->texture.name();
            return ok();
        }
        kept.erase(raw);  // not the host's format
    }
    if (!formats.empty())
        return failed(
            fmt::format("the depth of framebuffer {} has a format that cannot be copied; use 24 bits or 32-bit floats", t.framebuffer));
    return ok();
}

Status HostPicture::take(const HostTarget& t, const gpu::HostDepth& depth, const FrameView& host) {
    if (Status can = usable(t); !can) return can;
    Result<HostView> seen = HostView::of(host, depth, t.width, t.height);
    if (!seen) return seen.error();
    if (Status fitting = fit(t.width, t.height); !fitting) return fitting;
    target_ = t;
    hostDepth_ = depth;
    seen_ = *seen;

    // Colour: the content of the first draw buffer.
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, t.framebuffer);
    GLint draws = GL_NONE, reads = GL_NONE;
    glGetIntegerv(GL_DRAW_BUFFER0, &draws);
    if (draws == GL_NONE)
        return badInput(fmt::format("framebuffer {} has no colour output: its first draw buffer is GL_NONE", t.framebuffer));
    const auto attachment = static_cast<GLenum>(draws == GL_BACK ? GL_BACK_LEFT : draws == GL_FRONT ? GL_FRONT_LEFT : draws);
    if (asked(t.framebuffer, attachment, GL_FRAMEBUFFER_ATTACHMENT_OBJECT_TYPE) == GL_NONE)
        return badInput(fmt::format("framebuffer {} has no colour attachment at its first draw buffer", t.framebuffer));
    const GLint kind = asked(t.framebuffer, attachment, GL_FRAMEBUFFER_ATTACHMENT_COMPONENT_TYPE);
    if (kind == GL_INT || kind == GL_UNSIGNED_INT)
        return badInput(fmt::format("framebuffer {} has an integer format; use a normalised or float format", t.framebuffer));
    linear_ = t.colours == HostTarget::linear || (t.colours == HostTarget::automatic && kind == GL_FLOAT);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, t.framebuffer);
    glGetIntegerv(GL_READ_BUFFER, &reads);
    if (reads != draws) glNamedFramebufferReadBuffer(t.framebuffer, static_cast<GLenum>(draws));
    glBlitNamedFramebuffer(t.framebuffer, now_->rawTarget.name(), t.x, t.y, t.x + t.width, t.y + t.height, 0, 0, t.width, t.height,
                           GL_COLOR_BUFFER_BIT, GL_NEAREST);
    if (reads != draws) glNamedFramebufferReadBuffer(t.framebuffer, static_cast<GLenum>(reads));
    if (Status taken = takeDepth(t); !taken) return taken;

    now_->target.bind();
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_ALWAYS);
    in_.use();
    in_.texture("hostColour", 0, now_->raw);
    in_.set("hostDepth", 1);
    glBindTextureUnit(1, rawDepth_ != 0 ? rawDepth_ : now_->raw.name());
    in_.set("depthThere", rawDepth_ != 0 ? 1 : 0);
    setUniforms(in_);
    in_.set("planes", planes());
    none_.bind();
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthFunc(GL_LESS);
    glDisable(GL_DEPTH_TEST);
    return ok();
}

void HostPicture::setUniforms(gpu::Program& p) const {
    p.set("isLinear", linear_ ? 1 : 0);
    p.set("depthRow", seen_.depthRow);
    p.set("hostParallel", seen_.view.parallel() ? 1 : 0);
    p.set("hostRange", vec2(hostDepth_.near, hostDepth_.far));
    p.set("zeroToOne", hostDepth_.zeroToOne ? 1 : 0);
    const bool x = seen_.flipX, y = seen_.flipY;
    p.set("mirror", vec4(x ? target_.width - 1 : 0, y ? target_.height - 1 : 0, x ? -1 : 1, y ? -1 : 1));
}

size_t HostPicture::bytes() const {
    size_t sum = 0;
    for (const auto& p : all_) sum += p->bytes();
    return sum;
}

// The shader writes the first output alone; others of the host's would receive undefined values.
void HostPicture::limitOutputs() {
    masked_.clear();
    for (GLint k = 1; k < mostOutputs_; ++k) {
        GLint to = GL_NONE;
        glGetIntegerv(GL_DRAW_BUFFER0 + static_cast<GLenum>(k), &to);
        if (to == GL_NONE) continue;
        Output output{.index = static_cast<GLuint>(k), .mask = {}};
        glGetBooleani_v(GL_COLOR_WRITEMASK, output.index, output.mask.data());
        glColorMaski(output.index, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        masked_.push_back(output);
    }
}

void HostPicture::freeOutputs() {
    for (const Output& output : masked_) glColorMaski(output.index, output.mask[0], output.mask[1], output.mask[2], output.mask[3]);
}

void HostPicture::give(const gpu::Texture& picture, const gpu::Texture* fluidDepth) {
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target_.framebuffer);
    glViewportIndexedf(0, static_cast<float>(target_.x), static_cast<float>(target_.y), static_cast<float>(target_.width),
                       static_cast<float>(target_.height));
    limitOutputs();
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_ALWAYS);
    gpu::Program& p = fluidDepth != nullptr ? out_ : outOpaque_;
    p.use();
    p.texture("picture", 0, picture);
    p.texture("scene", 1, now_->colour);
    p.texture("hostColour", 2, now_->raw);
    p.texture("depths", 3, fluidDepth != nullptr ? *fluidDepth : now_->depth);
    p.set("hostDepth", 4);
    glBindTextureUnit(4, rawDepth_ != 0 ? rawDepth_ : now_->raw.name());
    setUniforms(p);
    p.set("origin", ivec2(target_.x, target_.y));
    if (fluidDepth == nullptr) p.set("planes", planes());
    none_.bind();
    glDrawArrays(GL_TRIANGLES, 0, 3);
    freeOutputs();
    glDepthFunc(GL_LESS);
    glDisable(GL_DEPTH_TEST);
}

}  // namespace rivulet
