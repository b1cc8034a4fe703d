// The surface function of meshes and floor: Lambert plus GGX (Walter et al. 2007; Smith visibility after Hammon 2017), lit by the key light
// and the environment. Needs frame.glsl and environment.glsl.
#include "shaders/render/fresnel.glsl"
struct Surface {
    vec3 baseColour;   // linear reflectance
    float roughness;   // 0..1
    float metallic;    // 0..1
    vec3 normal;       // unit, world
    float occlusion;   // 0..1: visible share of the environment
};

// GGX times the visibility, for `a` = roughness squared.
float highlight(float nl, float nv, float nh, float a) {
    float a2 = a * a;
    float d = a2 / (3.1415927 * pow(nh * nh * (a2 - 1.0) + 1.0, 2.0));
    return d * (0.5 / mix(2.0 * nl * nv + 1.0e-4, nl + nv, a));
}
// The environment's specular part: Karis 2014's fit of the split sum.
vec3 glossOf(vec3 f0, float roughness, float nv) {
    vec4 k = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float b = min(k.x * k.x, exp2(-9.28 * nv)) * k.x + k.y;
    return f0 * (-1.04 * b + k.z) + (1.04 * b + k.w);
}

// The light of one direction that the surface sends to the eye.
vec3 directLight(Surface s, vec3 toEye, vec3 towards, vec3 lightArriving) {
    float nv = max(dot(s.normal, toEye), 1.0e-3);
    float nl = max(dot(s.normal, towards), 0.0);
    vec3 h = halfway(toEye, towards);
    float nh = max(dot(s.normal, h), 0.0), vh = max(dot(toEye, h), 0.0);
    vec3 f0 = mix(vec3(0.04), s.baseColour, s.metallic);
    vec3 fresnel = f0 + (1.0 - f0) * schlick(vh);
    vec3 matte = s.baseColour * (1.0 - s.metallic);
    return (matte * 0.3183099 + fresnel * highlight(nl, nv, nh, max(s.roughness * s.roughness, 0.01))) * nl * lightArriving;
}

// `mirrored`: radiance of the environment from the mirror direction, blurred by the roughness.
vec3 shadeSurface(Surface s, vec3 toEye, vec3 lightArriving, vec3 mirrored) {
    float nv = max(dot(s.normal, toEye), 1.0e-3);
    vec3 f0 = mix(vec3(0.04), s.baseColour, s.metallic);
    vec3 matte = s.baseColour * (1.0 - s.metallic);
    vec3 direct = directLight(s, toEye, frame.lightDir.xyz, lightArriving);
    vec3 indirect = matte * ambient(s.normal) + glossOf(f0, s.roughness, nv) * mirrored;
    return direct + indirect * s.occlusion;
}
vec3 shadeSurface(Surface s, vec3 toEye, vec3 lightArriving) {
    return shadeSurface(s, toEye, lightArriving, environment(reflect(-toEye, s.normal), max(s.roughness, 0.08)));
}

// Specular reflection only, of the key light and the environment: one lobe. `variance`: of the slopes whose mean is `normal`.
vec3 gloss(vec3 normal, vec3 toEye, vec3 f0, float roughness, float variance, vec3 lightArriving, float open) {
    float nv = max(dot(normal, toEye), 1.0e-3);
    float nl = max(dot(normal, frame.lightDir.xyz), 0.0);
    vec3 h = halfway(toEye, frame.lightDir.xyz);
    float nh = max(dot(normal, h), 0.0), vh = max(dot(toEye, h), 0.0);
    float a = sqrt(roughness * roughness * roughness * roughness + min(variance, 0.5));  // of GGX, widened (Olano and Baker 2010)
    float wide = sqrt(a);
    vec3 fresnel = f0 + (1.0 - f0) * schlick(vh);
    vec3 direct = fresnel * (highlight(nl, nv, nh, max(a, 0.003)) * nl) * lightArriving;
    return direct + glossOf(f0, wide, nv) * environment(reflect(-toEye, normal), wide) * open;
}
