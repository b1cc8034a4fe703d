// What a texel shows of a drop and of the film, for the kernels that draw maps. After half.h.
STRUCT(DrawnDrop) {
    vec3 meet;          // m, where its halves meet
    vec3 tail;          // along its way; distances behind the line are scaled by the length of the tail
    float inverseWide2;
    float high;         // m
    float fall;         // 1/m
    float crisp;        // m, half of half its width
};
FN DrawnDrop drawnDrop(vec4 ball, vec4 shape) {
    float off = sqrt(dot(shape.xyz, shape.xyz));
    float wide = ball.w * (1.0f - off);
    DrawnDrop d;
    d.meet = ball.xyz + shape.xyz * ball.w;
    d.tail = shape.xyz * (2.0f / ((1.0f + off) * sqrt(max(off, 1.0e-12f))));
    d.inverseWide2 = 1.0f / max(wide * wide, 1.0e-20f);
    d.high = shape.w;
    d.fall = 2.0f * shape.w * d.inverseWide2;
    d.crisp = 0.5f * wide;
    return d;
}
// How far behind the line where the halves meet, scaled.
FN float dropBehind(DrawnDrop d, float dx, float dy, float dz) { return max0(-(dx * d.tail.x + dy * d.tail.y + dz * d.tail.z)); }
// Share of the drop's height.
FN float dropShare(DrawnDrop d, float dx, float dy, float dz, float behind) {
    return max0(1.0f - (dx * dx + dy * dy + dz * dz - behind * behind) * d.inverseWide2);
}
// Share of a texel that the drop covers. `perMetre`: texels.
FN float dropCover(DrawnDrop d, float share, float perMetre) { return min(share * d.crisp * perMetre, 1.0f); }

// Whether a straight walk over the skin from the middle of triangle t towards `to` ends within `close` of it; else it is other skin nearby, for
// example the other lip. All texels of a triangle ask from its middle, and so get one answer.
FN bool reaches(GLOBAL(uint, skin) GLOBAL(vec4, basis) uint t, vec3 to, float close) {
    SkinWalk w;
    w.triangle = t;
    w.b1 = 0.33333333f;
    w.b2 = 0.33333333f;
    w.n = TRIANGLE_NORMAL(t);
    w.v = vec3(0.0f, 0.0f, 0.0f);
    w.gone = 0u;
    for (int k = 0; k < 4; ++k) {
        vec3 x = basis[5u * w.triangle].xyz + basis[5u * w.triangle + 1u].xyz * w.b1 + basis[5u * w.triangle + 2u].xyz * w.b2;
        vec3 d = to - x;
        float far = dot(d, d);
        if (far < close * close) return true;
        vec3 way = d - w.n * dot(d, w.n);
        float along = dot(way, way);
        if (along < 0.01f * far) return false;  // straight above or below
        // The distance itself, not its projection on this triangle: the walk continues over edges.
        w = walked(PASS(skin) PASS(basis) w, way * sqrt(far / along));
        if (w.gone > 0u) return false;
    }
    return false;
}

// Three points at 120 degrees, the first along u: the film's slope is that of the plane through them.
FN float filmAlong(float film0, float film1, float film2, float per) { return (film0 - 0.5f * (film1 + film2)) * per; }
FN float filmAside(float film1, float film2, float per) { return (film1 - film2) * (0.8660254f * per); }
FN float wetness(float film, float invTrail, float under) {
    float full = min(film * invTrail, 1.0f);
    return max(full * (2.0f - full), min(under, 1.0f));
}
