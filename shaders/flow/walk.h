// A straight walk over a skin: along a line on a triangle, and across edges by unfolding the next triangle. Also the film's lattice in a
// triangle.
#if !defined(RIVULET_WALK_H)
#define RIVULET_WALK_H
#define MOST_EDGES 4096 /* in a step: an end for ways that are no number */
#define TRIANGLE_NORMAL(t) vec3(basis[5u * (t) + 1u].w, basis[5u * (t) + 2u].w, basis[5u * (t) + 3u].w)
STRUCT(SkinWalk) {
    vec3 v;  // a vector that is transported along and rotated with the skin
    uint triangle;
    float b1;  // barycentric coordinates of corners 1 and 2
    float b2;
    uint gone;  // 1: it crossed an open edge
};

// Rotates v about the edge with unit direction `u` from a triangle with normal `from` to one with normal `to`.
FN vec3 unfolded(vec3 v, vec3 u, vec3 from, vec3 to) { return u * dot(v, u) + cross(to, u) * dot(v, cross(from, u)); }
// The position of the point x along the edge from `a` by `e`, 0 to 1.
FN float alongEdge(vec3 x, vec3 a, vec3 e) { return min(max(dot(x - a, e) / max(dot(e, e), 1.0e-30f), 0.0f), 1.0f); }

// `way`: m, the displacement in the plane of the triangle of w.
FN SkinWalk walked(GLOBAL(uint, skin) GLOBAL(vec4, basis) SkinWalk w, vec3 way) {
    float rest = 1.0f;  // share of the way that is left
    for (int k = 0; k < MOST_EDGES; ++k) {
        vec3 e1 = basis[5u * w.triangle + 1u].xyz;
        vec3 e2 = basis[5u * w.triangle + 2u].xyz;
        float r1 = dot(basis[5u * w.triangle + 3u].xyz, way);
        float r2 = dot(basis[5u * w.triangle + 4u].xyz, way);
        float r0 = 0.0f - r1 - r2;
        float b0 = 1.0f - w.b1 - w.b2;
        float go = rest;
        uint edge = 3u;
        if (r2 < 0.0f && w.b2 <= go * -r2) {
            go = max(w.b2, 0.0f) / -r2;
            edge = 0u;
        }
        if (r0 < 0.0f && b0 <= go * -r0) {
            go = max(b0, 0.0f) / -r0;
            edge = 1u;
        }
        if (r1 < 0.0f && w.b1 <= go * -r1) {
            go = max(w.b1, 0.0f) / -r1;
            edge = 2u;
        }
        w.b1 = w.b1 + r1 * go;
        w.b2 = w.b2 + r2 * go;
        rest = rest - go;
        if (edge == 3u) return w;
        vec3 from = TRIANGLE_NORMAL(w.triangle);
        // Crosses the edge, and triangles without area, on which no distance is covered.
        for (int flat_ = 0; flat_ < 16; ++flat_) {
            float s = edge == 0u ? w.b1 : edge == 1u ? w.b2 : 1.0f - w.b1 - w.b2;
            s = min(max(s, 0.0f), 1.0f);
            uint across = skin[SKIN_UINTS * w.triangle + 3u + edge];
            if (across == SKIN_OPEN) {
                w.gone = 1u;
                return w;
            }
            vec3 u = edge == 0u ? e1 : edge == 1u ? e2 - e1 : e2 * -1.0f;
            w.triangle = across >> 2u;
            edge = across & 3u;
            w.b1 = edge == 0u ? 1.0f - s : edge == 1u ? s : 0.0f;
            w.b2 = edge == 1u ? 1.0f - s : edge == 2u ? s : 0.0f;
            if (basis[5u * w.triangle + 4u].w < 0.5f) {
                u = u * (1.0f / max(sqrt(dot(u, u)), 1.0e-30f));
                vec3 to = TRIANGLE_NORMAL(w.triangle);
                way = unfolded(way, u, from, to);
                w.v = unfolded(w.v, u, from, to);
                break;
            }
            // Leaves by the edge that is nearest to the point of entry.
            e1 = basis[5u * w.triangle + 1u].xyz;
            e2 = basis[5u * w.triangle + 2u].xyz;
            vec3 x = e1 * w.b1 + e2 * w.b2;
            uint came = edge;
            float nearest = 1.0e30f;
            for (uint other = 0u; other < 3u; ++other) {
                if (other == came) continue;
                vec3 a = other == 0u ? vec3(0.0f, 0.0f, 0.0f) : other == 1u ? e1 : e2;
                vec3 e = other == 0u ? e1 : other == 1u ? e2 - e1 : e2 * -1.0f;
                float share = alongEdge(x, a, e);
                vec3 apart = a + e * share - x;
                float d = dot(apart, apart);
                if (d < nearest) {
                    nearest = d;
                    edge = other;
                    w.b1 = other == 0u ? share : other == 1u ? 1.0f - share : 0.0f;
                    w.b2 = other == 0u ? 0.0f : other == 1u ? share : 1.0f - share;
                }
            }
        }
    }
    return w;
}

// The cell of the triangle's lattice that contains a point: n rows along edge 0->1, n^2 cells of equal area.
FN uint latticeCell(float b1, float b2, uint n) {
    float x = min(max(b1, 0.0f), 1.0f) * TO_FLOAT(n);
    float y = min(max(b2, 0.0f), 1.0f) * TO_FLOAT(n);
    uint i = min(TO_UINT(x), n - 1u);
    uint j = min(TO_UINT(y), n - 1u - i);
    uint upper = x - TO_FLOAT(i) + y - TO_FLOAT(j) > 1.0f && i + j + 1u < n ? 1u : 0u;
    return i * (2u * n - i) + 2u * j + upper;
}
FN uint filmCell(GLOBAL(uint, skin) uint t, float b1, float b2) {
    return skin[SKIN_UINTS * t + 6u] + latticeCell(b1, b2, skin[SKIN_UINTS * t + 7u]);
}
#endif
