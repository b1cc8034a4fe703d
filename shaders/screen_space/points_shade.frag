// Lights the spheres that points.frag has drawn.
#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#include "shaders/render/fog.glsl"
#include "shaders/render/lights.glsl"
#include "shaders/render/shadow.glsl"
#include "shaders/material/surface.glsl"
uniform sampler2D surface;
uniform sampler2D normal;
uniform sampler2D depth;  // window depth
layout(location = 0) out vec4 colour;
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 base = texelFetch(surface, here, 0);
    if (base.a == 0.0) discard;
    vec2 xy = texelFetch(normal, here, 0).rg;
    float away = depthOfWindow(texelFetch(depth, here, 0).r);
    vec3 p = placeAt(gl_FragCoord.xy, away), world = toWorld(p);
    vec3 n = directionToWorld(vec3(xy, sqrt(max(1.0 - dot(xy, xy), 0.0))));
    vec3 toEye = directionToWorld(towardsEye(p));
    Surface s = Surface(base.rgb * base.rgb, 0.45, 0.0, n, 1.0);
    vec3 light = shadeSurface(s, toEye, frame.lightColour.rgb * (meshShadow(world, n) * lightShare(0, world)));
    for (int k = 1; k < lightCount(); ++k) light += directLight(s, toEye, lightTowards(k), lightColour(k));
    colour = vec4(fogged(light, fogPasses(gl_FragCoord.xy, away)), 1.0);
}
