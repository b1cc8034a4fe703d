// The light of a drop of water, from behind and from its surface. Needs frame.glsl and environment.glsl.
#include "shaders/render/fog.glsl"
#include "shaders/render/fresnel.glsl"
#include "shaders/render/lights.glsl"
uniform sampler2D sceneColour;
uniform sampler2D sceneDepth;  // window depth
#if defined(OVER_WATER)
uniform sampler2D waterDepth;  // m
#endif
uniform float refractiveIndex;

float depthBehind() { return depthOfWindow(texelFetch(sceneDepth, ivec2(gl_FragCoord.xy), 0).r); }  // m
// Whether something in front hides a surface of this depth, m.
bool isHidden(float depth) {
#if defined(OVER_WATER)
    if (depth > texelFetch(waterDepth, ivec2(gl_FragCoord.xy), 0).r) return true;
#endif
    return depth > depthBehind();
}

// What a ray that leaves the drop at `from` (m, view) sees, for a drop whose surface has this depth (m). `closed`: share of the
// surroundings that the scene behind hides beyond the picture's edge.
vec3 seenThrough(vec3 from, vec3 way, float depth, float closed) {
    vec3 met = from + way * clamp(depthBehind() - depth, 0.0, 0.4);
    vec2 uv = pixelOf(met) * frame.viewport.zw;
    vec2 inside = smoothstep(vec2(0.5), vec2(0.45), abs(uv - 0.5));
    float seen = met.z < -frame.planes.x ? inside.x * inside.y : 0.0;
    uv = clamp(uv, frame.viewport.zw, 1.0 - frame.viewport.zw);
    // Objects in front of the drop are not visible in it.
    if (depthOfWindow(textureLod(sceneDepth, uv, 0.0).r) < depth) seen = 0.0;
    vec3 behind = unfogged(textureLod(sceneColour, uv, 0.0).rgb, fogPasses(gl_FragCoord.xy, depth));
    return mix(environment(directionToWorld(way), 0.15), behind, max(seen, closed));
}

// `through`: the light from behind; `at`: a point of the surface, and n: its normal, in view; `closed`: share of the surroundings that the
// scene behind hides. In the fog of the scene.
vec3 lightOfDrop(vec3 through, vec3 at, vec3 n, vec3 toEye, float closed) {
    float base = (refractiveIndex - 1.0) / (refractiveIndex + 1.0);
    float mirror = mix(base * base, 1.0, schlick(dot(n, toEye)));
    vec3 way = reflect(-toEye, n), mirrored = environment(directionToWorld(way), 0.05);
    float passes = fogPasses(gl_FragCoord.xy, -at.z);
    vec3 behind = unfogged(texelFetch(sceneColour, ivec2(gl_FragCoord.xy), 0).rgb, passes);
    if (closed > 0.0) mirrored = mix(mirrored, behind, closed * smoothstep(0.0, 0.3, -dot(way, toEye)));
    vec3 light = mix(through, mirrored, mirror);
    for (int k = 0; k < lightCount(); ++k) {
        vec3 half_ = halfway(toEye, transpose(mat3(frame.inverseView)) * lightTowards(k));
        light += lightColour(k) * (0.6 * smoothstep(0.975, 0.995, dot(n, half_)) * lightShare(k, toWorld(at)));
    }
    return fogged(light, passes);
}
