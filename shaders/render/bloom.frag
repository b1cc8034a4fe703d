// Glare by a pyramid of blurs (Jimenez 2014). DOWN: halves a picture, each texel from 13 samples. Else: mixes a share of the next wider
// level, smoothed by a tent of 9 samples, into a level.
uniform sampler2D source;
#if !defined(DOWN)
uniform sampler2D sharp;
uniform float share;
#endif
layout(location = 0) out vec4 colour;
void main() {
    vec2 texel = 1.0 / vec2(textureSize(source, 0));
#if defined(DOWN)
    vec2 uv = 2.0 * gl_FragCoord.xy * texel;
#define AT(x, y) textureLod(source, uv + vec2(x, y) * texel, 0.0).rgb
    vec3 sum = 0.125 * AT(0.0, 0.0) + 0.125 * (AT(-1.0, -1.0) + AT(1.0, -1.0) + AT(-1.0, 1.0) + AT(1.0, 1.0));
    sum += 0.03125 * (AT(-2.0, -2.0) + AT(2.0, -2.0) + AT(-2.0, 2.0) + AT(2.0, 2.0));
    sum += 0.0625 * (AT(0.0, -2.0) + AT(0.0, 2.0) + AT(-2.0, 0.0) + AT(2.0, 0.0));
    colour = vec4(clamp(sum, 0.0, 6.0e4), 1.0);
#else
    ivec2 here = ivec2(gl_FragCoord.xy);
    vec2 uv = 0.5 * gl_FragCoord.xy * texel;  // as DOWN, also at odd sizes
#define AT(x, y) textureLod(source, uv + vec2(x, y) * texel, 0.0).rgb
    vec3 wide = 0.25 * AT(0.0, 0.0) + 0.125 * (AT(-1.0, 0.0) + AT(1.0, 0.0) + AT(0.0, -1.0) + AT(0.0, 1.0));
    wide += 0.0625 * (AT(-1.0, -1.0) + AT(1.0, -1.0) + AT(-1.0, 1.0) + AT(1.0, 1.0));
    vec4 own = texelFetch(sharp, here, 0);
    colour = vec4(mix(own.rgb, wide, share), own.a);
#endif
}
