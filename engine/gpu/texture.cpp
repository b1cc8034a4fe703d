#include "engine/gpu/texture.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <cstring>
#include <string_view>

#include "engine/core/assert.h"
#include "engine/gpu/gl_error.h"

namespace rivulet::gpu {
namespace {

constexpr FormatInfo kFormats[] = {
    {"r8", GL_R8, GL_RED, GL_UNSIGNED_BYTE, 1, 1, false, false},
    {"rg8", GL_RG8, GL_RG, GL_UNSIGNED_BYTE, 2, 2, false, false},
    {"rgba8", GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4, 4, false, false},
    {"srgb8", GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE, 4, 4, false, false},
    {"r16f", GL_R16F, GL_RED, GL_FLOAT, 2, 4, false, false},
    {"rg16f", GL_RG16F, GL_RG, GL_FLOAT, 4, 8, false, false},
    {"rgba16f", GL_RGBA16F, GL_RGBA, GL_FLOAT, 8, 16, false, false},
    {"r11g11b10f", GL_R11F_G11F_B10F, GL_RGB, GL_FLOAT, 4, 12, false, false},
    {"r32f", GL_R32F, GL_RED, GL_FLOAT, 4, 4, false, false},
    {"rg32f", GL_RG32F, GL_RG, GL_FLOAT, 8, 8, false, false},
    {"rgba32f", GL_RGBA32F, GL_RGBA, GL_FLOAT, 16, 16, false, false},
    {"r32i", GL_R32I, GL_RED_INTEGER, GL_INT, 4, 4, false, true},
    {"r32ui", GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4, 4, false, true},
    {"depth24", GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT, GL_FLOAT, 4, 4, true, false},
    {"depth32f", GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 4, 4, true, false},
};
static_assert(std::size(kFormats) == static_cast<size_t>(Format::depth32f) + 1, "a row for every Format, in order");

GLenum targetOf(TextureShape shape) {
    switch (shape) {
        case TextureShape::flat:
            return GL_TEXTURE_2D;
        case TextureShape::array:
            return GL_TEXTURE_2D_ARRAY;
        case TextureShape::cube:
            return GL_TEXTURE_CUBE_MAP;
    }
    ASSERT(false, "pass a valid TextureShape");
}

int layersOf(const TextureDesc& desc) {
    switch (desc.shape) {
        case TextureShape::flat:
            return 1;
        case TextureShape::array:
            return desc.layers;
        case TextureShape::cube:
            return 6;
    }
    ASSERT(false, "pass a valid TextureShape");
}

GLint limit(GLenum which) {
    GLint value = 0;
    glGetIntegerv(which, &value);
    return value;
}

// EXT_texture_filter_anisotropic: supported everywhere, but core only since OpenGL 4.6, so that the loader has no names for it.
constexpr GLenum kTextureMaxAnisotropy = 0x84FE, kMaxTextureMaxAnisotropy = 0x84FF;

float allowedAnisotropy(float wanted) {
    if (wanted <= 1) return 1;
    const GLint extensions = limit(GL_NUM_EXTENSIONS);
    for (GLint k = 0; k < extensions; ++k) {
        const auto* name = reinterpret_cast<const char*>(glGetStringi(GL_EXTENSIONS, static_cast<GLuint>(k)));
        if (name && std::string_view(name) == "GL_EXT_texture_filter_anisotropic") {
            float most = 1;
            glGetFloatv(kMaxTextureMaxAnisotropy, &most);
            return std::min(wanted, most);
        }
    }
    return 1;
}

GLint wrapOf(Wrap wrap) {
    switch (wrap) {
        case Wrap::clamp:
            return GL_CLAMP_TO_EDGE;
        case Wrap::repeat:
            return GL_REPEAT;
        case Wrap::mirror:
            return GL_MIRRORED_REPEAT;
        case Wrap::border:
            return GL_CLAMP_TO_BORDER;
    }
    ASSERT(false, "pass a valid Wrap");
}

// Textures and samplers take the same parameters through different functions.
void applySampling(GLuint name, const Sampling& s, bool mips, void (*setInt)(GLuint, GLenum, GLint),
                   void (*setFloats)(GLuint, GLenum, const GLfloat*)) {
    const bool linear = s.min == Filter::linear;
    GLint min = linear ? GL_LINEAR : GL_NEAREST;
    if (mips && s.mip == Filter::linear) min = linear ? GL_LINEAR_MIPMAP_LINEAR : GL_NEAREST_MIPMAP_LINEAR;
    if (mips && s.mip == Filter::nearest) min = linear ? GL_LINEAR_MIPMAP_NEAREST : GL_NEAREST_MIPMAP_NEAREST;
    setInt(name, GL_TEXTURE_MIN_FILTER, min);
    setInt(name, GL_TEXTURE_MAG_FILTER, s.mag == Filter::linear ? GL_LINEAR : GL_NEAREST);
    for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) setInt(name, axis, wrapOf(s.wrap));
    setInt(name, GL_TEXTURE_COMPARE_MODE, s.compare ? GL_COMPARE_REF_TO_TEXTURE : GL_NONE);
    setInt(name, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    if (s.wrap == Wrap::border) setFloats(name, GL_TEXTURE_BORDER_COLOR, &s.border.x);
    if (const float most = allowedAnisotropy(s.anisotropy); most > 1) setFloats(name, kTextureMaxAnisotropy, &most);
}

}  // namespace

const FormatInfo& formatInfo(Format format) { return kFormats[static_cast<size_t>(format)]; }

int fullMipCount(int width, int height) {
    int mips = 1;
    for (int edge = std::max(width, height); edge > 1; edge /= 2) ++mips;
    return mips;
}

TextureDesc settled(TextureDesc desc) {
    desc.width = std::max(desc.width, 1);
    desc.height = std::max(desc.height, 1);
    desc.layers = layersOf(desc);
    const int full = fullMipCount(desc.width, desc.height);
    desc.mips = desc.mips <= 0 ? full : std::min(desc.mips, full);
    return desc;
}

size_t TextureDesc::bytes() const {
    const TextureDesc desc = settled(*this);
    size_t texels = 0;
    for (int mip = 0; mip < desc.mips; ++mip)
        texels += static_cast<size_t>(std::max(desc.width >> mip, 1)) * static_cast<size_t>(std::max(desc.height >> mip, 1));
    return texels * static_cast<size_t>(desc.layers) * static_cast<size_t>(formatInfo(format).bytes);
}

Result<Texture> Texture::create(const TextureDesc& asked) {
    Texture texture;
    const TextureDesc desc = texture.desc_ = settled(asked);
    const FormatInfo& format = formatInfo(desc.format);
    const std::string what = fmt::format("a {} texture of {} x {}{}", format.name, desc.width, desc.height,
                                         desc.shape == TextureShape::array ? fmt::format(" x {}", desc.layers) : std::string());
    const GLint most = limit(desc.shape == TextureShape::cube ? GL_MAX_CUBE_MAP_TEXTURE_SIZE : GL_MAX_TEXTURE_SIZE);
    if (desc.width > most || desc.height > most)
        return failed(
            fmt::format("this GPU allows textures of up to {0} x {0} texels, but {1} is needed; use a smaller image", most, what));
    if (desc.layers > limit(GL_MAX_ARRAY_TEXTURE_LAYERS))
        return failed(
            fmt::format("this GPU allows {} layers, but {} is needed; use fewer layers", limit(GL_MAX_ARRAY_TEXTURE_LAYERS), what));
    ASSERT(desc.shape != TextureShape::cube || desc.width == desc.height, "give a cube square faces");
    ASSERT(desc.layers > 0, "give an array at least one layer");

    clearGlErrors();
    GLuint name = 0;
    glCreateTextures(targetOf(desc.shape), 1, &name);
    texture.name_ = TextureName(name);
    texture.life_ = std::make_shared<const char>();
    if (desc.shape == TextureShape::array)
        glTextureStorage3D(name, desc.mips, format.internal, desc.width, desc.height, desc.layers);
    else
        glTextureStorage2D(name, desc.mips, format.internal, desc.width, desc.height);
    if (const GLenum error = takeGlError(); error != GL_NO_ERROR)
        return noMemory(fmt::format("the GPU is out of memory: cannot allocate {} ({:.1f} MiB; {}); use a smaller image", what,
                                    static_cast<double>(desc.bytes()) / 1048576.0, glErrorName(error)));
    const Filter filter = format.depth || format.integer ? Filter::nearest : Filter::linear;
    texture.setSampling({.min = filter, .mag = filter, .mip = filter});
    return texture;
}

int Texture::width(int mip) const { return std::max(desc_.width >> mip, 1); }
int Texture::height(int mip) const { return std::max(desc_.height >> mip, 1); }

size_t Texture::hostBytes(int mip) const {
    return static_cast<size_t>(width(mip)) * static_cast<size_t>(height(mip)) * static_cast<size_t>(formatInfo(desc_.format).hostBytes);
}

void Texture::upload(std::span<const std::byte> texels, int mip, int layer) {
    ASSERT(mip >= 0 && mip < desc_.mips && layer >= 0 && layer < desc_.layers, "upload to a level and layer that the texture has");
    ASSERT(texels.size() == hostBytes(mip), "pass hostBytes(mip) bytes");
    const FormatInfo& format = formatInfo(desc_.format);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    if (desc_.shape == TextureShape::flat)
        glTextureSubImage2D(name(), mip, 0, 0, width(mip), height(mip), format.layout, format.type, texels.data());
    else
        glTextureSubImage3D(name(), mip, 0, 0, layer, width(mip), height(mip), 1, format.layout, format.type, texels.data());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
}

void Texture::read(std::span<std::byte> texels, int mip, int layer) const {
    ASSERT(mip >= 0 && mip < desc_.mips && layer >= 0 && layer < desc_.layers, "read from a level and layer that the texture has");
    ASSERT(texels.size() == hostBytes(mip), "pass a span of hostBytes(mip) bytes");
    const FormatInfo& format = formatInfo(desc_.format);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glGetTextureSubImage(name(), mip, 0, 0, layer, width(mip), height(mip), 1, format.layout, format.type,
                         static_cast<GLsizei>(texels.size()), texels.data());
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
}

void Texture::clear(const vec4& value) {
    const FormatInfo& format = formatInfo(desc_.format);
    ASSERT(!format.integer, "clear integer textures with glClearTexImage and a value of their own type");
    const GLenum layout = format.depth ? GL_DEPTH_COMPONENT : GL_RGBA;
    for (int mip = 0; mip < desc_.mips; ++mip) glClearTexImage(name(), mip, layout, GL_FLOAT, &value.x);
}

void Texture::setSampling(const Sampling& sampling) {
    applySampling(
        name(), sampling, desc_.mips > 1, [](GLuint t, GLenum key, GLint v) { glTextureParameteri(t, key, v); },
        [](GLuint t, GLenum key, const GLfloat* v) { glTextureParameterfv(t, key, v); });
}

void Texture::generateMips() { glGenerateTextureMipmap(name()); }

void Texture::bind(GLuint unit) const { glBindTextureUnit(unit, name()); }

void Texture::bindImage(GLuint unit, GLenum access, int mip) const {
    const GLboolean layered = desc_.shape == TextureShape::flat ? GL_FALSE : GL_TRUE;
    glBindImageTexture(unit, name(), mip, layered, 0, access, formatInfo(desc_.format).internal);
}

Sampler::Sampler(const Sampling& sampling, bool mips) {
    GLuint name = 0;
    glCreateSamplers(1, &name);
    name_ = SamplerName(name);
    applySampling(
        name, sampling, mips, [](GLuint s, GLenum key, GLint v) { glSamplerParameteri(s, key, v); },
        [](GLuint s, GLenum key, const GLfloat* v) { glSamplerParameterfv(s, key, v); });
}

void Sampler::bind(GLuint unit) const { glBindSampler(unit, name()); }

}  // namespace rivulet::gpu
