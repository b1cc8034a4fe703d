// The studio that lights everything: a gradient from horizon to zenith, a floor below, and three softboxes. One function for what is
// seen behind the scene, what meshes reflect and what water reflects. Needs frame.glsl.

// A rectangle of light at infinity, facing the origin: 1 inside, its edge blurred over `edge` (tangents of angles).
float softbox(vec3 dir, vec3 towards, vec2 halfSize, float edge) {
    vec3 side = normalize(cross(vec3(0.0, 1.0, 0.001), towards));
    float facing = dot(dir, towards);
    if (facing <= 0.05) return 0.0;
    vec2 at = abs(vec2(dot(dir, side), dot(dir, cross(towards, side)))) / facing;
    vec2 inside = 1.0 - smoothstep(halfSize - min(halfSize, edge), halfSize + edge, at);
    vec2 spread = halfSize / max(halfSize, 0.5 * (halfSize + edge));  // what is blurred wider than the box is dimmer
    return inside.x * inside.y * spread.x * spread.y;
}

// Radiance of the sky alone, without softboxes: what is seen directly.
vec3 skyGradient(vec3 dir) {
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
    float blur = 0.03 + 0.9 * roughness * roughness;
    vec3 lifted = normalize(dir + vec3(0.0, 0.6 * roughness, 0.0));  // a wide cone at the horizon sees more of the sky's upper part
    vec3 below = mix(frame.horizon.rgb, floorRadiance(), frame.floorFade.w * smoothstep(0.0, 0.25 + blur, -dir.y));
    vec3 radiance = mix(below, skyGradient(lifted), smoothstep(-blur, blur, dir.y));
    vec3 flat_ = normalize(vec3(frame.lightDir.x, 0.0, frame.lightDir.z) + vec3(1e-4, 0.0, 0.0));
    vec3 key = frame.lightDir.xyz;
    vec3 side = vec3(-flat_.z, 0.0, flat_.x);
    vec3 strip = normalize(side * 0.9 - flat_ * 0.35 + vec3(0.0, 0.45, 0.0));
    vec3 back = normalize(-flat_ * 0.9 - side * 0.5 + vec3(0.0, 0.55, 0.0));
    vec3 tint = frame.lightColour.rgb / max(max(frame.lightColour.r, frame.lightColour.g), max(frame.lightColour.b, 1e-4));
    radiance += frame.lightColour.rgb * 1.3 * softbox(dir, key, vec2(0.42, 0.30), blur);
    radiance += 1.7 * tint * softbox(dir, strip, vec2(0.16, 0.55), blur);
    radiance += 1.1 * vec3(0.86, 0.94, 1.0) * softbox(dir, back, vec2(0.55, 0.28), blur);
    return radiance;
}

// Irradiance / pi: what a white matte surface with this normal returns of the sky and the floor, without the key light.
vec3 ambient(vec3 normal) {
    vec3 above = mix(frame.horizon.rgb, frame.zenith.rgb, 0.6);
    vec3 below = mix(frame.horizon.rgb * 0.6, floorRadiance(), frame.floorFade.w);
    float up = 0.5 + 0.5 * normal.y;
    return mix(below, above, up) * 0.85 + 0.06 * above;
}
