// Skin: subsurface scattering (pre-integrated: Penner 2011), two specular lobes, relief down to pores, translucency of thin parts.
// Needs surface.glsl, shadow.glsl and tangents.glsl.
uniform sampler2D reliefMap;   // slopes, see makeSlopes
uniform sampler2D regionsMap;  // oily, dry, hair, lip
uniform sampler2D flushMap;    // red: where it reddens; green: hollows
uniform sampler2D poresMap;    // slopes of a tile
uniform vec3 scatterLength;    // m
uniform vec2 skinAmount;       // strength of translucency, of pores
uniform float poreTiling;      // tiles per unit of uv

// A height's slope in the tangent plane; added to `variance` what of it the mip hides, to `height` (mm) where it lies.
vec3 reliefSlope(sampler2D map, vec2 uv, Tangents t, float stretch, float sizeLod, inout float variance, inout float height) {
    vec4 s = look(map, uv * stretch, t, sizeLod);
    float metric = 0.5 * (dot(t.du, t.du) + dot(t.dv, t.dv)) * stretch * stretch;
    variance += max(s.z - dot(s.xy, s.xy), 0.0) * metric;
    height += s.w;
    return (s.x * t.du + s.y * t.dv) * stretch;
}

// Diffuse reflection of white light from direction `lamp`, with one normal per colour, on a surface of curvature `bend` (1/m).
vec3 spread(vec3 red, vec3 green, vec3 blue, vec3 lamp, float bend) {
    vec3 cosine = 0.5 + 0.5 * vec3(dot(red, lamp), dot(green, lamp), dot(blue, lamp));
    vec3 wide = clamp(scatterLength * bend, 0.0, 0.97) + 0.015;
    return vec3(textureLod(diffusionMap, vec2(cosine.x, wide.x), 0.0).r, textureLod(diffusionMap, vec2(cosine.y, wide.y), 0.0).r,
                textureLod(diffusionMap, vec2(cosine.z, wide.z), 0.0).r);
}

// Specular reflection of skin: a broad lobe, and a sharper one where it is oily; both use one sample of the environment.
vec3 twoLobes(vec3 normal, vec3 toEye, vec3 f0, float rough, float oily, float variance, vec3 lightArriving, float open) {
    float nv = max(dot(normal, toEye), 1.0e-3), nl = max(dot(normal, frame.lightDir.xyz), 0.0);
    vec3 h = halfway(toEye, frame.lightDir.xyz);
    float nh = max(dot(normal, h), 0.0), vh = max(dot(toEye, h), 0.0);
    float broad = rough + 0.08, sharp = 0.62 * rough;
    float extra = min(variance, 0.5), b2 = broad * broad, s2 = sharp * sharp;
    float share = 0.65 * (0.6 + 0.4 * oily), glint = 0.45 * oily;
    vec3 fresnel = f0 + (1.0 - f0) * schlick(vh);
    float both = share * highlight(nl, nv, nh, sqrt(b2 * b2 + extra)) + glint * highlight(nl, nv, nh, sqrt(s2 * s2 + extra));
    float wide = sqrt(sqrt(mix(b2 * b2, s2 * s2, glint / (share + glint)) + extra));
    return fresnel * (both * nl) * lightArriving + glossOf(f0, wide, nv) * environment(reflect(-toEye, normal), wide) * (open * (share + glint));
}
