// GpuImages: images as textures, uploaded once for each kind of use, and the lookup tables of skin.
#pragma once

#include <map>
#include <memory>
#include <set>

#include "engine/gpu/texture.h"
#include "engine/material/material.h"

namespace rivulet {

enum class ImageUse { colour, data, heights };  // sRGB; linear; converted to slopes, see makeSlopes

// The textures of a material's shader; none is null.
struct MaterialTextures {
    const gpu::Texture *colour = nullptr, *metallicRoughness = nullptr, *normals = nullptr;
    const gpu::Texture *occlusion = nullptr, *glow = nullptr;
    const gpu::Texture *relief = nullptr, *regions = nullptr, *flushes = nullptr, *pores = nullptr, *diffusion = nullptr;
};

class GpuImages {
  public:
    // Stays valid until keepOnly(). Error (failed): out of GPU memory.
    Result<MaterialTextures> texturesOf(const Material& material);
    // Frees the textures of all other images.
    void keepOnly(const std::set<const Image*>& used);

  private:
    Result<const gpu::Texture*> get(const std::shared_ptr<const Image>& image, ImageUse use, float step = 0);
    Result<const gpu::Texture*> plain(gpu::Texture& into, const vec4& texel);
    struct Kept {
        std::shared_ptr<const Image> image;  // keeps the image alive, so that its address stays unique
        gpu::Texture texture;
    };
    std::map<std::pair<const Image*, ImageUse>, Kept> kept_;
    gpu::Texture white_, flat_, level_, none_;  // defaults for images that a material does not have
    gpu::Texture pores_, diffusion_;            // created for the first skin
};

// The images that a material uses.
std::set<const Image*> imagesOf(const Material& material);

}  // namespace rivulet
