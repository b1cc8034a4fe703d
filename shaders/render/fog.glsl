// With HOST_LIGHT, the fog of a host's scene, which the picture already contains. Light that reaches the water from behind is without the
// fog in front of the water: it is taken out for the distance of the water's surface, and what comes from the water is fogged for this
// distance. Needs frame.glsl.
#if defined(HOST_LIGHT)
// The share of light that passes `distance_`, m.
float fogPasses(float distance_) {
    if (frame.fog.x == 0.0) return 1.0;
    float thick = frame.fog.y * distance_;
    if (frame.fog.x == 1.0) return exp(-thick);
    if (frame.fog.x == 2.0) return exp(-thick * thick);
    return clamp((frame.fog.w - distance_) / (frame.fog.w - frame.fog.z), 0.0, 1.0);
}
// The same from the eye to a pixel of this depth, m.
float fogPasses(vec2 pixel, float depth) { return fogPasses(frame.fogWay.x > 0.0 ? depth : depth * length(sightWay(pixel))); }

vec3 fogDisplay(vec3 c) { return mix(12.92 * c, 1.055 * pow(max(c, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), c)); }
vec3 fogLinear(vec3 c) { return mix(c / 12.92, pow((max(c, vec3(0.0404)) + 0.055) / 1.055, vec3(2.4)), step(vec3(0.04045), c)); }
const float kLeastPasses = 1.0e-4;  // of light that is less, nothing is known
vec3 fogged(vec3 c, float passes) {
    if (passes == 1.0) return c;
    bool display = frame.fogWay.y > 0.0;
    vec3 mixed = mix(frame.fogColour.rgb, display ? fogDisplay(c) : c, passes);
    return max(display ? fogLinear(mixed) : mixed, vec3(0.0));
}
vec3 unfogged(vec3 c, float passes) {
    if (passes == 1.0) return c;
    bool display = frame.fogWay.y > 0.0;
    vec3 fog = frame.fogColour.rgb, clear_ = fog + ((display ? fogDisplay(c) : c) - fog) / max(passes, kLeastPasses);
    return display ? fogLinear(clear_) : clear_;
}
#else
float fogPasses(float distance_) { return 1.0; }
float fogPasses(vec2 pixel, float depth) { return 1.0; }
vec3 fogged(vec3 c, float passes) { return c; }
vec3 unfogged(vec3 c, float passes) { return c; }
#endif
