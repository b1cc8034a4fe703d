// What a texel shows of a drop and of the film, for the kernels that draw maps. After half.h.

// A drop. Ahead of the widest line of its foot a half circle of half the width w: h = H (1 - r^2 / w^2). Behind, at a share t of the tail's
// length, h = H (q(t) - y^2 / w^2) with q = 1 + a t^2 + b t^3 + c t^4, so that the foot is sqrt(q) times as wide: an ellipse for q = 1 -
// t^2; a corner for a double root at t = 1, where q = (1 - t)^2 (1 + 2 t + c t^2); a cusp for a triple one.
STRUCT(DrawnDrop) {
    vec3 meet;  // m, the middle of the widest line
    vec3 way;   // unit vector ahead
    float inverseWide2;
    float inverseLong;  // 1/m
    float push;         // m, half the square of the width over the length
    float a;
    float b;
    float c;
    float high;   // m
    float fall;   // 1/m
    float crisp;  // m, half of half its width
};
FN DrawnDrop drawnDrop(vec4 ball, vec4 shape, vec4 back) {
    float off = sqrt(dot(shape.xyz, shape.xyz));
    float wide = max(ball.w * (1.0f - off), 1.0e-10f);
    DrawnDrop d;
    d.meet = ball.xyz + shape.xyz * ball.w;
    d.way = shape.xyz * (1.0f / max(off, 1.0e-12f));
    d.inverseWide2 = 1.0f / (wide * wide);
    d.inverseLong = 1.0f / max(ball.w * (1.0f + off), 1.0e-10f);
    d.push = 0.5f * wide * wide * d.inverseLong;
    d.a = back.x;
    d.b = back.y;
    d.c = back.z;
    d.high = shape.w;
    d.fall = 2.0f * shape.w * d.inverseWide2;
    d.crisp = 0.5f * wide;
    return d;
}
// m, how far behind the widest line.
FN float dropBehind(DrawnDrop d, float dx, float dy, float dz) { return max0(-(dx * d.way.x + dy * d.way.y + dz * d.way.z)); }
// Share of the drop's height.
FN float dropShare(DrawnDrop d, float dx, float dy, float dz, float behind) {
    float t = min(behind * d.inverseLong, 1.0f);
    float q = 1.0f + t * t * (d.a + t * (d.b + t * d.c));
    return max0(q - (dx * dx + dy * dy + dz * dz - behind * behind) * d.inverseWide2);
}
// The slope, per `fall`: against the way from the middle of the widest line, and this much (m) along the drop's way.
FN float dropAlong(DrawnDrop d, float behind) {
    float t = min(behind * d.inverseLong, 1.0f);
    return behind + t * (2.0f * d.a + t * (3.0f * d.b + t * 4.0f * d.c)) * d.push;
}
// Share of a texel that the drop covers. `perMetre`: texels.
FN float dropCover(DrawnDrop d, float share, float perMetre) { return min(share * d.crisp * perMetre, 1.0f); }

// Whether a straight walk over the skin from the middle of triangle t towards `to` ends within `close` of it; else it is other skin nearby,
// for example the other lip. All texels of a triangle ask from its middle, and so get one answer.
FN bool reaches(GLOBAL(uint, skin) GLOBAL(vec4, basis) uint t, vec3 to, float close) {
    SkinWalk w;
    w.triangle = t;
    w.b1 = 0.33333333f;
    w.b2 = 0.33333333f;
    w.v = vec3(0.0f, 0.0f, 0.0f);
    w.gone = 0u;
    for (int k = 0; k < 4; ++k) {
        vec3 x = basis[5u * w.triangle].xyz + basis[5u * w.triangle + 1u].xyz * w.b1 + basis[5u * w.triangle + 2u].xyz * w.b2;
        vec3 d = to - x;
        float far = dot(d, d);
        if (far < close * close) return true;
        vec3 n = TRIANGLE_NORMAL(w.triangle);
        vec3 way = d - n * dot(d, n);
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
