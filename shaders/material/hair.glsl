// Hair on ribbons: how much of a pixel a hair covers, and its light (Kajiya and Kay 1989; two highlights as Marschner et al. 2003 found).
// Needs surface.glsl.

// The covered share of a pixel's width, so that thin hairs fade instead of breaking up, and a factor on the hair's colour. `strand`: see
// the material. Several hairs on a ribbon differ in place, length and colour.
vec2 hairAt(vec2 uv, vec2 strand) {
    float pixel = max(fwidth(uv.x) * strand.y, 1.0e-4), place = fract(uv.x) * strand.y, number = floor(place), width = strand.x, middle = 0.5;
    vec2 chance = vec2(0.5);
    float covered = 1.0;
    if (strand.y > 1.0) {
        chance = fract(sin(vec2(number + 0.5, number + 7.5) * 12.9898 + floor(uv.x) * 78.233) * 43758.5453);
        middle = mix(0.3, 0.7, chance.x);
        float end = mix(0.55, 1.0, chance.y);
        width *= 1.0 - smoothstep(0.3 * end, end, uv.y);
        covered = smoothstep(0.0, 0.12, uv.y);
    }
    float off = place - number - middle, from = max(abs(off) - 0.5 * pixel, -0.5 * width), to = min(abs(off) + 0.5 * pixel, 0.5 * width);
    float one = clamp((to - from) / pixel, 0.0, 1.0), many = strand.y > 1.0 ? smoothstep(0.6, 1.4, pixel) : 0.0;
    return vec2(covered * mix(one, width, many), strand.y > 1.0 ? (0.6 + 0.8 * chance.x) * mix(0.45, 1.0, smoothstep(0.0, 0.6, uv.y)) : 1.0);
}

// Of light from `lamp`: the diffuse part and the two highlights.
vec3 hairLobes(vec3 along, vec3 normal, vec3 toEye, vec3 lamp) {
    float cosine = dot(along, lamp), side = smoothstep(-0.35, 0.6, dot(normal, lamp));
    vec3 h = halfway(lamp, toEye), first = normalize(along - 0.10 * normal), second = normalize(along + 0.14 * normal);
    float a = dot(first, h), b = dot(second, h);
    return vec3(sqrt(max(1.0 - cosine * cosine, 0.0)), pow(max(1.0 - a * a, 0.0), 60.0), pow(max(1.0 - b * b, 0.0), 14.0)) * side;
}

void shadeHair(vec3 along, vec3 normal, vec3 toEye, vec3 albedo, vec3 falling, float open, out vec3 matte, out vec3 shine) {
    vec3 lobes = hairLobes(along, normal, toEye, frame.lightDir.xyz);
    matte = albedo * (0.3183099 * lobes.x * falling + ambient(normal) * open);
    vec3 tint = sqrt(max(albedo, 0.0));
    shine = (0.05 * lobes.y + 0.25 * albedo * lobes.z) * falling;
#if !defined(ENVIRONMENT_MAP)
    for (int k = 1; k < 3; ++k) {
        vec3 box = hairLobes(along, normal, toEye, frame.boxTowards[k].xyz);
        shine += (0.05 * box.y + 0.25 * albedo * box.z) * frame.boxRadiance[k].rgb * (3.1415927 * frame.boxRadiance[k].w * open);
    }
#endif
    shine += 0.02 * tint * ambient(normal) * open;
}
