// The directional lights of a frame: the key light, and with HOST_LIGHT those of a host's scene, of which the first has a shadow map. Needs
// frame.glsl.
#if defined(HOST_LIGHT)
layout(binding = 17) uniform sampler2D hostShadowMap;  // no pass uses this unit

int lightCount() { return int(frame.host.x); }
vec3 lightTowards(int k) { return frame.hostLights[k].xyz; }
vec3 lightColour(int k) { return frame.hostColours[k].rgb; }
// The share of light k that the host's scene lets pass to a point: four texels, each lit or not, weighted by how near they are.
float lightShare(int k, vec3 posWorld) {
    if (k > 0 || frame.host.y == 0.0) return 1.0;
    vec4 clip = frame.hostShadow * vec4(posWorld, 1.0);
    vec3 at = clip.xyz / clip.w;
    if (clip.w <= 0.0 || any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
    ivec2 size = textureSize(hostShadowMap, 0);
    vec2 texel = at.xy * vec2(size) - 0.5, between = fract(texel);
    ivec2 low = ivec2(floor(texel));
    vec4 lit;
    for (int c = 0; c < 4; ++c) {
        float nearest = texelFetch(hostShadowMap, clamp(low + ivec2(c & 1, c >> 1), ivec2(0), size - 1), 0).r;
        lit[c] = (nearest - at.z) * frame.host.w + frame.host.z >= 0.0 ? 1.0 : 0.0;
    }
    vec2 rows = mix(lit.xz, lit.yw, between.x);
    return mix(rows.x, rows.y, between.y);
}
#else
int lightCount() { return 1; }
vec3 lightTowards(int k) { return frame.lightDir.xyz; }
vec3 lightColour(int k) { return frame.lightColour.rgb; }
float lightShare(int k, vec3 posWorld) { return 1.0; }
#endif
