// Reads the distance band in a kernel: interpolated distance and its gradient. Include after BUFFERS; the buffer is `bandDistance`.
// For a closed mesh it is negative inside; here only the absolute distance counts, on either side (fluid/voxel/README.md).
// Points are in metres, cell coordinates in voxels from the grid's low corner.
STRUCT(FieldSample) {
    vec3 gradient;   // of the trilinear interpolant: away from the mesh; length 1 near a single wall
    float distance;  // m, at most the band
    float bend;      // deviation of the cell's samples from a plane; 0 near a single flat wall, about 1 voxel / radius near a curved one
};

FN vec3 toCells(FieldParams f, vec3 p) { return (p - f.origin.xyz) * f.origin.w; }

// The index of the grid point nearest to `g` (cell coordinates), clamped to the border of the grid.
FN uint nearestPoint(FieldParams f, vec3 g) {
    uint x = TO_UINT(clamp(g.x + 0.5f, 0.0f, TO_FLOAT(f.sizeX)));
    uint y = TO_UINT(clamp(g.y + 0.5f, 0.0f, TO_FLOAT(f.sizeY)));
    uint z = TO_UINT(clamp(g.z + 0.5f, 0.0f, TO_FLOAT(f.sizeZ)));
    return (z * (TO_UINT(f.sizeY) + 1u) + y) * (TO_UINT(f.sizeX) + 1u) + x;
}

// Outside the grid the value at the border is used, which is the band's limit: the grid is padded by at least that width.
FN float sideOf_(float distance_, bool signed_) { return signed_ ? distance_ : abs(distance_); }
FN FieldSample sampleField_(GLOBAL(float, bandDistance) FieldParams f, vec3 p, bool signed_) {
    vec3 g = toCells(f, p);
    g = vec3(clamp(g.x, 0.0f, TO_FLOAT(f.sizeX)), clamp(g.y, 0.0f, TO_FLOAT(f.sizeY)), clamp(g.z, 0.0f, TO_FLOAT(f.sizeZ)));
    int cx = clamp(TO_INT(g.x), 0, f.sizeX - 1);
    int cy = clamp(TO_INT(g.y), 0, f.sizeY - 1);
    int cz = clamp(TO_INT(g.z), 0, f.sizeZ - 1);
    float x = g.x - TO_FLOAT(cx);
    float y = g.y - TO_FLOAT(cy);
    float z = g.z - TO_FLOAT(cz);
    uint row = TO_UINT(f.sizeX) + 1u;
    uint slab = row * (TO_UINT(f.sizeY) + 1u);
    uint at = TO_UINT(cz) * slab + TO_UINT(cy) * row + TO_UINT(cx);
    float d000 = sideOf_(bandDistance[at], signed_);
    float d100 = sideOf_(bandDistance[at + 1u], signed_);
    float d010 = sideOf_(bandDistance[at + row], signed_);
    float d110 = sideOf_(bandDistance[at + row + 1u], signed_);
    float d001 = sideOf_(bandDistance[at + slab], signed_);
    float d101 = sideOf_(bandDistance[at + slab + 1u], signed_);
    float d011 = sideOf_(bandDistance[at + slab + row], signed_);
    float d111 = sideOf_(bandDistance[at + slab + row + 1u], signed_);
    float e00 = d000 + (d100 - d000) * x;
    float e10 = d010 + (d110 - d010) * x;
    float e01 = d001 + (d101 - d001) * x;
    float e11 = d011 + (d111 - d011) * x;
    float low = e00 + (e10 - e00) * y;
    float high = e01 + (e11 - e01) * y;
    float alongX0 = (d100 - d000) + ((d110 - d010) - (d100 - d000)) * y;
    float alongX1 = (d101 - d001) + ((d111 - d011) - (d101 - d001)) * y;
    // The increase of the distance along an axis differs between the edges of the cell by:
    float bendXY = max(max((d110 - d010) - (d100 - d000), (d111 - d011) - (d101 - d001)),
                       max((d100 - d000) - (d110 - d010), (d101 - d001) - (d111 - d011)));
    float bendXZ = max(max((d101 - d001) - (d100 - d000), (d111 - d011) - (d110 - d010)),
                       max((d100 - d000) - (d101 - d001), (d110 - d010) - (d111 - d011)));
    float bendYZ = max(max((d011 - d001) - (d010 - d000), (d111 - d101) - (d110 - d100)),
                       max((d010 - d000) - (d011 - d001), (d110 - d100) - (d111 - d101)));
    FieldSample s;
    s.bend = max(max(bendXY, bendXZ), bendYZ) * f.origin.w;
    s.distance = low + (high - low) * z;
    s.gradient = vec3(alongX0 + (alongX1 - alongX0) * z, (e10 - e00) + ((e11 - e01) - (e10 - e00)) * z, high - low) * f.origin.w;
    return s;
}

FN FieldSample fieldAt(GLOBAL(float, bandDistance) FieldParams f, vec3 p) { return sampleField_(PASS(bandDistance) f, p, false); }
// The same with its sign: below 0 inside a closed mesh. For points that may be there.
FN FieldSample signedFieldAt(GLOBAL(float, bandDistance) FieldParams f, vec3 p) { return sampleField_(PASS(bandDistance) f, p, true); }

// Unit vector towards larger distance; zero where the field has no gradient (far away, or midway between two walls).
FN vec3 fieldNormal(FieldSample s) {
    float slope = length(s.gradient);
    return slope > 0.1f ? s.gradient * (1.0f / slope) : vec3(0.0f, 0.0f, 0.0f);
}

// False beyond the band, where the distance is only known to be at least the band: a wall has no effect there.
FN bool withinBand(FieldParams f, FieldSample s) { return s.distance < f.band; }

// False where walls meet and the interpolant blends their distances: then the gradient is not a normal of a wall.
FN bool loneWall(FieldSample s) {
    float square = dot(s.gradient, s.gradient);
    return s.bend < 0.15f && square > 0.9f && square < 1.1f;
}

// True if no point between `a` and `b` can be within contact distance of the mesh; reads one value. The distance changes by at most
// the length moved, so that the value of the nearest grid point minus the distance to it is a lower bound.
FN bool farFromField(GLOBAL(float, bandDistance) FieldParams f, vec3 a, vec3 b) {
    vec3 ga = toCells(f, a);
    vec3 gb = toCells(f, b);
    vec3 size = vec3(TO_FLOAT(f.sizeX), TO_FLOAT(f.sizeY), TO_FLOAT(f.sizeZ));
    if (max(ga.x, gb.x) < 0.0f || max(ga.y, gb.y) < 0.0f || max(ga.z, gb.z) < 0.0f) return true;
    if (min(ga.x, gb.x) > size.x || min(ga.y, gb.y) > size.y || min(ga.z, gb.z) > size.z) return true;
    vec3 g = vec3(clamp(ga.x, 0.0f, size.x), clamp(ga.y, 0.0f, size.y), clamp(ga.z, 0.0f, size.z));
    vec3 nearest = floor(g + vec3(0.5f, 0.5f, 0.5f));
    uint row = TO_UINT(f.sizeX) + 1u;
    uint slab = row * (TO_UINT(f.sizeY) + 1u);
    float there = abs(bandDistance[TO_UINT(nearest.z) * slab + TO_UINT(nearest.y) * row + TO_UINT(nearest.x)]);
    return there - length(g - nearest) * f.voxel > length(b - a) + f.contact;
}
