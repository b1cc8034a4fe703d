// The surface's depth without what is in a volume that stays dry: a smoothed surface reaches beyond its particles, through a thin hull.
#include "shaders/render/frame.glsl"
#include "shaders/common/lang.h"
#include "shaders/fluid/sources/dry_volume.h"
#include "shaders/fluid/sources/in_dry.h"
uniform sampler2D source;  // m
// Of each body that a GPU moves a DeviceBody, which begins with its place (m) and its rotation.
layout(binding = 24) uniform samplerBuffer bodyRows;
uniform int bodyTexels;  // of a row
uniform int volumes;
uniform vec4 dry[48];    // of each volume its DryVolume
layout(location = 0) out float depth;
void main() {
    depth = texelFetch(source, ivec2(gl_FragCoord.xy), 0).r;
    if (depth >= kFar) return;
    vec3 at = toWorld(placeAt(gl_FragCoord.xy, depth));
    for (int k = 0; k < volumes; ++k) {
        DryVolume v = DryVolume(dry[3 * k], dry[3 * k + 1], dry[3 * k + 2]);
        int row = (int(v.reach.w) - 1) * bodyTexels;
        vec3 there = at;
        if (row >= 0) there = turnedBack(texelFetch(bodyRows, row + 1), at - texelFetch(bodyRows, row).xyz);
        if (inDry(there, v)) depth = kFar;
    }
}
