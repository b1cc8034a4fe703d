// The light of a host's scene, which the water drawn into it shares. Plain data.
#pragma once

#include <cstddef>
#include <span>

#include "engine/core/math.h"
#include "engine/material/image.h"

namespace rivulet {

inline bool isRadiance(const vec3& c) { return isFinite(c) && c.x >= 0 && c.y >= 0 && c.z >= 0; }

// A view of an HdrImage, or of a host's own memory in the same layout, which stays the caller's.
struct HdrImageView {
    int width = 0, height = 0;
    std::span<const vec3> texels = {};
    HdrImageView() = default;
    HdrImageView(int w, int h, std::span<const vec3> t) : width(w), height(h), texels(t) {}
    HdrImageView(const HdrImage& image) : HdrImageView(image.width, image.height, image.texels) {}
    bool given() const { return width != 0 || height != 0 || !texels.empty(); }
};

// The surroundings that water reflects, and refracts where the picture ends: one of the two, linear radiance in the target's units.
struct HostSurroundings {
    HdrImageView image = {};
    // GL name of a GL_TEXTURE_2D, equirectangular as an HdrImage, or of a GL_TEXTURE_CUBE_MAP, in a format that is read as floats. Level 0
    // is read at the time of the call; call again when it has changed.
    unsigned texture = 0;
    mat3 turn{1.0F};  // a direction in the world of the simulation, +Y up -> the map's: a rotation, which may mirror
};

// A light besides FrameView's, far away.
struct HostLight {
    vec3 towards{0.0F, 1.0F, 0.0F};  // the light, any length but 0; in the world of the simulation, +Y up
    vec3 colour{0.0F};               // linear radiance, as FrameView::lightColour
};

// Where FrameView's light is shaded: the host's shadow map.
struct HostShadow {
    // GL name of a GL_TEXTURE_2D of depths, or of one red channel of floats, without a swizzle; 0: no shadows. Level 0 is read, and its
    // sampling is not used. Beyond the map all is lit. The layer of an array can be given as a texture view (glTextureView).
    unsigned texture = 0;
    mat4 projection{1.0F};   // the world that FrameView::view transforms -> the map's clip space
    bool zeroToOne = false;  // the map was drawn with GL_ZERO_TO_ONE; else clip depths are -1 to 1
    bool reversed = false;   // what is nearer to the light has the greater depth
    float bias = 0.002F;     // of stored depth, 0 to 1: what is deeper by less is lit
};

// The fog that the host's picture already contains.
struct HostFog {
    // The share of light that passes a distance d: 1; exp(-density d); exp(-(density d)^2); (end - d) / (end - start), within 0 and 1.
    enum Kind { none, exponential, exponentialSquared, linear } kind = none;
    vec3 colour{0.0F};         // linear radiance in the target's units; with `display`, sRGB-encoded
    float density = 0;         // 1 / unit of length of the host
    float start = 0, end = 0;  // units of length of the host
    // d is the depth along the view axis; else the distance from the eye: an orthographic camera has none, and distances are depths.
    bool alongView = false;
    bool display = false;  // the host blends fog with sRGB-encoded values; else with linear ones
};

struct HostLighting {
    std::span<const HostLight> lights = {};  // up to kMostHostLights
    HostShadow shadow = {};
    HostFog fog = {};
};
inline constexpr size_t kMostHostLights = 7;

}  // namespace rivulet
