// An eyeball: its iris seen and lit through the refracting cornea, and a wet white. In the frame of the mesh.
// Needs surface.glsl.
uniform mat4 toEyeMatrix;   // world -> eye: the eyeball's centre at the origin, its radius 1, sight along +z
uniform vec4 cornea;        // its sphere's centre along z, its radius, the iris's plane and its radius

// Lambert's equal-area map around the pole: uv of a direction in the eye's images; u may be mirrored.
vec2 uvOfEye(vec3 at, float mirror) {
    float c = 0.5 * sqrt(acos(clamp(at.z / max(length(at), 1.0e-4), -1.0, 1.0)) * 0.3183099);
    vec2 turn = at.xy / max(length(at.xy), 1.0e-5);
    return 0.5 + c * vec2(mirror * turn.x, turn.y);
}

vec2 throughCornea(vec2 uv, vec3 toEye) {
    vec3 at = (toEyeMatrix * vec4(posWorld, 1.0)).xyz;
    vec3 ray = -normalize(mat3(toEyeMatrix) * toEye);
    float edge = length(at.xy) / cornea.w;
    if (edge > 1.08 || at.z < 0.0) return uv;
    // Follows the ray back to the cornea's sphere, refracts it, and continues to the iris.
    vec3 from = at - vec3(0.0, 0.0, cornea.x);
    float b = dot(from, ray), c = dot(from, from) - cornea.y * cornea.y;
    float inside = b * b - c;
    if (inside <= 0.0) return uv;
    vec3 enter = at - ray * (b + sqrt(inside));
    vec3 n = normalize(enter - vec3(0.0, 0.0, cornea.x));
    vec3 bent = refract(ray, n, 1.0 / 1.336);
    if (bent.z > -0.05) return uv;
    vec3 on = enter + bent * ((enter.z - cornea.z) / -bent.z);
    float r = length(on.xy);
    on.xy *= min(1.0, cornea.w * 0.985 / max(r, 1.0e-4));
    float mirror = (uv.x - 0.5) * at.x < 0.0 ? -1.0 : 1.0;
    return mix(uvOfEye(vec3(on.xy, cornea.z), mirror), uv, smoothstep(0.88, 1.08, edge));  // the cornea runs out into the white
}

void shadeEye(vec2 uv, vec3 n, vec3 toEye, vec3 albedo, vec3 falling, float lit, float open, out vec3 matte, out vec3 shine) {
    vec3 at = (toEyeMatrix * vec4(posWorld, 1.0)).xyz, lamp = frame.lightDir.xyz;
    vec3 lampEye = normalize(mat3(toEyeMatrix) * lamp);
    float r = length(at.xy) / cornea.w;
    float iris = at.z > 0.0 ? 1.0 - smoothstep(0.86, 1.08, r) : 0.0;
    // Crying fills the veins of the white and tints it, most towards the corners.
    vec3 red = pow(max(albedo, 0.0), vec3(1.0, 2.0, 1.9)) * vec3(1.0, 0.80, 0.80);
    albedo = mix(albedo, red, flush * (1.0 - iris) * mix(0.45, 1.0, smoothstep(0.55, 1.0, length(at.xy))));
    // The white: subsurface scattering as skin, and wet.
    vec3 wide = clamp(vec3(0.16, 0.10, 0.07), 0.0, 0.97);
    float nl = dot(n, lamp);
    vec3 white = vec3(textureLod(diffusionMap, vec2(0.5 + 0.5 * nl, wide.x), 0.0).r, textureLod(diffusionMap, vec2(0.5 + 0.5 * nl, wide.y), 0.0).r,
                      textureLod(diffusionMap, vec2(0.5 + 0.5 * nl, wide.z), 0.0).r);
    // Shadow of the upper lid and in the corners.
    float lids = smoothstep(-0.05, 0.42, at.y), corners = smoothstep(0.42, 0.92, abs(at.x));
    open *= mix(1.0, 0.30, lids) * mix(1.0, 0.3, corners);
    lit = mix(1.0, lit, smoothstep(-0.15, 0.12, nl));
    float lashes = mix(1.0, 0.35, lids) * mix(1.0, 0.7, corners);  // they shade what the lid does not
    vec3 arriving = white * pow(vec3(lit), vec3(0.7, 0.9, 1.0)) * falling * (0.3183099 * lashes);
    // The iris: a bowl; the cornea focuses light on the side away from the lamp.
    vec2 away = at.xy / cornea.w;
    float gathered = 0.55 + 1.5 * smoothstep(-0.1, 0.9, -dot(away, normalize(lampEye.xy + 1.0e-4)) * length(lampEye.xy)) * smoothstep(0.25, 0.75, r);
    vec3 onIris = max(lampEye.z, 0.0) * lit * falling * 0.3183099 * gathered;
    matte = albedo * (mix(arriving, onIris, iris) + ambient(n) * open * mix(vec3(1.0), vec3(0.8), iris));
    float wet = 1.0 - iris;  // the cornea in front of the iris has its own gloss
    shine = gloss(n, toEye, vec3(0.028), 0.16, 0.002, falling * lit * open, open * open) * wet;
}
