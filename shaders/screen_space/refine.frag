// The surface's depth for a picture twice as large each way: between texels of one surface it runs on evenly, and it ends where half of what
// is about a pixel is no water.
#include "shaders/render/frame.glsl"
uniform sampler2D source;  // m
uniform float range;       // m: depths of one surface differ by less from texel to texel
layout(location = 0) out float depth;
void main() {
    ivec2 last = textureSize(source, 0) - 1;
    vec2 at = gl_FragCoord.xy * frame.viewport.zw * vec2(last + 1) - 0.5;
    ivec2 first = ivec2(floor(at));
    vec2 f = at - vec2(first);
    vec4 w = vec4((1.0 - f.x) * (1.0 - f.y), f.x * (1.0 - f.y), (1.0 - f.x) * f.y, f.x * f.y);
    vec4 z = vec4(texelFetch(source, clamp(first, ivec2(0), last), 0).r, texelFetch(source, clamp(first + ivec2(1, 0), ivec2(0), last), 0).r,
                  texelFetch(source, clamp(first + ivec2(0, 1), ivec2(0), last), 0).r, texelFetch(source, clamp(first + 1, ivec2(0), last), 0).r);
    vec4 there = vec4(lessThan(z, vec4(kFar)));
    depth = kFar;
    if (dot(w, there) < 0.5) return;
    // The surface that most of the pixel is nearest to.
    vec4 seen = w * there;
    float most = max(max(seen.x, seen.y), max(seen.z, seen.w));
    float mine = seen.x == most ? z.x : seen.y == most ? z.y : seen.z == most ? z.z : z.w;
    seen *= vec4(lessThan(abs(z - mine), vec4(range)));
    // Along a plane 1 / depth is what is even in the picture.
    depth = dot(seen, vec4(1.0)) / dot(seen, 1.0 / z);
}
