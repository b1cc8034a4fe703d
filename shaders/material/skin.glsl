// Skin: light that spreads in it (pre-integrated: Penner 2011), two lobes of gloss, relief down to pores, thin parts lit from behind.
// Needs surface.glsl, shadow.glsl and tangents.glsl.
uniform sampler2D reliefMap;   // slopes, see makeSlopes
uniform sampler2D regionsMap;  // oily, dry, hair, lip
uniform sampler2D poresMap;    // slopes of a tile
uniform vec3 scatterLength;    // m
uniform vec2 skinAmount;       // of translucency, of pores
uniform vec2 poreTiling;       // tiles a unit of uv; m a tile

// A height's slope in the tangent plane, and the variance of what the mip hides.
vec3 reliefSlope(sampler2D map, vec2 uv, Tangents t, float stretch, inout float variance) {
    vec2 size = vec2(textureSize(map, 0));
    vec4 s = textureLod(map, uv * stretch, t.lod + log2(max(size.x, size.y) * stretch));
    float metric = 0.5 * (dot(t.du, t.du) + dot(t.dv, t.dv)) * stretch * stretch;
    variance += max(s.z - dot(s.xy, s.xy), 0.0) * metric;
    return (s.x * t.du + s.y * t.dv) * stretch;
}

// What comes back of white light from direction `lamp`, for the normals that each colour sees and a surface bent by `bend` (1/m).
vec3 spread(vec3 red, vec3 green, vec3 blue, vec3 lamp, float bend) {
    vec3 cosine = 0.5 + 0.5 * vec3(dot(red, lamp), dot(green, lamp), dot(blue, lamp));
    vec3 wide = clamp(scatterLength * bend, 0.0, 0.97) + 0.015;
    return vec3(texture(diffusionMap, vec2(cosine.x, wide.x)).r, texture(diffusionMap, vec2(cosine.y, wide.y)).r,
                texture(diffusionMap, vec2(cosine.z, wide.z)).r);
}
