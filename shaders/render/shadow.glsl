// The share of the key light that reaches a point: the shadow map of the meshes (exponential variance shadow map: Lauritzen and McCool 2008) and
// the light map of the water. Needs frame.glsl.
uniform sampler2D shadowSharp;  // moments, narrowly blurred
uniform sampler2D shadowSoft;   // moments, widely blurred
uniform sampler2D waterLight;   // thickness along the light (m), that times its depth, thickness relative to its surroundings (m)
uniform vec3 waterAbsorption;   // 1/m

const float kWarp = 40.0;

// `blocker`: the depth of what shades it, of the mean without its lit part (Yang et al. 2010).
float litFraction(vec2 moments, float warped, out float blocker) {
    float variance = max(moments.y - moments.x * moments.x, 1.0e-5 * warped * warped);
    float beyond = warped - moments.x;
    float p = beyond <= 0.0 ? 1.0 : variance / (variance + beyond * beyond);
    blocker = log(p > 0.999 ? warped : max((moments.x - p * warped) / (1.0 - p), 1.0e-20)) / kWarp;
    return smoothstep(0.12, 1.0, p);  // reduces light bleeding
}

// `thickness`: m of meshes between the point and where the light enters them, 0 where it is lit; blurred as the sharp map is.
float meshShadow(vec3 posWorld, vec3 normal, out float thickness) {
    thickness = 1.0;
    if (frame.shadow.x == 0.0) return 1.0;
    vec4 clip = frame.shadowProjection * vec4(posWorld + normal * (0.004 * frame.shadow.z), 1.0);
    vec3 at = clip.xyz * 0.5 + 0.5;
    if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) return 1.0;
    float warped = exp(kWarp * clamp(at.z, 0.0, 1.0));
    float blocker, nearest;
    vec2 narrow = texture(shadowSharp, at.xy).xy;
    float soft = litFraction(texture(shadowSoft, at.xy).xy, warped, blocker), sharp = litFraction(narrow, warped, nearest);
    thickness = max(at.z - log(max(narrow.x, 1.0e-20)) / kWarp, 0.0) * frame.shadow.z;
    return mix(sharp, soft, smoothstep(0.0, 0.25, at.z - blocker));  // a shadow is soft far from its caster
}
float meshShadow(vec3 posWorld, vec3 normal) {
    float thickness;
    return meshShadow(posWorld, normal, thickness);
}

// Transmittance of the water between the point and the light, brighter where its surface focuses light.
vec3 waterShadow(vec3 posWorld) {
    if (frame.shadow.y == 0.0) return vec3(1.0);
    vec4 clip = frame.waterProjection * vec4(posWorld, 1.0);
    vec3 at = clip.xyz * 0.5 + 0.5;
    if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) return vec3(1.0);
    vec3 water = texture(waterLight, at.xy).xyz;
    // As if the water lay in one layer around its mean depth: of that, what is nearer the light than the point. Lengths go with the water's
    // own, so that a glass gathers light as a pool does.
    float least = 0.0173 * frame.shadow.w, layer = max(water.x, least);
    float behind = (at.z - water.y / max(water.x, 1.0e-5)) * frame.shadow.w / layer + 0.5;
    float through = water.x * clamp(behind, 0.0, 1.0);
    float covered = smoothstep(0.0, 0.67 * least, through);
    float gather = 1.0 + clamp(0.75 * water.z / least, -0.2, 0.6);
    return mix(vec3(1.0), exp(-waterAbsorption * through) * 0.92 * gather, covered);
}
