// A flow's maps as a texture, for a material's layer: rgba16f with mips, kept as FlowMaps draws them, whichever device does.
#pragma once

#include <memory>

#include "engine/gpu/texture.h"
#include "fluid/flow/flow_maps.h"
#include "fluid/flow/thesis_picture.h"

namespace rivulet {

class FlowLayer {
  public:
    // Needs a current OpenGL context, here and in update(). Error (failed): no room for the texture.
    static Result<FlowLayer> create(int size);

    // After each draw() of `maps`, whose size is the layer's. Takes what has changed since the last call; from device cl it comes some
    // frames later.
    void update(const FlowMaps& maps);
    // All of a picture of the layer's size; `height`: m, that its 1 stands for.
    void update(const ThesisPicture& picture, double height);

    // r, g: dh/du, dh/dv (m a unit of u, v); b: height (mm); a: wetness (0 to 1). Wraps round, as UVs do.
    const gpu::Texture& texture() const { return texture_; }

  private:
    void takeTiles(const FlowMaps& maps, const uint32_t* texels, const uint32_t* stamps);
    void takeAll(const FlowMaps& maps, const void* texels);
    void takeLevel(int level, int y, int rows, int x, int columns, const void* texels);

    gpu::Texture texture_;
    uint32_t seen_ = 0;  // draws
    // What a device that cannot share sends, on its way; asked for as often as it has come.
    struct Sent {
        bool asked = false;
        std::vector<std::byte> texels;
    };
    std::shared_ptr<Sent> sent_ = std::make_shared<Sent>();
};

}  // namespace rivulet
