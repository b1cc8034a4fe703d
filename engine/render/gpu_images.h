// GpuImages: pictures as textures, each uploaded once for each way it is read, and the tables that skin is drawn with.
#pragma once

#include <map>
#include <memory>
#include <set>

#include "engine/gpu/texture.h"
#include "engine/material/material.h"

namespace rivulet {

enum class ImageUse { colour, data, heights };  // sRGB; as stored; as slopes, see makeSlopes

// What a material's shader reads; none is null.
struct MaterialTextures {
    const gpu::Texture *colour = nullptr, *metallicRoughness = nullptr, *normals = nullptr;
    const gpu::Texture *occlusion = nullptr, *glow = nullptr;
    const gpu::Texture *relief = nullptr, *regions = nullptr, *pores = nullptr, *diffusion = nullptr;
};

class GpuImages {
  public:
    // Stays valid until forgetBut(). Error (failed): out of GPU memory.
    Result<MaterialTextures> texturesOf(const Material& material);
    // Lets go of images that are none of these.
    void forgetBut(const std::set<const Image*>& used);

  private:
    Result<const gpu::Texture*> get(const std::shared_ptr<const Image>& image, ImageUse use, float step = 0);
    Result<const gpu::Texture*> plain(gpu::Texture& into, const vec4& texel);
    struct Kept {
        std::shared_ptr<const Image> image;  // so that its address stays its own
        gpu::Texture texture;
    };
    std::map<std::pair<const Image*, ImageUse>, Kept> kept_;
    gpu::Texture white_, flat_, level_, none_;  // stand in for what a material has not
    gpu::Texture pores_, diffusion_;            // made when the first skin is seen
};

// The images that a material names.
std::set<const Image*> imagesOf(const Material& material);

}  // namespace rivulet
