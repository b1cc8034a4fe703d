// KeptPictures: what was drawn of sleeping particles, and of a surface on which all sleep, kept from frame to frame until the particles,
// the view, the size or the look change.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "engine/gpu/gl_object.h"
#include "engine/gpu/texture.h"

namespace rivulet {

struct KeptPicture {
    // `caustics`: as `surface`, if no particle is awake. `scene`: the depth of the scene, where `thickness` was cut at it. `surface` and
    // `tiles`: after the filter, if no particle is awake.
    enum Part { spheres, thickness, ink, scene, surface, tiles, light, caustics, kParts };
    std::array<gpu::Texture, kParts> textures;
    std::array<bool, kParts> drawn = {};  // set by the pass that draws it
    gpu::QueryName changed;               // whether the scene has, since `thickness` was cut at it
    size_t bytes() const;
};

class KeptPictures {
  public:
    // All that a picture depends on, but for the scene.
    struct Key {
        std::shared_ptr<const void> sleepers;  // of the FluidView
        const void* filter = nullptr;
        std::vector<float> values;
        bool operator==(const Key&) const = default;
    };
    using Wanted = std::pair<KeptPicture::Part, gpu::TextureDesc>;
    // The picture of this key, with a texture for each of `parts`. Null where nothing is to be kept: in the first frame with a key, as
    // the next may have another, and without memory.
    std::shared_ptr<KeptPicture> find(const Key& key, std::span<const Wanted> parts);
    // Before the pictures of a view: frees those that were not used for a while.
    void next();
    void clear() { entries_.clear(); }
    void limit(size_t bytes) { most_ = bytes; }
    size_t bytes() const;

  private:
    struct Entry {
        Key key;
        std::shared_ptr<KeptPicture> picture;
        uint64_t used = 0;
    };
    std::vector<Entry> entries_;
    uint64_t now_ = 0;  // views so far
    size_t most_ = SIZE_MAX;
};

}  // namespace rivulet
