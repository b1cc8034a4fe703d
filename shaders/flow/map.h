// Where a texel's place is on its triangle: an affine map from UV, which the skin's motion leaves as it is.
STRUCT(SkinTexel) {
    float b1;  // barycentric, of corners 1 and 2; beyond 0 to 1 in a chart's gutter
    float b2;
};
// `x`, `y`: texels of the map; `word`: the texel's first.
FN SkinTexel texelAt(GLOBAL(vec4, chart) uint word, float x, float y, float size) {
    uint t = word & TEXEL_TRIANGLE;
    vec4 slope = chart[2u * t];
    vec4 middle = chart[2u * t + 1u];
    float inverse = 1.0f / size;  // of a power of two: exact
    float u = (x + 0.5f) * inverse + TO_FLOAT((word >> TEXEL_TURN_U) & 3u) - 1.0f - middle.x;
    float v = (y + 0.5f) * inverse + TO_FLOAT((word >> TEXEL_TURN_V) & 3u) - 1.0f - middle.y;
    SkinTexel s;
    s.b1 = 0.33333333f + slope.x * u + slope.z * v;
    s.b2 = 0.33333333f + slope.y * u + slope.w * v;
    return s;
}
