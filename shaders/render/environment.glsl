// The studio that lights everything: a gradient from horizon to zenith, a floor below, and three softboxes. One function for what is
// seen behind the scene, what meshes reflect and what water reflects. Needs frame.glsl.

// Softbox k: a rectangle of light at infinity, facing the origin, its edge blurred over `edge` (tangents of angles).
vec3 softbox(int k, vec3 dir, float edge) {
    vec3 towards = frame.boxTowards[k].xyz, side = frame.boxSide[k].xyz;
    vec2 halfSize = vec2(frame.boxTowards[k].w, frame.boxSide[k].w);
    float facing = dot(dir, towards);
    vec2 at = abs(vec2(dot(dir, side), dot(dir, cross(towards, side)))) / max(facing, 0.05);
    vec2 inside = 1.0 - smoothstep(halfSize - min(halfSize, edge), halfSize + edge, at);
    vec2 spread = halfSize / max(halfSize, 0.5 * (halfSize + edge));  // what is blurred wider than the box is dimmer
    return frame.boxRadiance[k].rgb * (facing > 0.05 ? inside.x * inside.y * spread.x * spread.y : 0.0);
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
    for (int k = 0; k < 3; ++k) radiance += softbox(k, dir, blur);
    return radiance;
}

// Irradiance / pi: what a white matte surface with this normal returns of the sky and the floor, without the key light.
vec3 ambient(vec3 normal) {
    vec3 above = mix(frame.horizon.rgb, frame.zenith.rgb, 0.6);
    vec3 below = mix(frame.horizon.rgb * 0.6, floorRadiance(), frame.floorFade.w);
    float up = 0.5 + 0.5 * normal.y;
    return mix(below, above, up) * 0.9;
}
