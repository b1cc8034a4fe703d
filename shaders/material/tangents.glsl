// The uv frame of a surface: the dual basis of dP/du and dP/dv in the tangent plane, from screen-space derivatives.
struct Tangents {
    vec3 normal;    // unit, world
    vec3 du, dv;    // 1/m: dot(du, step in the world) is the step in u
    float lod;      // mip level for a texture of 1 texel; one of n texels adds log2(n)
    float footprint;  // m, width of a pixel on the surface
};

Tangents tangentsAt(vec3 posWorld, vec2 uv, vec3 normal) {
    vec3 px = dFdx(posWorld), py = dFdy(posWorld);
    vec2 ux = dFdx(uv), uy = dFdy(uv);
    float det = ux.x * uy.y - uy.x * ux.y;
    float inverse = abs(det) > 1.0e-20 ? 1.0 / det : 0.0;
    vec3 t = (px * uy.y - py * ux.y) * inverse, b = (py * ux.x - px * uy.x) * inverse;
    vec3 du = cross(b, normal), dv = cross(normal, t);
    float along = dot(t, du);
    float share = abs(along) > 1.0e-12 ? 1.0 / along : 0.0;
    const float kMost = 1.0e4;  // 1/m: bound for triangles that are degenerate in space or in uv
    share *= min(1.0, kMost / max(abs(share) * sqrt(max(dot(du, du), dot(dv, dv))), 1.0e-9));
    float size = max(dot(ux, ux), dot(uy, uy));
    return Tangents(normal, du * share, dv * share, 0.5 * log2(max(size, 1.0e-20)), sqrt(max(dot(px, px), dot(py, py))));
}
vec2 uvStep(Tangents t, vec3 stepWorld) { return vec2(dot(t.du, stepWorld), dot(t.dv, stepWorld)); }
// The slope vector of a height with slopes x (m per unit of u) and y (of v).
vec3 gradient(Tangents t, vec2 slopes) { return slopes.x * t.du + slopes.y * t.dv; }
vec4 look(sampler2D map, vec2 uv, Tangents t, float sizeLod) { return textureLod(map, uv, t.lod + sizeLod); }
