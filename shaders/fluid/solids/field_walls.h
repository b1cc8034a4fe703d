// The walls of a field near a point, as planes, in the field's frame. Include after fluid/solids/near_walls.h and voxel/field.h.
// At an inner edge the distance belongs to the nearer wall only. The others are looked for along the nearer wall, in steps that cannot pass
// through a wall; a wall around an outer edge is not one: its plane is nearer to the point than the mesh is. standOff: m, taken from the distances.
FN WallList fieldWalls(GLOBAL(float, bandDistance) FieldParams f, vec3 x, float h, float reach, float standOff) {
    WallList found = noNearWalls(h);
    // A solver's corrections may push a particle into a closed mesh: it is then at the wall, on the side of the fluid.
    FieldSample here = signedFieldAt(PASS(bandDistance) f, x);
    vec3 n = fieldNormal(here);
    if (!(here.distance - standOff < reach) || !(dot(n, n) > 0.0f)) return found;
    // At an inner edge the interpolated distance blends two walls, and its gradient is short.
    bool oneWall = dot(here.gradient, here.gradient) > 0.95f;
    if (oneWall) found = addNearWall(found, n, here.distance - standOff, 0.0f, h, reach);
    vec3 axis = abs(n.y) < 0.7f ? vec3(0.0f, 1.0f, 0.0f) : vec3(1.0f, 0.0f, 0.0f);
    vec3 across = cross(n, axis);
    across = across * (1.0f / length(across));
    vec3 along = cross(n, across);
    for (int k = 0; k < 4; ++k) {
        vec3 way = k < 2 ? across : along;
        if ((k & 1) != 0) way = way * (-1.0f);
        float gone = max(0.9f * here.distance, 0.05f * h);
        for (int step_ = 0; step_ < 6 && gone < reach; ++step_) {
            vec3 there = x + way * gone;
            FieldSample s = fieldAt(PASS(bandDistance) f, there);
            gone += max(0.9f * s.distance, 0.05f * h);
            if (!loneWall(s)) continue;
            vec3 m = fieldNormal(s);
            float d = s.distance + dot(m, x - there);
            if ((oneWall && dot(m, n) > 0.9f) || d < here.distance - 0.02f * f.voxel) continue;
            found = addNearWall(found, m, d - standOff, 0.0f, h, reach);
            break;
        }
    }
    // No flat wall was found: the plane of the nearest point.
    if (!(found.first.w < h)) found = addNearWall(found, n, here.distance - standOff, 0.0f, h, reach);
    return found;
}
