// Smooths jagged edges in the finished picture by blurring along them (after Lottes 2009, FXAA), then dithers.
#include "shaders/render/frame.glsl"
uniform sampler2D picture;  // luma in alpha
layout(location = 0) out vec4 colour;
void main() {
    vec2 uv = gl_FragCoord.xy * frame.viewport.zw, px = frame.viewport.zw;
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec4 centre = texelFetch(picture, here, 0);
    vec3 c = centre.rgb;
    float nw = textureLod(picture, uv + vec2(-0.5, 0.5) * px, 0.0).a, ne = textureLod(picture, uv + vec2(0.5, 0.5) * px, 0.0).a;
    float sw = textureLod(picture, uv + vec2(-0.5, -0.5) * px, 0.0).a, se = textureLod(picture, uv + vec2(0.5, -0.5) * px, 0.0).a;
    float low = min(centre.a, min(min(nw, ne), min(sw, se))), high = max(centre.a, max(max(nw, ne), max(sw, se)));
    if (high - low > max(0.04, 0.1 * high)) {
        vec2 dir = vec2((sw + se) - (nw + ne), (nw + sw) - (ne + se));
        dir = vec2(-((nw + ne) - (sw + se)), (nw + sw) - (ne + se));
        float least = max((nw + ne + sw + se) * 0.03, 1.0 / 128.0);
        dir = clamp(dir / (min(abs(dir.x), abs(dir.y)) + least), -6.0, 6.0) * px;
        vec4 a = 0.5 * (textureLod(picture, uv - dir / 6.0, 0.0) + textureLod(picture, uv + dir / 6.0, 0.0));
        vec4 b = 0.5 * a + 0.25 * (textureLod(picture, uv - dir * 0.5, 0.0) + textureLod(picture, uv + dir * 0.5, 0.0));
        c = b.a < low || b.a > high ? a.rgb : b.rgb;
    }
    float noise = pixelNoise(gl_FragCoord.xy) + pixelNoise(gl_FragCoord.yx + 47.0) - 1.0;  // triangular
    colour = vec4(c + noise / 255.0, 1.0);
}
