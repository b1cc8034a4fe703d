// A foam particle: all have one colour, so that their order does not matter. Below the water's surface it fades.
#include "shaders/render/frame.glsl"
#include "shaders/render/fog.glsl"
uniform sampler2D sceneDepth;  // window depth
#if defined(OVER_WATER)
uniform sampler2D waterDepth;  // m
uniform float radius;          // m
uniform vec3 absorption;       // 1/m
uniform sampler2D glassDepth;  // window depth
uniform int side;              // 0: everything; 1: only behind glass where there is no water; 2: the rest
#endif
flat in vec4 white;
flat in float depth;
flat in float stretch;  // radii
flat in vec3 cells;
in vec2 place;          // radii
layout(location = 0) out vec4 colour;

// How near the wall between two bubbles: the difference of the distances to the two nearest centres (Worley 1996), 0 on the wall.
float wall(vec2 at) {
    vec2 cell = floor(at), first = vec2(8.0);
    for (int k = 0; k < 9; ++k) {
        vec2 c = cell + vec2(k % 3 - 1, k / 3 - 1);
        float d = length(c + 0.5 + 0.4 * sin(vec2(dot(c, vec2(12.99, 78.23)), dot(c, vec2(39.35, 11.14)))) - at);
        first = d < first.x ? vec2(d, first.x) : vec2(first.x, min(first.y, d));
    }
    return first.y - first.x;
}

void main() {
    vec2 off = vec2(max(abs(place.x) - stretch, 0.0), place.y);
    float d2 = dot(off, off);
    ivec2 here = ivec2(gl_FragCoord.xy);
    if (d2 >= 1.0 || depth > depthOfWindow(texelFetch(sceneDepth, here, 0).r)) discard;
    colour = vec4(white.rgb, white.a * (1.0 - d2));
    if (cells.z > 0.0) colour.a *= mix(1.0, 0.25 + 1.4 * (1.0 - smoothstep(0.0, 0.35, wall(cells.xy + 2.5 * place))), cells.z);
#if defined(OVER_WATER)
    float water = texelFetch(waterDepth, here, 0).r;
    if (side > 0) {
        bool glazed = water >= kFar && depth > depthOfWindow(texelFetch(glassDepth, here, 0).r);
        if (glazed != (side == 1)) discard;
    }
    // Foam on the surface is at its depth, up to the error of the smoothing.
    float under = max(depth - water - 3.0 * radius, 0.0);
    colour.rgb *= exp(-2.0 * absorption * under);
    colour.a *= exp(-under / (8.0 * radius));
#endif
    colour.rgb = fogged(colour.rgb, fogPasses(gl_FragCoord.xy, depth));
}
