// The surface's depth without what is in a volume that stays dry: a smoothed surface reaches beyond its particles, through a thin hull.
#include "shaders/render/frame.glsl"
#include "shaders/common/lang.h"
#include "shaders/fluid/sources/dry_volume.h"
#include "shaders/fluid/sources/in_dry.h"
uniform sampler2D source;  // m
uniform int volumes;
uniform vec4 dry[48];      // of each volume its DryVolume
layout(location = 0) out float depth;
void main() {
    depth = texelFetch(source, ivec2(gl_FragCoord.xy), 0).r;
    if (depth >= kFar) return;
    vec3 at = toWorld(placeAt(gl_FragCoord.xy, depth));
    for (int k = 0; k < volumes; ++k)
        if (inDry(at, DryVolume(dry[3 * k], dry[3 * k + 1], dry[3 * k + 2]))) depth = kFar;
}
