#include "fluid/render/host_surroundings.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "engine/core/readable_bytes.h"
#include "engine/gpu/framebuffer.h"
#include "engine/gpu/host_state.h"

namespace rivulet {
namespace {

constexpr int kNarrowest = 256, kWidest = 1024;  // texels, as prefiltered()'s
constexpr int kMostTaps = 16;                    // along one side of a texel
constexpr int kMatteHeight = 32;                 // texels of the level that matte light is summed over

bool turns(const mat3& m) {
    const mat3 square = glm::transpose(m) * m;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            if (!(std::abs(square[column][row] - (column == row ? 1.0F : 0.0F)) < 1.0e-3F)) return false;
    return true;
}

// A texture of a host: what it is, and the texels around its equator.
struct Source {
    gpu::Texture own = {};  // of an image
    unsigned name = 0;
    GLenum target = GL_TEXTURE_2D;
    int around = 0;
};

Status usable(const HdrImageView& image) {
    const auto count = static_cast<size_t>(std::max(image.width, 0)) * static_cast<size_t>(std::max(image.height, 0));
    if (count == 0 || image.texels.size() != count)
        return badInput(fmt::format("the image of the surroundings has {} texels, but is {} x {}; give width times height",
                                    image.texels.size(), image.width, image.height));
    return ok();
}

gpu::TextureDesc descOf(const HdrImageView& image) {
    return {.width = image.width, .height = image.height, .format = gpu::Format::rgba32f};
}

Status upload(const HdrImageView& image, Source& to) {
    const auto wrong = std::find_if_not(image.texels.begin(), image.texels.end(), isRadiance);
    if (wrong != image.texels.end())
        return badInput(fmt::format("texel {} of the surroundings is negative or not finite; give radiance", wrong - image.texels.begin()));
    Result<gpu::Texture> made = gpu::Texture::create(descOf(image));
    if (!made) return made.error();
    to.own = std::move(*made);
    glTextureSubImage2D(to.own.name(), 0, 0, 0, image.width, image.height, GL_RGB, GL_FLOAT, image.texels.data());
    to.name = to.own.name();
    return ok();
}

// Whether the six faces have a level 0 of one size and format.
bool isWhole(unsigned cube) {
    const gpu::BoundUnit unit(0, GL_TEXTURE_CUBE_MAP);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_CUBE_MAP, cube);
    const auto facts = [](GLenum face) {
        std::array<GLint, 3> all{};
        glGetTexLevelParameteriv(face, 0, GL_TEXTURE_WIDTH, &all[0]);
        glGetTexLevelParameteriv(face, 0, GL_TEXTURE_HEIGHT, &all[1]);
        glGetTexLevelParameteriv(face, 0, GL_TEXTURE_INTERNAL_FORMAT, &all[2]);
        return all;
    };
    const std::array<GLint, 3> first = facts(GL_TEXTURE_CUBE_MAP_POSITIVE_X);
    bool same = first[0] > 0 && first[0] == first[1];
    for (GLenum face = 1; face < 6; ++face) same = same && facts(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face) == first;
    return same;
}

Status find(unsigned texture, Source& to) {
    if (glIsTexture(texture) == GL_FALSE) return badInput(fmt::format("{} is not a texture of the current context", texture));
    const unsigned target = gpu::targetOfTexture(texture);
    if (target == 0)
        return badInput(
            fmt::format("texture {} of the surroundings has another target; use GL_TEXTURE_2D or GL_TEXTURE_CUBE_MAP", texture));
    GLint width = 0, kind = 0, base = 0;
    glGetTextureLevelParameteriv(texture, 0, GL_TEXTURE_WIDTH, &width);
    glGetTextureLevelParameteriv(texture, 0, GL_TEXTURE_RED_TYPE, &kind);
    if (width == 0) return badInput(fmt::format("texture {} of the surroundings has no level 0", texture));
    glGetTextureParameteriv(texture, GL_TEXTURE_BASE_LEVEL, &base);
    if (base != 0)
        return badInput(
            fmt::format("texture {} of the surroundings has the GL_TEXTURE_BASE_LEVEL {}; level 0 is read: set 0", texture, base));
    if (target == GL_TEXTURE_CUBE_MAP && !isWhole(texture))
        return badInput(
            fmt::format("cube map {} of the surroundings is not complete; give six square faces of one size and format", texture));
    if (kind == GL_INT || kind == GL_UNSIGNED_INT || kind == GL_NONE)
        return badInput(fmt::format("texture {} of the surroundings has no colours that are read as floats", texture));
    to.name = texture;
    to.target = target;
    to.around = target == GL_TEXTURE_CUBE_MAP ? 4 * width : width;
    return ok();
}

}  // namespace

Result<SurroundingsMap> SurroundingsMap::create(const ShaderFiles& files) {
    SurroundingsMap s;
    const std::pair<gpu::Program*, std::vector<Define>> wanted[] = {
        {&s.flat_, {}}, {&s.cube_, {{"CUBE", "1"}}}, {&s.blurred_, {{"BLURRED", "1"}}}, {&s.matteOf_, {{"MATTE", "1"}}}};
    for (const auto& [program, defines] : wanted) {
        Result<gpu::Program> made =
            gpu::Program::create(files, {"shaders/render/fullscreen.vert", "shaders/render/surroundings.frag"}, defines);
        if (!made) return made.error();
        *program = std::move(*made);
    }
    s.smooth_ = gpu::Sampler({.wrap = gpu::Wrap::repeat}, false);
    s.none_ = gpu::VertexArray::create();
    Result<gpu::Texture> row = gpu::Texture::create({.width = 9, .height = 1, .format = gpu::Format::rgba32f});
    if (!row) return row.error();
    s.harmonics_ = std::move(*row);
    Result<gpu::Buffer> matte = gpu::Buffer::create(9 * sizeof(vec4));
    if (!matte) return matte.error();
    s.matte_ = std::move(*matte);
    return s;
}

void SurroundingsMap::draw(gpu::Program& program, const gpu::Texture& into, int mip, unsigned target, unsigned texture, int level, int taps,
                           const mat3& turn) {
    const gpu::BoundUnit unit(0, target);
    const gpu::Attachment colour{.texture = &into, .mip = mip};
    const gpu::Framebuffer framebuffer(std::span(&colour, 1), {});
    framebuffer.bind();
    program.use();
    glBindTextureUnit(0, texture);
    if (texture != map_.name()) smooth_.bind(0);  // not the sampling of the host
    program.set("source", 0);
    program.set("toSource", turn);
    program.set("size", ivec2(into.width(mip), into.height(mip)));
    program.set("taps", taps);
    program.set("level", static_cast<float>(level));
    none_.bind();
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

Status SurroundingsMap::take(const HostSurroundings& from, size_t mostBytes) {
    if (from.image.given() == (from.texture != 0)) return badInput("the surroundings need an image or a texture: give one of the two");
    if (!turns(from.turn)) return badInput("surroundings: the turn is no rotation; its columns must be perpendicular and of length 1");
    Source source{.around = from.image.width};
    if (Status can = from.image.given() ? usable(from.image) : find(from.texture, source); !can) return can;
    int width = kNarrowest;
    while (2 * width <= std::min(source.around, kWidest)) width *= 2;
    const gpu::TextureDesc desc{.width = width, .height = width / 2, .format = gpu::Format::rgba16f, .mips = 0};
    const bool other = !map_ || map_.width() != width;
    const size_t needed = (from.image.given() ? descOf(from.image).bytes() : 0) + (other ? gpu::settled(desc).bytes() : 0);
    if (needed > mostBytes)
        return failed(fmt::format("surroundings need {}, and {} are allowed for pictures; allow more, or give a smaller image",
                                  readableBytes(needed), readableBytes(mostBytes)));
    if (from.image.given())
        if (Status copied = upload(from.image, source); !copied) return copied;
    if (other) {
        Result<gpu::Texture> made = gpu::Texture::create(desc);
        if (!made) return made.error();
        map_ = std::move(*made);
        map_.setSampling({.wrap = gpu::Wrap::repeat});
    }
    const int taps = std::clamp((source.around + width - 1) / width, 1, kMostTaps);
    draw(source.target == GL_TEXTURE_CUBE_MAP ? cube_ : flat_, map_, 0, source.target, source.name, 0, taps, from.turn);
    int matteLevel = 0;
    const int last = map_.desc().mips - 1;
    for (int mip = 1; mip <= last; ++mip) {
        // One level is read while the next is drawn.
        glTextureParameteri(map_.name(), GL_TEXTURE_BASE_LEVEL, mip - 1);
        glTextureParameteri(map_.name(), GL_TEXTURE_MAX_LEVEL, mip - 1);
        draw(blurred_, map_, mip, GL_TEXTURE_2D, map_.name(), 0, 1, mat3(1.0F));
        if (map_.height(mip) == kMatteHeight) matteLevel = mip;
    }
    glTextureParameteri(map_.name(), GL_TEXTURE_BASE_LEVEL, 0);
    glTextureParameteri(map_.name(), GL_TEXTURE_MAX_LEVEL, last);
    draw(matteOf_, harmonics_, 0, GL_TEXTURE_2D, map_.name(), matteLevel, kMatteHeight, mat3(1.0F));
    glBindBuffer(GL_PIXEL_PACK_BUFFER, matte_.name());  // stays on the GPU
    glGetTextureImage(harmonics_.name(), 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(matte_.bytes()), nullptr);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    return ok();
}

}  // namespace rivulet
