// A triangle in a map: positions on it are an affine function of UV. The fourth component of vec4 has no meaning (a CPU computes four at
// once).
STRUCT(MapSheet) {
    vec4 middle;  // m
    vec4 alongU;  // m per unit of u
    vec4 alongV;
    float u;  // of its centre; the map's u goes from 0 to 1
    float v;
};
// `word`: the word of a texel, see map_step.h.
FN MapSheet sheetOf(GLOBAL(vec4, chart) GLOBAL(vec4, basis) uint word) {
    uint t = word & TEXEL_TRIANGLE;
    vec4 slope = chart[2u * t];
    vec4 e1 = basis[5u * t + 1u];
    vec4 e2 = basis[5u * t + 2u];
    MapSheet s;
    s.middle = basis[5u * t] + (e1 + e2) * 0.33333333f;
    s.alongU = e1 * slope.x + e2 * slope.y;
    s.alongV = e1 * slope.z + e2 * slope.w;
    s.u = chart[2u * t + 1u].x + 1.0f - TO_FLOAT((word >> TEXEL_TURN_U) & 3u);
    s.v = chart[2u * t + 1u].y + 1.0f - TO_FLOAT((word >> TEXEL_TURN_V) & 3u);
    return s;
}
// m: the position of a texel; `inverse` is 1 / the edge of the map, a power of two.
FN vec4 sheetPlace(MapSheet s, float x, float y, float inverse) {
    return s.middle + s.alongU * ((x + 0.5f) * inverse - s.u) + s.alongV * ((y + 0.5f) * inverse - s.v);
}
FN float sheetInverse(MapSheet s) { return 1.0f / max(sqrt(dot(s.alongU.xyz, s.alongU.xyz)), 1.0e-15f); }  // units of u per metre
