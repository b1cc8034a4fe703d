// Shows intermediate results of the water's surface: normals as in the thesis (9), depth, thickness.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/ramp.glsl"
uniform sampler2D sceneColour;
uniform sampler2D sceneDepth;  // window depth
uniform sampler2D fluidDepth;  // m
uniform sampler2D thickness;   // m
uniform int what;              // 1 normals, 2, 3 depth, 4 thickness: of WaterView
uniform vec2 depths;           // m: depths at the ends of the colour map
uniform float fullThickness;   // m
layout(location = 0) out vec4 colour;

vec3 pointAt(ivec2 p) {
    p = clamp(p, ivec2(0), ivec2(frame.viewport.xy) - 1);
    return placeAt(vec2(p) + 0.5, texelFetch(fluidDepth, p, 0).r);
}
// The nearer side of a pixel.
vec3 side(ivec2 here, ivec2 step_) {
    vec3 p = pointAt(here), a = pointAt(here + step_) - p, b = p - pointAt(here - step_);
    return abs(a.z) < abs(b.z) ? a : b;
}
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    colour = texelFetch(sceneColour, here, 0);
    float depth = texelFetch(fluidDepth, here, 0).r;
    if (depth >= kFar || depth >= depthOfWindow(texelFetch(sceneDepth, here, 0).r)) return;
    if (what == 1)
        colour.rgb = abs(directionToWorld(normalize(cross(side(here, ivec2(1, 0)), side(here, ivec2(0, 1))))));
    else if (what == 4)
        colour.rgb = ramp(textureLod(thickness, gl_FragCoord.xy * frame.viewport.zw, 0.0).r / fullThickness);
    else
        colour.rgb = vec3(1.0 - clamp((depth - depths.x) / max(depths.y - depths.x, 1.0e-6), 0.0, 1.0));
}
