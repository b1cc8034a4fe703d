// The share of the key light that the water lets pass to a point. Needs frame.glsl.
// frame.shadow.y 1: thickness along the light (m), that times its depth, thickness more widely blurred; 2: the light on what it reaches
// first, which is all that meshes do not shade.
uniform sampler2D waterLight;
uniform vec3 waterAbsorption;   // 1/m

// Transmittance of the water between the point and the light, brighter where its surface focuses light.
vec3 waterShadow(vec3 posWorld) {
    if (frame.shadow.y == 0.0) return vec3(1.0);
    vec4 clip = frame.waterProjection * vec4(posWorld, 1.0);
    vec3 at = clip.xyz * 0.5 + 0.5;
    if (any(lessThan(at.xy, vec2(0.0))) || any(greaterThan(at.xy, vec2(1.0)))) return vec3(1.0);
    vec4 water = textureLod(waterLight, at.xy, 0.0);
    if (frame.shadow.y > 1.5) {
        float inside = 0.5 - max(abs(at.x - 0.5), abs(at.y - 0.5)), texel = 1.0 / float(textureSize(waterLight, 0).x);
        return mix(vec3(1.0), water.rgb, smoothstep(2.0 * texel, 4.0 * texel, inside));
    }
    // As if the water lay in one layer around its mean depth: of that, what is nearer the light than the point. Lengths go with the water's
    // own, so that a glass gathers light as a pool does.
    float least = 0.0173 * frame.shadow.w, layer = max(water.x, least);
    float behind = (at.z - water.y / max(water.x, 1.0e-5)) * frame.shadow.w / layer + 0.5;
    float through = water.x * clamp(behind, 0.0, 1.0);
    float covered = smoothstep(0.0, 0.67 * least, through);
    float gather = 1.0 + clamp(0.75 * (water.x - water.z) / least, -0.2, 0.6);
    return mix(vec3(1.0), exp(-waterAbsorption * through) * 0.92 * gather, covered);
}
