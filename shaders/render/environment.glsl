// The environment light: a studio, or with ENVIRONMENT_MAP an image.
// The studio: a gradient from horizon to zenith, a floor below, and three softboxes. One function for the background, the reflections of
// meshes and the reflections of water. Needs frame.glsl.

// Softbox k: a rectangle of light at infinity, facing the origin, its edge blurred over `edge` (tangents of angles).
vec3 softbox(int k, vec3 dir, float edge) {
    vec3 towards = frame.boxTowards[k].xyz, side = frame.boxSide[k].xyz;
    vec2 halfSize = vec2(frame.boxTowards[k].w, frame.boxSide[k].w);
    float facing = dot(dir, towards);
    vec2 at = abs(vec2(dot(dir, side), dot(dir, cross(towards, side)))) / max(facing, 0.05);
    vec2 inside = 1.0 - smoothstep(halfSize - min(halfSize, edge), halfSize + edge, at);
    vec2 spread = halfSize / max(halfSize, 0.5 * (halfSize + edge));  // a box blurred wider than itself is dimmer
    return frame.boxRadiance[k].rgb * (facing > 0.05 ? inside.x * inside.y * spread.x * spread.y : 0.0);
}

#if defined(ENVIRONMENT_MAP)
layout(binding = 16) uniform sampler2D environmentMap;  // see environment_map.h; no pass uses this unit
vec3 surroundings(vec3 dir, float lod) {
    float edge = 0.5 * exp2(lod) / float(textureSize(environmentMap, 0).y);  // no wrap-around at the poles
    vec2 uv = vec2(atan(dir.x, -dir.z) * 0.15915494 + 0.5, asin(clamp(dir.y, -1.0, 1.0)) * 0.3183099 + 0.5);
    return textureLod(environmentMap, vec2(uv.x, clamp(uv.y, edge, 1.0 - edge)), lod).rgb;
}
#endif

// Radiance of the sky without softboxes, for the background.
vec3 skyGradient(vec3 dir) {
#if defined(ENVIRONMENT_MAP)
    return surroundings(dir, 1.0);
#endif
    float up = max(dir.y, 0.0);
    return mix(frame.horizon.rgb, frame.zenith.rgb, 1.0 - exp(-3.2 * up));
}

// The floor as seen from far away, lit by the key light and the sky.
vec3 floorRadiance() {
    vec3 light = frame.lightColour.rgb * max(frame.lightDir.y, 0.0) * 0.3183099 + 0.55 * mix(frame.horizon.rgb, frame.zenith.rgb, 0.6);
    return frame.floorColour.rgb * light;
}

// Radiance from direction `dir` (world, unit) averaged over a cone; roughness 0: a mirror, 1: about the whole hemisphere.
vec3 environment(vec3 dir, float roughness) {
#if defined(ENVIRONMENT_MAP)
    float fine = float(textureSize(environmentMap, 0).x) / 256.0;
    return surroundings(dir, log2(max(24.0 * roughness * roughness, 1.0) * fine));  // selects the mip whose texels are as wide as the cone
#endif
    float blur = 0.03 + 0.9 * roughness * roughness;
    vec3 lifted = normalize(dir + vec3(0.0, 0.6 * roughness, 0.0));  // a wide cone at the horizon sees more of the sky's upper part
    vec3 below = mix(frame.horizon.rgb, floorRadiance(), frame.floorFade.w * smoothstep(0.0, 0.25 + blur, -dir.y));
    vec3 radiance = mix(below, skyGradient(lifted), smoothstep(-blur, blur, dir.y));
    for (int k = 0; k < 3; ++k) radiance += softbox(k, dir, blur);
    return radiance;
}

// Irradiance / pi: the radiance of a white diffuse surface with this normal, lit by sky, floor and softboxes without the key light.
vec3 ambient(vec3 normal) {
#if defined(ENVIRONMENT_MAP)
    vec3 n = normal, sum = frame.matteLight[0].rgb + frame.matteLight[1].rgb * n.y + frame.matteLight[2].rgb * n.z + frame.matteLight[3].rgb * n.x;
    sum += frame.matteLight[4].rgb * (n.x * n.y) + frame.matteLight[5].rgb * (n.y * n.z) + frame.matteLight[6].rgb * (3.0 * n.z * n.z - 1.0);
    return max(sum + frame.matteLight[7].rgb * (n.x * n.z) + frame.matteLight[8].rgb * (n.x * n.x - n.y * n.y), 0.0);
#endif
    vec3 above = mix(frame.horizon.rgb, frame.zenith.rgb, 0.6);
    vec3 below = mix(frame.horizon.rgb * 0.6, floorRadiance(), frame.floorFade.w);
    float up = 0.5 + 0.5 * normal.y;
    vec3 around = mix(below, above, up) * 0.9;
    for (int k = 1; k < 3; ++k) around += frame.boxRadiance[k].rgb * (frame.boxRadiance[k].w * max(dot(normal, frame.boxTowards[k].xyz), 0.0));
    return around;
}
