// Texture: 2D, 2D array and cube images, and how they are sampled.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "engine/core/math.h"
#include "engine/core/result.h"
#include "engine/gpu/gl_object.h"

namespace rivulet::gpu {

enum class Format {
    r8,
    rg8,
    rgba8,
    srgb8,  // srgb8 has alpha too: stored sRGB, read and blended linear (with GL_FRAMEBUFFER_SRGB)
    r16f,
    rg16f,
    rgba16f,
    r11g11b10f,
    r32f,
    rg32f,
    rgba32f,
    r32i,
    r32ui,
    depth24,
    depth32f
};
struct FormatInfo {
    const char* name;       // "rgba16f"
    unsigned internal;      // GL_RGBA16F: also glBindImageTexture's format
    unsigned layout, type;  // of upload() and read(): GL_RGBA, GL_FLOAT. 16f formats are read and written as 32-bit floats
    int bytes;              // a texel on the GPU
    int hostBytes;          // a texel in upload() and read()
    bool depth, integer;
};
const FormatInfo& formatInfo(Format format);

enum class TextureShape { flat, array, cube };

struct TextureDesc {
    int width = 1, height = 1;  // texels; 0 (a minimised window) counts as 1
    Format format = Format::rgba8;
    TextureShape shape = TextureShape::flat;
    int layers = 1;  // of an array; a cube has 6 faces: +x -x +y -y +z -z
    int mips = 1;    // 0: all of them
    bool operator==(const TextureDesc&) const = default;
    size_t bytes() const;  // on the GPU, without padding
};
// The description that a texture gets: sizes of at least 1, and the actual `mips` and `layers`.
TextureDesc settled(TextureDesc desc);
// Levels down to 1 x 1.
int fullMipCount(int width, int height);

enum class Filter { nearest, linear };
enum class Wrap { clamp, repeat, mirror, border };  // border: the value `Sampling::border` beyond the edge

struct Sampling {
    Filter min = Filter::linear, mag = Filter::linear, mip = Filter::linear;
    Wrap wrap = Wrap::clamp;
    bool compare = false;  // sampler2DShadow: <=
    float anisotropy = 1;  // limited by the driver's maximum
    vec4 border{0.0F};
};

class Texture {
  public:
    Texture() = default;
    // Contents are undefined. Sampled linear and clamped; nearest for integer formats and depth.
    // Error (failed): larger than the driver allows, or out of memory, with the requested size.
    static Result<Texture> create(const TextureDesc& desc);

    unsigned name() const { return name_.name(); }
    const TextureDesc& desc() const { return desc_; }         // settled
    std::weak_ptr<const void> life() const { return life_; }  // expires when the texture is deleted; names are given again
    int width(int mip = 0) const;
    int height(int mip = 0) const;
    explicit operator bool() const { return static_cast<bool>(name_); }

    // One level of one layer (or face), rows from the bottom up, without padding; hostBytes(mip) bytes in FormatInfo's layout and type.
    void upload(std::span<const std::byte> texels, int mip = 0, int layer = 0);
    void read(std::span<std::byte> texels, int mip = 0, int layer = 0) const;  // waits for the GPU
    size_t hostBytes(int mip = 0) const;                                       // bytes of one level of one layer
    void generateMips();
    void clear(const vec4& value);  // every level and layer; depth takes x; not for integer formats
    void setSampling(const Sampling& sampling);

    void bind(unsigned unit) const;
    // `access`: GL_READ_ONLY, GL_WRITE_ONLY, GL_READ_WRITE. All layers.
    void bindImage(unsigned unit, unsigned access, int mip = 0) const;

  private:
    TextureName name_;
    TextureDesc desc_;
    std::shared_ptr<const char> life_;
};

// A sampler object: while it is bound to a unit, it overrides the texture's own sampling.
class Sampler {
  public:
    Sampler() = default;
    explicit Sampler(const Sampling& sampling, bool mips = true);  // mips: sample levels other than 0
    unsigned name() const { return name_.name(); }
    void bind(unsigned unit) const;

  private:
    SamplerName name_;
};

}  // namespace rivulet::gpu
