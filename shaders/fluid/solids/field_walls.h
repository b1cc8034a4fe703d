// The walls of a field near a point, as planes, in the field's frame. Include after fluid/solids/near_walls.h and voxel/field.h.
// At an inner edge the distance belongs to the nearer wall only. The others are looked for along the nearer wall, in steps that cannot pass
// through a wall; a wall around an outer edge is not one: its plane is nearer to the point than the mesh is.
// Where two walls are equally near, to a voxel, the interpolant blends their distances: its gradient is no wall's normal, and may vanish.
STRUCT(FieldPoint) {
    vec3 x;          // m
    float distance;  // of x, m
    vec3 normal;     // at x
    bool lone;       // the normal is that of one flat wall
    float h;
    float reach;     // m
    float standOff;  // m, taken from the distances
};

// Looks for one more wall on the way from `start`, beginning at a step of half of `above`, m.
FN WallList lookAlong_(GLOBAL(float, bandDistance) FieldParams f, WallList list, FieldPoint p, vec3 start, vec3 way, float above) {
    float gone = 0.5f * above;
    for (int step_ = 0; step_ < 10 && gone < p.reach; ++step_) {
        vec3 there = start + way * gone;
        FieldSample s = fieldAt(PASS(bandDistance) f, there);
        gone += max(0.5f * s.distance, 0.5f * f.voxel);
        if (!loneWall(s) || !withinBand(f, s)) continue;
        vec3 m = fieldNormal(s);
        float d = s.distance + dot(m, p.x - there);
        if ((p.lone && dot(m, p.normal) > 0.9f) || d < p.distance - 0.02f * f.voxel) continue;
        // A wall that ends, or bends away, before it comes to the point does not act on it.
        FieldSample foot = fieldAt(PASS(bandDistance) f, p.x - m * d);
        if (foot.distance > 0.75f * f.voxel) continue;
        return addNearWall(list, m, d - p.standOff, 0.0f, p.h, p.reach);
    }
    return list;
}

FN WallList fieldWalls(GLOBAL(float, bandDistance) FieldParams f, vec3 x, float h, float reach, float standOff) {
    WallList found = noNearWalls(h);
    FieldSample here = fieldAt(PASS(bandDistance) f, x);
    if (!(here.distance - standOff < reach) || !withinBand(f, here)) return found;
    FieldPoint p;
    p.x = x;
    p.distance = here.distance;
    p.normal = fieldNormal(here);
    p.lone = loneWall(here);
    p.h = h;
    p.reach = reach;
    p.standOff = standOff;
    if (!(dot(p.normal, p.normal) > 0.0f)) {
        p.normal = fieldNormal(fieldAt(PASS(bandDistance) f, x + vec3(0.37f, 0.61f, -0.53f) * f.voxel));
        if (!(dot(p.normal, p.normal) > 0.0f)) return found;
    }
    vec3 n = p.normal;
    if (p.lone) found = addNearWall(found, n, p.distance - standOff, 0.0f, h, reach);
    vec3 axis = abs(n.y) < 0.7f ? vec3(0.0f, 1.0f, 0.0f) : vec3(1.0f, 0.0f, 0.0f);
    vec3 across = cross(n, axis);
    across = across * (1.0f / length(across));
    vec3 along = cross(n, across);
    // Nearer than three voxels to its wall, a way into an edge has no point at which another wall is nearest by a voxel.
    float clear = 3.0f * f.voxel;
    float above = max(clear, p.distance);
    vec3 start = x + n * (above - p.distance);
    for (int k = 0; k < 4; ++k) {
        vec3 way = k < 2 ? across : along;
        found = lookAlong_(PASS(bandDistance) f, found, p, start, (k & 1) != 0 ? way * (-1.0f) : way, above);
    }
    // Along an edge to a corner, clear of both walls.
    if (isWall(found.second, h) && !isWall(found.third, h)) {
        vec3 edge = cross(found.first.xyz, found.second.xyz);
        edge = edge * (1.0f / max(length(edge), 0.01f));
        float first = found.first.w + standOff;
        float second = found.second.w + standOff;
        start = x + found.first.xyz * max(clear - first, 0.0f) + found.second.xyz * max(clear - second, 0.0f);
        above = max(clear, first);
        found = lookAlong_(PASS(bandDistance) f, found, p, start, edge, above);
        found = lookAlong_(PASS(bandDistance) f, found, p, start, edge * (-1.0f), above);
    }
    if (p.lone) return found;
    // No flat wall, or not this one: the wall is curved.
    bool known = sameDirection_(found.first, n, h) || sameDirection_(found.second, n, h) || sameDirection_(found.third, n, h);
    bool blend = found.second.w < p.distance - standOff + f.voxel;
    if (!known && !blend) found = addNearWall(found, n, p.distance - standOff, 0.0f, h, reach);
    return found;
}
