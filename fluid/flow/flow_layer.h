// A flow's maps as a texture, for a material's layer: rgba16f with mips, updated from FlowMaps of any device.
#pragma once

#include <memory>

#include "engine/gpu/texture.h"
#include "fluid/flow/flow_maps.h"
#include "fluid/flow/thesis_picture.h"

namespace rivulet {

class FlowLayer {
  public:
    // Needs a current OpenGL context, here and in update(). Error (failed): no memory for the texture.
    static Result<FlowLayer> create(int size);

    // After each draw() of `maps`, whose size is the layer's. Copies the tiles that changed since the last call; from device cl they
    // arrive some frames later.
    void update(const FlowMaps& maps);
    // A whole picture of the layer's size; `height`: m, of the picture's value 1.
    void update(const ThesisPicture& picture, double height);

    // r, g: dh/du, dh/dv (m a unit of u, v); b: height (mm); a: wetness (0 to 1). Repeats beyond 0 to 1.
    const gpu::Texture& texture() const { return texture_; }

  private:
    void takeTiles(const FlowMaps& maps, const uint32_t* texels, const uint32_t* stamps);
    void takeAll(const FlowMaps& maps, const void* texels);
    void takeLevel(int level, int y, int rows, int x, int columns, const void* texels);

    gpu::Texture texture_;
    uint32_t seen_ = 0;  // draws
    // Texels on their way from a device that shares no memory with OpenGL; one request at a time.
    struct Sent {
        bool asked = false;
        std::vector<std::byte> texels;
    };
    std::shared_ptr<Sent> sent_ = std::make_shared<Sent>();
};

}  // namespace rivulet
