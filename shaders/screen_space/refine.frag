// The surface's depth at twice the resolution, by quadratic B-splines: normals computed from it have no steps at texels. The surface ends
// where half of the surroundings of a pixel are not water.
#include "shaders/render/frame.glsl"
uniform sampler2D source;  // m
uniform float range;       // m: depths of one surface differ by less from texel to texel
layout(location = 0) out float depth;
void main() {
    ivec2 last = textureSize(source, 0) - 1;
    vec2 at = gl_FragCoord.xy * frame.viewport.zw * vec2(last + 1);
    ivec2 middle = ivec2(floor(at));
    vec2 t = at - vec2(middle) - 0.5, low = 0.5 * (0.5 - t) * (0.5 - t), high = 0.5 * (0.5 + t) * (0.5 + t);
    vec3 wx = vec3(low.x, 1.0 - low.x - high.x, high.x), wy = vec3(low.y, 1.0 - low.y - high.y, high.y);
    float z[9], water = 0.0, mine = kFar, most = 0.0;
    for (int k = 0; k < 9; ++k) {
        z[k] = texelFetch(source, clamp(middle + ivec2(k % 3, k / 3) - 1, ivec2(0), last), 0).r;
        float w = wx[k % 3] * wy[k / 3];
        if (z[k] < kFar) {
            water += w;
            if (w > most) {
                most = w;
                mine = z[k];
            }
        }
    }
    depth = kFar;
    if (water < 0.5) return;
    // On a plane, 1 / depth is linear in a perspective image, and depth in an orthographic one. Texels of other surfaces are replaced by
    // the centre value.
    float sum = 0.0;
    bool straight = parallel() > 0.0;
    for (int k = 0; k < 9; ++k) {
        float own = abs(z[k] - mine) < range ? z[k] : mine;
        sum += wx[k % 3] * wy[k / 3] * (straight ? own : 1.0 / own);
    }
    depth = straight ? sum : 1.0 / sum;
}
