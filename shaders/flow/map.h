// Where a texel lies in space: an affine map from UV on each triangle. `x`, `y`: texels of the map, of which `inverse` is one over the edge, a
// power of two; `word`: the texel's first.
FN vec3 texelPlace(GLOBAL(vec4, frame) uint word, float x, float y, float inverse) {
    uint at = 4u * (word & TEXEL_TRIANGLE);
    float u = (x + 0.5f) * inverse + TO_FLOAT((word >> TEXEL_TURN_U) & 3u) - 1.0f - frame[at].w;
    float v = (y + 0.5f) * inverse + TO_FLOAT((word >> TEXEL_TURN_V) & 3u) - 1.0f - frame[at + 1u].w;
    return frame[at].xyz + frame[at + 1u].xyz * u + frame[at + 2u].xyz * v;
}
