// A mesh with a full material: textures on the plain surface function (GLOW: emission), on SKIN, on an EYE; BLENDED, WET, with a LAYER.
#include "shaders/render/frame.glsl"
#include "shaders/render/environment.glsl"
#include "shaders/render/shadow.glsl"
#include "shaders/render/water_light.glsl"
#include "shaders/material/surface.glsl"
#include "shaders/material/tangents.glsl"
in vec3 posWorld;
in vec3 normalWorld;
in vec2 posUv;
in float curvature;
uniform vec3 baseColour;
uniform float roughness;
uniform float metallic;
uniform float opacity;
uniform float flush;   // 0..1: redness of skin and of the white of an eye
uniform float cutoff;
uniform vec2 strand;   // hair on ribbons: width of a hair as a share of its part of u, 0: none; hairs side by side
uniform vec4 mapLod;   // log2 of the widths of the maps of colour, relief, regions and pores (those tiled)
uniform sampler2D occlusion;
uniform sampler2D colourMap;
uniform sampler2D roughnessMap;  // green; metallic: blue
uniform sampler2D normalMap;
#if defined(GLOW)
uniform sampler2D occlusionMap;  // red
uniform sampler2D glowMap;
uniform vec3 emission;
#endif
uniform sampler2D diffusionMap;  // see makeDiffusionTable
layout(location = 0) out vec4 colour;
#if defined(WET) || defined(LAYER)
#include "shaders/material/noise.glsl"
#endif
#if defined(WET)
#include "shaders/material/wet.glsl"
#endif
#if defined(SKIN)
#include "shaders/material/skin.glsl"
#endif
#if defined(EYE)
#include "shaders/material/eye.glsl"
#endif
#if defined(BLENDED)
#include "shaders/material/hair.glsl"
#endif
#if defined(LAYER)
#include "shaders/material/layer.glsl"
#if defined(BLENDED)
uniform sampler2D behindMap;  // linear radiance of the solid scene
#endif
#endif

void main() {
    vec3 toEye = normalize(frame.cameraPos.xyz - posWorld);
    vec3 n = normalize(normalWorld);
    if (!gl_FrontFacing) n = -n;
    Tangents t = tangentsAt(posWorld, posUv, n);
    vec2 uv = posUv;
    float open = textureLod(occlusion, gl_FragCoord.xy * frame.viewport.zw, 0.0).r;
#if defined(BLENDED)
    if (opacity < 0.3) open = 1.0;  // it is known for the opaque surface behind
#endif
    vec3 lamp = frame.lightDir.xyz;
    vec3 falling = frame.lightColour.rgb;
#if defined(WATER)
    falling *= waterShadow(posWorld);
#endif
    float thick, lit = meshShadow(posWorld, n, thick);
#if defined(LAYER)
    Liquid q = liquidAt(t, uv, toEye);
    uv = q.uvBelow;
#endif
#if defined(EYE)
    uv = throughCornea(uv, toEye);
#endif
    vec4 albedo = look(colourMap, uv, t, mapLod.x) * vec4(baseColour, opacity);
    bool cut = albedo.a < cutoff;  // at the end: textures and derivatives need the pixels beside
#if defined(BLENDED)
    if (strand.x > 0.0) {
        vec2 hair = hairAt(posUv, strand);
        albedo.a *= hair.x * (2.0 - hair.x);  // hairs shade each other
        albedo.rgb *= hair.y;
    }
#endif
#if defined(LAYER)
    albedo.rgb = mix(albedo.rgb, albedo.rgb * sqrt(max(albedo.rgb, 0.0)) * 1.12, layerLook.w * q.wet * (1.0 - 0.6 * q.drop));
#endif

    vec3 matte, shine = vec3(0.0), f0 = vec3(0.04), facing = n;
#if defined(SKIN)
    vec2 flushes = look(flushMap, uv, t, mapLod.z).rg;
    float blood = flush * flushes.r;
    open *= 1.0 - flushes.g;
    albedo.rgb *= mix(vec3(1.0), vec3(0.98, 0.60, 0.58), blood);
    vec4 region = look(regionsMap, uv, t, mapLod.z);
    float fade = 1.0 - 0.5 * region.b, variance = 0.0, height = 0.0;
    vec3 slope = reliefSlope(reliefMap, uv, t, 1.0, mapLod.y, variance, height);
    vec3 fine = reliefSlope(poresMap, uv, t, poreTiling, mapLod.w, variance, height) * (skinAmount.y * fade * (1.0 + 0.5 * region.r));
    variance *= skinAmount.y;
#if defined(LAYER)
    float filled = 1.0 / (1.0 + (q.path + q.film) / 3.0e-5);  // a film fills the pores
#endif
    albedo.rgb *= clamp(1.0 + 3.2 * height * fade, 0.65, 1.12);  // less light comes out of a furrow
    facing = normalize(n - slope - fine);
    vec3 soft = normalize(n - 0.35 * (slope + fine)), blurred = normalize(n - 0.12 * (slope + fine));
    float bend = clamp(abs(curvature), 2.0, 250.0), nl = dot(n, lamp);
    lit = mix(1.0, lit, smoothstep(0.0, 0.4, nl));  // near the terminator the table is more exact than the shadow map
    vec3 through = mix(vec3(lit), vec3(sqrt(lit)), vec3(0.9, 0.3, 0.0));  // red bleeds into a shadow's edge
    vec3 arriving = spread(blurred, soft, facing, lamp, bend) * through * falling;
    // Light that skin reflects to skin fills what is occluded, with its colour (Jimenez et al. 2016, multi-bounce occlusion).
    vec3 lessOccluded = max(vec3(open), ((open * (2.0404 * albedo.rgb - 0.3324) - 4.7951 * albedo.rgb + 0.6417) * open + 2.7552 * albedo.rgb + 0.6903) * open);
    vec3 around = 0.5 * (ambient(blurred) + ambient(facing)) * lessOccluded;
    // Thin parts: attenuation of the light between its entry and this point.
    vec3 glow = exp(-thick / (3.0 * scatterLength)) * (skinAmount.x * 0.16 * open * open * smoothstep(0.30, 0.75, -nl));
#if defined(LAYER)
    // Light and shadow of a drop spread below it, in skin red furthest; where the key light hardly reaches there is neither.
    arriving *= mix(vec3(1.0), vec3(q.light), smoothstep(0.02, 0.5, nl) / (1.0 + scatterLength / 1.5e-3));
#endif
    matte = albedo.rgb * (arriving * 0.3183099 + around + glow * falling * vec3(1.0, 0.32, 0.2));
    float oily = 0.30 + 0.75 * region.r - 0.10 * region.g;
    oily = mix(oily, 0.05, region.b);
    oily = mix(oily, 1.0, region.a);
    float rough = mix(roughness, 0.36, 0.5 * region.r + 0.4 * region.a);
    f0 = vec3(0.028);
    vec3 glossLight = falling * lit;
    // Folds reflect their own other side; hair scatters instead of reflecting.
    float corner = open * open * (1.0 - 0.75 * region.b) / (1.0 + 0.006 * max(-curvature, 0.0));
    glossLight *= 1.0 - 0.75 * region.b;
    shine = twoLobes(facing, toEye, f0, rough, oily, variance, glossLight, corner);
    if (!gl_FrontFacing) {  // seen from within, beside an eye
        matte *= vec3(0.20, 0.06, 0.05);
        shine = vec3(0.0);
    }
#elif defined(EYE)
    shadeEye(uv, n, toEye, albedo.rgb, falling, lit, open, matte, shine);
#else
    vec3 mapped = texture(normalMap, uv).xyz * 2.0 - 1.0;
    // A mesh without uv has no directions along it. The least is a square that a float of any GPU holds.
    vec3 alongU = t.du * inversesqrt(max(dot(t.du, t.du), 1.0e-30)), alongV = t.dv * inversesqrt(max(dot(t.dv, t.dv), 1.0e-30));
    facing = normalize(n * max(mapped.z, 0.05) + alongU * mapped.x + alongV * mapped.y);
#if defined(LAYER)
    facing = normalize(facing - q.slope * (layerLook.x - 1.0));  // the liquid acts as a prism over the reflecting surface
#endif
#if defined(GLOW)
    open *= texture(occlusionMap, uv).r;
#endif
    vec4 rm = texture(roughnessMap, uv);
    float rough = roughness * rm.g, metal = metallic * rm.b;
    f0 = mix(vec3(0.04), albedo.rgb, metal);
    vec3 body = albedo.rgb * (1.0 - metal);
#if defined(WET)
    Wet w = wetnessAt(posWorld, facing, n, rough, metal);
    body = darkened(body, w);
#endif
    float reach = max(dot(facing, lamp), 0.0);
#if defined(LAYER)
    reach *= q.light;
#endif
    matte = body * (0.3183099 * reach * lit * falling + ambient(facing) * open);
#if defined(GLOW)
    matte += emission * texture(glowMap, uv).rgb;
#endif
    shine = gloss(facing, toEye, f0, max(rough, 0.05), 0.0, falling * lit, open);
#if defined(WET)
    matte = wetted(matte, shine, metal, w, toEye, falling * lit, open);
    shine = vec3(0.0);
#endif
#endif

#if defined(LAYER)
    // Light from the surface leaves through the liquid, whose specular reflection replaces that of the surface.
    if (q.wet > 0.0 || q.drop > 0.0) {
        float cover = max(q.wet, q.drop);
        float r0 = (layerLook.x - 1.0) / (layerLook.x + 1.0);
        r0 *= r0;
        vec3 film = n - q.slope;
#if defined(SKIN)
        film -= (slope + fine) * (1.1 * filled * (1.0 - q.drop));
#else
        film += (facing + q.slope * (layerLook.x - 1.0) - n) * (1.0 - q.drop);
#endif
        film = normalize(film);
        // The far side of a drop is hidden by the drop: its crest is seen instead.
        float least = clamp(dot(n, toEye), 0.02, 0.3), seen = dot(film, toEye);
        if (seen < least) film = normalize(film + toEye * (least - seen));
        float wetRough = mix(layerLook.z, layerLook.y, q.drop);
        vec3 wetShine = gloss(film, toEye, vec3(r0), wetRough, q.variance, falling * lit, mix(open * open, 1.0, 0.3 * q.drop));
        float out_ = 1.0 - (r0 + (1.0 - r0) * schlick(dot(film, toEye)));
        vec3 dimmed = matte * exp(-layerAbsorption.rgb * (2.0 * q.path)) * out_;
        matte = mix(matte, dimmed, cover);
        // Metal and glass keep their mirror under the liquid, dimmed by it; a dielectric's is lost to one of nearly its own index, under a
        // film by half: its coarser relief stands out of it.
        float kept = max(max(f0.r, f0.g), f0.b) > 0.1 ? out_ : mix(0.5, 0.15, q.drop);
        shine = mix(shine, shine * kept + wetShine, cover);
    }
#endif
#if defined(BLENDED)
    if (strand.x > 0.0) {
        shadeHair(dot(t.dv, t.dv) > 0.0 ? normalize(t.dv) : vec3(0.0, 1.0, 0.0), normalize(normalWorld), toEye, albedo.rgb, falling * lit, open, matte, shine);
        shine *= albedo.a;
    }
    colour = vec4(matte * albedo.a + shine, albedo.a);  // specular light is kept where the body is transparent
#if defined(LAYER)
    // A drop on a pane is a prism: what is behind is seen where the ray is bent to, at about the scene's own distance, or in the studio.
    float cover = max(q.wet, q.drop) * (1.0 - albedo.a);
    vec3 bent = normalize(q.slope * (layerLook.x - 1.0) - toEye);
    vec4 clip = frame.viewProjection * vec4(posWorld + bent * frame.floorFade.z, 1.0);
    vec2 there = clip.xy / max(clip.w, 1.0e-4) * 0.5 + 0.5;
    float shown = clip.w > 0.0 && all(equal(there, clamp(there, 0.0, 1.0))) ? 1.0 : 0.0;
    vec3 behind = mix(environment(bent, 0.05), textureLod(behindMap, there, 0.0).rgb, shown);
    colour += vec4(behind * exp(-layerAbsorption.rgb * q.path), 1.0) * cover;
#endif
#else
    colour = vec4(matte + shine, 1.0);
#endif
    if (cut) discard;
}
