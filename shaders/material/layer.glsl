// A liquid on a surface: the point where the eye ray enters it, the refracted point on the surface, and the light below. Heights in m.
// Needs tangents.glsl and frame.glsl. Drawn over the dry surface where the mesh is wet: see mesh.vert.
uniform sampler2D layerMap;     // x, y slope (m per unit of u, v), z height (mm), w wetness 0..1
uniform vec4 layerLook;         // refractive index, roughness of a drop, roughness of a wet surface, darkening
uniform vec4 layerAbsorption;   // 1/m; w: scale of heights

struct Liquid {
    float wet;       // 0..1
    float drop;      // 0..1: a film .. a drop
    vec2 uvBelow;    // the point of the surface seen through the liquid
    vec3 slope;      // of the liquid's surface, as a vector in the tangent plane
    float path;      // m, through the liquid to that point
    float light;     // light at that point relative to a dry one: focused or shaded
    float variance;  // of slopes within a pixel
    float film;      // m, thickness of a film as it is drawn
};

vec4 liquidTexel(vec2 uv, float lod) { return textureLod(layerMap, uv, lod) * vec4(layerAbsorption.www, 1.0); }

// Roughness of a surface, -1..1, with features `size` m wide, whatever the scale of its uv; yzw: its slope, 1/m, in the tangent plane.
// Features of less than two pixels fade out.
vec4 roughnessAt(Tangents t, vec2 uv, float size) {
    float level = -log2(size * sqrt(0.5 * (dot(t.du, t.du) + dot(t.dv, t.dv)))), scale = exp2(floor(level)), share = fract(level);
    const mat2 kTurn = mat2(0.79, 0.61, -0.61, 0.79);  // the lattice of the noise is not along the uv, as many trails are
    vec2 at = kTurn * uv;
    vec4 a = noise(vec3(at * scale, 0.5)), b = noise(vec3(at * 2.0 * scale, 7.5));
    float seen = 1.0 - smoothstep(0.25, 0.5, t.footprint / size);
    return seen * vec4(mix(a.x, b.x, share), gradient(t, mix(a.yz, 2.0 * b.yz, share) * kTurn * scale));
}

// A film is not flat: it is a cushion, higher in its middle than at its edge, which a map with heights of 10 um and texels of 0.3 mm does
// not resolve. The slope of one of height 1, from the gradient of the wetness over `size` m; `around`: its mean there.
vec3 cushion(Tangents t, vec2 uv, float lod, float size, out float around) {
    float texels = float(textureSize(layerMap, 0).x);
    float wide = max(log2(size * texels * sqrt(0.5 * (dot(t.du, t.du) + dot(t.dv, t.dv)))), lod);
    float e = 0.5 * exp2(wide) / texels;
    float l = textureLod(layerMap, uv - vec2(e, 0.0), wide).w, r = textureLod(layerMap, uv + vec2(e, 0.0), wide).w;
    float d = textureLod(layerMap, uv - vec2(0.0, e), wide).w, u = textureLod(layerMap, uv + vec2(0.0, e), wide).w;
    around = 0.25 * (l + r + d + u);
    return gradient(t, vec2(r - l, u - d) * (0.5 / e));
}

// The slope of a film's surface. A trail is as wide as the wetness says, but its edge is held by pores and fine hairs, and where it is
// thin, tension draws it into beads (Plateau and Rayleigh). `wet`: 0..1; what the map says becomes what is left of it. `high`: m, of its
// surface.
vec3 filmAt(Tangents t, vec2 uv, float lod, inout float wet, out float high) {
    const float kReach = 1.5e-3;  // m, how far an edge may move
    const float kHigh = 3.2e-4;   // m, of a cushion
    float around;
    vec3 slope = cushion(t, uv, lod, kReach, around);
    vec4 bead = roughnessAt(t, uv, 5.0e-3), mid = roughnessAt(t, uv, 2.2e-3), pore = roughnessAt(t, uv, 0.7e-3);
    // As it dries, it breaks up. Where all around is wet, nothing pulls at it.
    float loose = mix(1.5, 0.75, smoothstep(0.3, 0.8, wet)) * (1.0 - 0.5 * smoothstep(0.85, 1.0, around));
    vec4 hold = loose * (0.62 * bead + 0.3 * mid + 0.12 * pore);
    const float kFrom = 0.42, kTo = 0.76;
    float x = clamp((around * (1.0 + hold.x) - kFrom) / (kTo - kFrom), 0.0, 1.0);
    float steep = 2.0 * (1.0 - x) / (kTo - kFrom) * (x > 0.0 ? 1.0 : 0.0);
    slope = slope * (1.0 + hold.x) + around * hold.yzw;
    float part = x * (2.0 - x), fat = 0.85 + 0.5 * bead.x;
    wet = smoothstep(0.0, 0.25, x) * min(wet * 3.0, 1.0);
    high = kHigh * part * fat;
    return kHigh * (slope * steep * fat + part * 0.5 * bead.yzw);
}

Liquid liquidAt(Tangents t, vec2 uv, vec3 toEye) {
    Liquid dry = Liquid(0.0, 0.0, uv, vec3(0.0), 0.0, 1.0, 0.0, 0.0);
    float lod = max(t.lod + log2(float(textureSize(layerMap, 0).x)), 0.0);
    vec4 around = liquidTexel(uv, max(lod, 3.5));
    if (around.z < 1.0e-5 && around.w < 1.0e-3) return dry;

    // Marches along the ray from the maximum height until it is below the liquid's surface.
    float cosine = max(dot(t.normal, toEye), 0.2);
    vec2 climb = uvStep(t, toEye) / cosine;  // change of uv per metre of height
    vec2 top = uv;
    vec4 here = liquidTexel(uv, lod);
    if (lod < 3.0) {
        float high = min(1.0e-3 * max(7.0 * around.z, here.z), 2.5e-3), before = 0.0;
        float at = high, step_ = high / 5.0;
        for (int k = 0; k < 5; ++k) {
            vec4 l = liquidTexel(uv + climb * at, lod);
            float above = at - 1.0e-3 * l.z;
            if (above <= 0.0) {
                float back = before > 0.0 ? step_ * above / (above - before) : 0.0;  // intersection of the two heights
                top = uv + climb * (at + max(back, 0.0));
                here = liquidTexel(top, lod);
                break;
            }
            before = above;
            at -= step_;
            if (k == 4) here = liquidTexel(uv, lod);
        }
    }
    Liquid q = dry;
    q.wet = clamp(here.w, 0.0, 1.0);
    q.drop = smoothstep(0.02, 0.12, here.z);
    q.slope = gradient(t, here.xy);
    float steep = length(q.slope);
    q.slope *= min(1.0, 2.5 / max(steep, 1.0e-6));
    vec3 n = normalize(t.normal - q.slope);
    vec3 bent = refract(-toEye, n, 1.0 / layerLook.x);
    float down = max(-dot(bent, t.normal), 0.25), height = 1.0e-3 * here.z;
    q.uvBelow = top + uvStep(t, bent) * (height / down);
    q.path = height / down;

    // The light enters nearer to the lamp: where the surface rises towards the lamp, at a drop's far side, it is focused.
    vec3 lamp = frame.lightDir.xyz, across = lamp - t.normal * dot(lamp, t.normal);
    float sun = max(dot(lamp, t.normal), 0.15);
    vec3 bentLight = refract(-lamp, t.normal, 1.0 / layerLook.x);
    vec4 entry = liquidTexel(q.uvBelow - uvStep(t, bentLight) * (height / max(-dot(bentLight, t.normal), 0.3)), lod);
    float toLamp = dot(gradient(t, entry.xy), across);
    toLamp /= max(sun, 0.4);
    q.light = clamp(1.0 + q.drop * (1.5 * toLamp + 2.2 * max(toLamp, 0.0) * max(toLamp, 0.0)), 0.35, 3.2);
    // At its edge a drop reflects light internally; it casts a shadow on the side away from the lamp.
    q.light *= 1.0 - 0.25 * smoothstep(0.25, 0.6, steep) * (1.0 - smoothstep(0.03, 0.14, here.z));
    const float kShade = 1.5e-4;
    float over = 1.0e-3 * liquidTexel(uv + uvStep(t, across) * (kShade / sun), lod).z - kShade;
    q.light *= 1.0 - 0.6 * (1.0 - q.drop) * smoothstep(0.0, 2.0e-4, over);
    if (q.drop < 1.0 && lod < 4.0) {
        float film = q.wet;
        vec3 slope = filmAt(t, uv, lod, film, q.film);
        q.slope += (1.0 - q.drop) * slope;
        // A facet that faces the lamp gets more of its light. The film is too thin to move that light aside.
        q.light *= clamp(1.0 - (1.0 - q.drop) * dot(slope, across) / max(sun, 0.35), 0.3, 1.8);
        q.wet = mix(film, q.wet, q.drop);
    }
    q.variance = 0.10 * q.drop * smoothstep(3.0e-4, 1.5e-3, t.footprint);
    return q;
}
