#include "engine/render/gpu_images.h"

#include <vector>

#include "engine/render/skin_tables.h"

namespace rivulet {

Result<const gpu::Texture*> GpuImages::plain(gpu::Texture& into, const vec4& texel) {
    if (!into) {
        Result<gpu::Texture> made = gpu::Texture::create({.width = 1, .height = 1, .format = gpu::Format::rgba16f});
        if (!made) return made.error();
        into = std::move(*made);
        into.clear(texel);
    }
    return static_cast<const gpu::Texture*>(&into);
}

Result<const gpu::Texture*> GpuImages::get(const std::shared_ptr<const Image>& image, ImageUse use, float step) {
    const auto key = std::pair(image.get(), use);
    if (const auto found = kept_.find(key); found != kept_.end()) return static_cast<const gpu::Texture*>(&found->second.texture);
    Result<gpu::Texture> made = use == ImageUse::heights
                                    ? makeSlopes(*image, step, false)
                                    : gpu::Texture::create({.width = image->width,
                                                            .height = image->height,
                                                            .format = use == ImageUse::colour ? gpu::Format::srgb8 : gpu::Format::rgba8,
                                                            .mips = 0});
    if (!made) return made.error();
    if (use != ImageUse::heights) {
        made->upload(std::as_bytes(std::span(image->rgba)));
        made->generateMips();
        made->setSampling({.mip = use == ImageUse::colour ? gpu::Filter::linear : gpu::Filter::nearest, .wrap = gpu::Wrap::repeat});
    }
    const auto at = kept_.emplace(key, Kept{image, std::move(*made)}).first;
    return static_cast<const gpu::Texture*>(&at->second.texture);
}

Result<MaterialTextures> GpuImages::texturesOf(const Material& material) {
    const SkinLook* skin = material.skin.get();
    if ((skin != nullptr || material.eye != nullptr) && !diffusion_) {
        Result<gpu::Texture> table = makeDiffusionTable();
        if (!table) return table.error();
        diffusion_ = std::move(*table);
    }
    if (skin != nullptr && !pores_) {
        Result<gpu::Texture> pores = makeSlopes(makePores(), kPoreStep, true);
        if (!pores) return pores.error();
        pores_ = std::move(*pores);
    }
    MaterialTextures out;
    const std::shared_ptr<const Image> nothing;
    const struct {
        const gpu::Texture** into;
        const std::shared_ptr<const Image>& image;
        ImageUse use;
        gpu::Texture& standIn;
        vec4 texel;
    } all[] = {{&out.colour, material.colour, ImageUse::colour, white_, vec4(1)},
               {&out.metallicRoughness, material.metallicRoughness, ImageUse::data, white_, vec4(1)},
               {&out.normals, material.normals, ImageUse::data, flat_, vec4(0.5F, 0.5F, 1, 1)},
               {&out.occlusion, material.occlusion, ImageUse::data, white_, vec4(1)},
               {&out.glow, material.glow, ImageUse::colour, white_, vec4(1)},
               {&out.relief, skin != nullptr ? skin->relief : nothing, ImageUse::heights, level_, vec4(0)},
               {&out.regions, skin != nullptr ? skin->regions : nothing, ImageUse::data, none_, vec4(0)},
               {&out.flushes, skin != nullptr ? skin->flushes : nothing, ImageUse::data, none_, vec4(0)}};
    for (const auto& a : all) {
        Result<const gpu::Texture*> texture =
            a.image ? get(a.image, a.use, skin != nullptr ? skin->reliefStep : 0.0F) : plain(a.standIn, a.texel);
        if (!texture) return texture.error();
        *a.into = *texture;
    }
    out.pores = pores_ ? &pores_ : out.relief;
    out.diffusion = diffusion_ ? &diffusion_ : out.relief;
    return out;
}

void GpuImages::keepOnly(const std::set<const Image*>& used) {
    std::erase_if(kept_, [&](const auto& item) { return !used.contains(item.first.first); });
}

std::set<const Image*> imagesOf(const Material& material) {
    std::set<const Image*> all = {material.colour.get(), material.metallicRoughness.get(), material.normals.get(), material.occlusion.get(),
                                  material.glow.get()};
    if (material.skin) all.insert({material.skin->relief.get(), material.skin->regions.get(), material.skin->flushes.get()});
    all.erase(nullptr);
    return all;
}

}  // namespace rivulet
