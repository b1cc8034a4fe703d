#include "fluid/flow/flow_layer.h"

#include <rivulet_glad/gl.h>

#include <algorithm>
#include <glm/gtc/packing.hpp>

#include "engine/compute/device_cpu.h"
#include "engine/core/assert.h"

namespace rivulet {

namespace {

constexpr size_t kTexelBytes = 8;

}  // namespace

Result<FlowLayer> FlowLayer::create(int size) {
    Result<gpu::Texture> texture = gpu::Texture::create({.width = size, .height = size, .format = gpu::Format::rgba16f, .mips = 0});
    if (!texture) return texture.error();
    FlowLayer layer;
    layer.texture_ = std::move(*texture);
    layer.texture_.setSampling({.wrap = gpu::Wrap::repeat});
    layer.texture_.clear(vec4(0.0F));
    return layer;
}

void FlowLayer::update(const FlowMaps& maps) {
    ASSERT(maps.size() == texture_.width(), "make the layer as large as the maps");
    if (maps.draws() == seen_) return;
    Device& device = maps.device();
    switch (device.backend()) {
        case Backend::cpu:
            takeTiles(maps, hostPointer<uint32_t>(maps.texels()), hostPointer<uint32_t>(maps.stamps()));
            break;
        case Backend::gl:
            // Memory of the same GPU: reading which tiles have changed would wait for it.
            glMemoryBarrier(GL_PIXEL_BUFFER_BARRIER_BIT);
            glBindBuffer(GL_PIXEL_UNPACK_BUFFER, static_cast<GLuint>(maps.texels().handle()));
            takeAll(maps, nullptr);
            glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
            break;
        case Backend::cl:
            device.poll();
            if (!sent_->texels.empty()) {
                takeAll(maps, sent_->texels.data());
                sent_->texels.clear();
            }
            if (!sent_->asked) {
                sent_->asked = true;
                device.readLater(maps.texels(), maps.texels().bytes(), [to = std::weak_ptr(sent_)](std::span<const std::byte> bytes) {
                    const std::shared_ptr<Sent> sent = to.lock();
                    if (!sent) return;  // the layer was destroyed
                    sent->asked = false;
                    sent->texels.assign(bytes.begin(), bytes.end());
                });
            }
            break;
    }
    seen_ = maps.draws();
}

void FlowLayer::update(const ThesisPicture& picture, double height) {
    ASSERT(picture.size == texture_.width(), "make the layer as large as the picture");
    constexpr float kWet = 8.0F;  // a height of 1 / kWet and more has wetness 1
    const auto edge = static_cast<size_t>(picture.size);
    std::vector<uint64_t> texels(edge * edge, 0);
    for (size_t y = 0; y < edge; ++y)
        for (size_t x = 0; x < edge; ++x) {
            const float h = picture.height[y * edge + x], right = picture.height[y * edge + std::min(x + 1, edge - 1)],
                        above = picture.height[std::min(y + 1, edge - 1) * edge + x];
            if (h == 0 && right == 0 && above == 0) continue;
            // (23)'s differences, in metres.
            const auto slope = static_cast<float>(height * static_cast<double>(edge));
            texels[y * edge + x] = glm::packHalf4x16(
                vec4((right - h) * slope, (above - h) * slope, h * static_cast<float>(height) * 1000.0F, std::min(kWet * h, 1.0F)));
        }
    takeLevel(0, 0, picture.size, 0, picture.size, texels.data());
    glGenerateTextureMipmap(texture_.name());
}

void FlowLayer::takeLevel(int level, int y, int rows, int x, int columns, const void* texels) {
    glTextureSubImage2D(texture_.name(), level, x, y, columns, rows, GL_RGBA, GL_HALF_FLOAT, texels);
}

void FlowLayer::takeAll(const FlowMaps& maps, const void* texels) {
    for (int level = 0; level < maps.mips(); ++level) {
        const size_t at = kTexelBytes * maps.texelsBefore(level);
        takeLevel(level, 0, texture_.height(level), 0, texture_.width(level), static_cast<const std::byte*>(texels) + at);
    }
}

// Each row of tiles from the first changed one to the last: fewer calls than one for each tile.
void FlowLayer::takeTiles(const FlowMaps& maps, const uint32_t* texels, const uint32_t* stamps) {
    const int tiles = maps.size() / 8;
    bool any = false;
    for (int ty = 0; ty < tiles; ++ty) {
        const uint32_t* row = stamps + static_cast<std::ptrdiff_t>(ty) * tiles;
        const auto changed = [this](uint32_t stamp) { return stamp > seen_; };
        const uint32_t* first = std::find_if(row, row + tiles, changed);
        if (first == row + tiles) continue;
        any = true;
        const auto last = std::find_if(std::make_reverse_iterator(row + tiles), std::make_reverse_iterator(first), changed).base();
        for (int level = 0; level < std::min(maps.mips(), 4); ++level) {
            const int edge = 8 >> level, x = static_cast<int>(first - row) * edge, y = ty * edge;
            glPixelStorei(GL_UNPACK_ROW_LENGTH, texture_.width(level));
            const size_t at =
                maps.texelsBefore(level) + static_cast<size_t>(y) * static_cast<size_t>(texture_.width(level)) + static_cast<size_t>(x);
            takeLevel(level, y, edge, x, static_cast<int>(last - first) * edge, texels + 2 * at);
        }
    }
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    for (int level = 4; any && level < maps.mips(); ++level)
        takeLevel(level, 0, texture_.height(level), 0, texture_.width(level), texels + 2 * maps.texelsBefore(level));
}

}  // namespace rivulet
