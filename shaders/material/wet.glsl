// A surface that water has touched: darker where it is porous (see darkened()), and glossy while a film of water is on it.
// Needs surface.glsl and noise.glsl, POSED also posed.glsl. A host's own material may include it: docs/embedding.md.
layout(std430, binding = 0) readonly buffer WetCells { int wetCells[]; };
layout(std430, binding = 1) readonly buffer Wetness { float wetness[]; };
#include "shaders/common/lang.h"
#include "shaders/fluid/solids/wet_cells.h"
uniform mat4 wetFromWorld;  // world (m) -> cells; POSED: the body's frame -> cells
uniform ivec3 wetSize;      // cells
uniform uint wetFirstCell;
uniform float porosity;     // 0: not darker when wet, 1: as sand; negative: by roughness and metallic

struct Wet {
    float damp;   // 0..1: share of the surface whose pores hold water
    float film;   // 0..1: share that a film of water covers
    vec3 normal;  // of the film
};

// `rough`: the normal with all relief; `smooth_`: that of the mesh.
Wet wetnessAt(vec3 posWorld, vec3 rough, vec3 smooth_, float roughness, float metallic) {
#if defined(POSED)
    mat4 pose = poseMatrix();
    mat3 back = transpose(mat3(pose));
    mat4 fromWorld = wetFromWorld * mat4(vec4(back[0], 0.0), vec4(back[1], 0.0), vec4(back[2], 0.0), vec4(-(back * pose[3].xyz), 1.0));
#else
    mat4 fromWorld = wetFromWorld;
#endif
    vec3 at = (fromWorld * vec4(posWorld, 1.0)).xyz;
    float w = wetAt(at, wetSize.x, wetSize.y, wetSize.z, wetFirstCell);
    // Edges follow spots of the material instead of the cells, and a surface dries in patches.
    vec4 wide = noise(at * 0.31), fine = noise(at * 0.83 + 17.0);
    w = clamp(w + w * (1.0 - w) * (1.3 * wide.x + 0.7 * fine.x), 0.0, 1.0);
    Wet q;
    q.damp = smoothstep(0.02, 0.85, w) * (porosity < 0.0 ? (1.0 - metallic) * smoothstep(0.25, 0.6, roughness) : porosity);
    q.film = smoothstep(0.4, 0.95, w);
    // The film levels the relief, and is thicker here and there.
    vec3 bumps = transpose(mat3(fromWorld)) * (0.31 * wide.yzw + 0.2 * fine.yzw);
    bumps /= max(length(fromWorld[0].xyz), 1.0e-6);
    vec3 level = normalize(mix(rough, smooth_, 0.6));
    q.normal = normalize(level - 0.22 * (bumps - dot(bumps, level) * level));
    return q;
}

// A porous surface is darker when wet (Twomey, Bohren and Mergenthaler 1986; Lekner and Dorf 1988) for two reasons. Water in its pores has
// nearly the index of the grains, which then scatter less and more forward: absorption over scattering, (1 - R)^2 / (2 R) of the albedo R
// (Kubelka and Munk 1931), doubles. And light that leaves is reflected back by the film with probability p, again and again:
// p = 1 - (1 - 0.066) / 1.333^2, for diffuse light at a surface of water. Together sand of 0.35 becomes 0.14.
vec3 darkened(vec3 albedo, Wet w) {
    const float p = 0.474, enters = 0.98;
    vec3 dry = clamp(albedo, 1.0e-3, 0.999);
    vec3 ratio = (1.0 - dry) * (1.0 - dry) / dry;  // of the wet surface
    vec3 wet = 1.0 + ratio - sqrt(ratio * (ratio + 2.0));
    return mix(albedo, wet * (enters * (1.0 - p)) / (1.0 - p * wet), w.damp);
}

// The light of a surface, diffuse and specular, through and from its film. Water's index is nearly that of the surface: most of the
// surface's own reflection is lost, except that of metal.
vec3 wetted(vec3 matte, vec3 shine, float metallic, Wet w, vec3 toEye, vec3 lightArriving, float open) {
    const vec3 f0 = vec3(0.0204);
    float fresnel = f0.x + (1.0 - f0.x) * schlick(dot(w.normal, toEye));
    vec3 film = gloss(w.normal, toEye, f0, 0.14, 0.0, lightArriving, open);
    return mix(matte + shine, matte * (1.0 - fresnel) + shine * mix(0.35, 1.0 - fresnel, metallic) + film, w.film);
}
