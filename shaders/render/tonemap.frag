// Converts linear radiance to sRGB; alpha stores the luma for the antialiasing filter.
#include "shaders/render/frame.glsl"
uniform sampler2D sceneColour;
uniform float exposure;
layout(location = 0) out vec4 colour;

// Narkowicz 2015's fit of the ACES reference curve, after mixing the channels slightly, so that bright colours become white.
vec3 filmic(vec3 x) {
    x = mix(x, vec3(dot(x, vec3(0.2126, 0.7152, 0.0722))), 0.06);
    return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
}
vec3 toSrgb(vec3 c) { return mix(12.92 * c, 1.055 * pow(max(c, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), c)); }

void main() {
    vec3 light = texelFetch(sceneColour, ivec2(gl_FragCoord.xy), 0).rgb;
    vec2 centre = gl_FragCoord.xy * frame.viewport.zw - 0.5;
    light *= exposure * (1.0 - 0.35 * dot(centre, centre));
    vec3 c = toSrgb(filmic(max(light, 0.0)));
    c = mix(c, c * c * (3.0 - 2.0 * c), 0.4);  // increases the contrast slightly
    colour = vec4(c, dot(c, vec3(0.299, 0.587, 0.114)));
}
