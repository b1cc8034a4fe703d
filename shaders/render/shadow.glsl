// The share of the key light that meshes let pass to a point: their shadow map (exponential variance shadow map: Lauritzen and McCool
// 2008). Needs frame.glsl.
uniform sampler2D shadowSharp;  // moments, narrowly blurred
uniform sampler2D shadowSoft;   // moments, widely blurred

const float kWarp = 40.0, kLevel = 3.2e-3;

// `blocker`: the depth of what shades it, of the mean without its lit part (Yang et al. 2010).
// `spread`: of the depth, beyond which a point is surely shaded, as a share of what is warped.
float litFraction(vec2 moments, float warped, float spread, out float blocker) {
    float variance = max(moments.y - moments.x * moments.x, spread * spread * warped * warped);
    float beyond = warped - moments.x;
    float p = beyond <= 0.0 ? 1.0 : variance / (variance + beyond * beyond);
    blocker = log(p > 0.999 ? warped : max((moments.x - p * warped) / (1.0 - p), 1.0e-20)) / kWarp;
    return smoothstep(0.12, 1.0, p);  // reduces light bleeding
}

// `thickness`: m of meshes between the point and where the light enters them, 0 where it is lit; blurred as the sharp map is.
float meshShadow(vec3 posWorld, vec3 normal, out float thickness) {
    thickness = 1.0;
    if (frame.shadow.x == 0.0) return 1.0;
    vec3 across = vec3(frame.shadowProjection[0].x, frame.shadowProjection[1].x, frame.shadowProjection[2].x);  // 1/m, of half the map
    vec4 clip = frame.shadowProjection * vec4(posWorld + normal * (0.008 / length(across)), 1.0);
    vec3 at = clip.xyz * 0.5 + 0.5;
    if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) return 1.0;
    float warped = exp(kWarp * clamp(at.z, 0.0, 1.0));
    float blocker, nearest;
    vec2 narrow = textureLod(shadowSharp, at.xy, 0.0).xy;
    float entered = narrow.x;
    float soft = litFraction(textureLod(shadowSoft, at.xy, 0.0).xy, warped, kLevel, blocker);
#if defined(SKIN)
    // A shadow's edge is as wide as the key light's softbox makes it, and at least as the light spreads in skin.
    const float kTangent = 0.26, kLeast = 4.5e-3, kMost = 9.0e-3;  // of the softbox; m; the soft map has wider edges
    float reach = clamp(kTangent * (at.z - blocker) * frame.shadow.z, kLeast, kMost) * 0.5 * length(across);
    vec2 sum = narrow;  // and the depth where light enters: the nearest around, since at an edge of the map the farthest is behind it
    for (int k = 0; k < 12; ++k) {  // on a disc, along a spiral of golden angles
        float turn = 2.39996 * float(k);
        vec2 there = textureLod(shadowSharp, at.xy + vec2(cos(turn), sin(turn)) * (reach * sqrt((float(k) + 1.0) / 12.0)), 0.0).xy;
        sum += there;
        entered = min(entered, there.x);
    }
    // A surface along the light has many depths within that.
    float facing = clamp(dot(normal, frame.lightDir.xyz), 0.05, 1.0), tilt = sqrt(1.0 - facing * facing) / facing;
    float deep = reach / (0.5 * length(across)) * tilt / frame.shadow.z;
    float sharp = litFraction(sum / 13.0, warped, kLevel + 0.5 * kWarp * deep, nearest);
#else
    float sharp = litFraction(narrow, warped, kLevel, nearest);
#endif
    thickness = max(at.z - log(max(entered, 1.0e-20)) / kWarp, 0.0) * frame.shadow.z;
    return mix(sharp, soft, smoothstep(0.0, 0.25, at.z - blocker));  // a shadow is soft far from its caster
}
float meshShadow(vec3 posWorld, vec3 normal) {
    float thickness;
    return meshShadow(posWorld, normal, thickness);
}
