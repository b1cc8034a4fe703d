#include "fluid/render/pack_lighting.h"

#include <fmt/format.h>
#include <rivulet_glad/gl.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "engine/gpu/host_state.h"
#include "fluid/render/host_view.h"

namespace rivulet {
namespace {

static_assert(std::size(decltype(FrameParams::hostLights){}) == kMostHostLights + 1);

Status usable(const HostShadow& s) {
    if (s.texture == 0) return ok();
    if (!isFinite(s.projection) || !std::isfinite(s.bias))
        return badInput("shadow: the projection or the bias has a value that is not finite");
    if (glIsTexture(s.texture) == GL_FALSE)
        return badInput(fmt::format("shadow map {} is not a texture of the current context", s.texture));
    GLint width = 0;
    if (gpu::targetOfTexture(s.texture) == GL_TEXTURE_2D) glGetTextureLevelParameteriv(s.texture, 0, GL_TEXTURE_WIDTH, &width);
    if (width == 0)
        return badInput(
            fmt::format("shadow map {} is no GL_TEXTURE_2D with a level 0; of an array, give a layer as a texture view", s.texture));
    const auto is = [&](GLenum what) {
        GLint value = 0;
        glGetTextureParameteriv(s.texture, what, &value);
        return value;
    };
    GLint depths = GL_NONE, reds = GL_NONE;
    glGetTextureLevelParameteriv(s.texture, 0, GL_TEXTURE_DEPTH_TYPE, &depths);
    glGetTextureLevelParameteriv(s.texture, 0, GL_TEXTURE_RED_TYPE, &reds);
    const bool floats = reds != GL_NONE && reds != GL_INT && reds != GL_UNSIGNED_INT;
    if (depths != GL_NONE ? is(GL_DEPTH_STENCIL_TEXTURE_MODE) != GL_DEPTH_COMPONENT : !floats)
        return badInput(
            fmt::format("shadow map {} has no depths that are read as floats: its format is of integers or stencils", s.texture));
    if (is(GL_TEXTURE_SWIZZLE_R) != GL_RED)
        return badInput(
            fmt::format("shadow map {} has another GL_TEXTURE_SWIZZLE_R than GL_RED; give a texture view without it", s.texture));
    if (is(GL_TEXTURE_BASE_LEVEL) != 0)
        return badInput(
            fmt::format("shadow map {} has the GL_TEXTURE_BASE_LEVEL {}; level 0 is read: set 0", s.texture, is(GL_TEXTURE_BASE_LEVEL)));
    return ok();
}

Status usable(const HostFog& f) {
    if (f.kind == HostFog::none) return ok();
    if (!isRadiance(f.colour)) return badInput("fog: the colour is negative or not finite");
    if (f.kind == HostFog::linear && (!std::isfinite(f.start) || !std::isfinite(f.end) || !(f.end > f.start)))
        return badInput(fmt::format("fog: the start is {} and the end {}: linear fog ends beyond its start", f.start, f.end));
    if (f.kind != HostFog::linear && (!std::isfinite(f.density) || !(f.density >= 0)))
        return badInput(fmt::format("fog: the density is {}: give 0 or more", f.density));
    return ok();
}

}  // namespace

Status usable(const HostLighting& l) {
    if (l.lights.size() > kMostHostLights)
        return badInput(fmt::format("lights: there are {}: give {} at most, the brightest", l.lights.size(), kMostHostLights));
    for (size_t k = 0; k < l.lights.size(); ++k) {
        const HostLight& light = l.lights[k];
        if (!rivulet::isFinite(light.towards) || light.towards == vec3(0.0F))
            return badInput(fmt::format("lights[{}]: the direction is 0 or not finite; give a vector towards the light", k));
        if (!isRadiance(light.colour)) return badInput(fmt::format("lights[{}]: the colour is negative or not finite; give radiance", k));
    }
    if (Status shadow = usable(l.shadow); !shadow) return shadow;
    return usable(l.fog);
}

void packLighting(const HostLighting& l, const FrameView& view, FrameParams& to) {
    to.host =
        vec4(static_cast<float>(1 + l.lights.size()), l.shadow.texture != 0 ? 1.0F : 0.0F, l.shadow.bias, l.shadow.reversed ? -1.0F : 1.0F);
    to.hostLights[0] = to.lightDir;
    to.hostColours[0] = to.lightColour;
    for (size_t k = 0; k < l.lights.size(); ++k) {
        to.hostLights[k + 1] = vec4(unitAlong(l.lights[k].towards), 0.0F);
        to.hostColours[k + 1] = vec4(l.lights[k].colour, 0.0F);
    }
    const float unit = view.unitsPerMetre;
    mat4 toMap(0.5F);
    toMap[3] = vec4(0.5F, 0.5F, 0.5F, 1.0F);
    if (l.shadow.zeroToOne) toMap[2].z = 1, toMap[3].z = 0;
    mat4 units(unit);
    units[3].w = 1;
    to.hostShadow = toMap * l.shadow.projection * units;
    to.fog = vec4(static_cast<float>(l.fog.kind), l.fog.density * unit, l.fog.start / unit, l.fog.end / unit);
    to.fogColour = vec4(l.fog.colour, 0.0F);
    to.fogWay = vec4(l.fog.alongView ? 1.0F : 0.0F, l.fog.display ? 1.0F : 0.0F, 0.0F, 0.0F);
}

}  // namespace rivulet
