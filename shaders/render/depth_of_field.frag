// What a thin lens does not focus is blurred: each pixel gathers the discs of blur that cover it (after Potmesil and Chakravarty 1981), on
// a spiral of the golden angle (Vogel 1979).
#include "shaders/render/frame.glsl"
uniform sampler2D sceneColour;
uniform sampler2D sceneDepth;  // window depth
uniform sampler2D fluidDepth;  // m
uniform bool water;
flat in vec3 blur;  // pixels: the radius of a disc is |x - y / depth|, at most z
layout(location = 0) out vec4 colour;
const int kSamples = 32;

float depthAt(ivec2 p) {
    float d = depthOfWindow(texelFetch(sceneDepth, p, 0).r);
    return water ? min(d, texelFetch(fluidDepth, p, 0).r) : d;
}
float discAt(float depth) { return min(abs(blur.x - blur.y / depth), blur.z); }

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(sceneColour, 0) - 1;
    vec4 own = texelFetch(sceneColour, here, 0);
    float depth = depthAt(here), disc = discAt(depth);
    // A disc's light is spread over its area; a sample stands for as many pixels as there are for each.
    float weights = 1.0 / max(3.1415927 * disc * disc, 1.0), turn = 6.2831853 * pixelNoise(gl_FragCoord.xy);
    vec3 sum = weights * own.rgb;
    for (int k = 0; k < kSamples; ++k) {
        // Denser towards the middle, where small discs are: each sample stands for its share of the area, over pi.
        float away = blur.z * (float(k) + 0.5) / float(kSamples), angle = turn + 2.3999632 * float(k), each = 2.0 * away * blur.z / float(kSamples);
        ivec2 at = clamp(here + ivec2(round(away * vec2(cos(angle), sin(angle)))), ivec2(0), last);
        float there = depthAt(at), size = discAt(there);
        if (there > depth) size = min(size, disc);  // what lies behind does not cover what lies before it
        float weight = smoothstep(away - 0.75, away + 0.75, size) * each / max(size * size, 0.32);
        sum += weight * texelFetch(sceneColour, at, 0).rgb;
        weights += weight;
    }
    colour = vec4(sum / weights, own.a);
}
