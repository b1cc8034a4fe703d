// Traverses every voxel that a segment touches (Amanatides and Woo 1987), robust against rounding. Include after BUFFERS;
// the buffer is `surfaceBits`.
// Every voxel that a segment touches contains an end of the segment or a point where it crosses a plane between voxels.
// So the traversal goes from crossing to crossing, each computed from the start of the segment, and tests all voxels
// within `nudge` of it: usually two, four at an edge, eight at a corner. Ties, grazing along a face and boundaries need no special case.

// Voxels outside the grid are not set.
FN bool voxelSet(GLOBAL(uint, surfaceBits) FieldParams f, int x, int y, int z) {
    if (x < 0 || y < 0 || z < 0 || x >= f.sizeX || y >= f.sizeY || z >= f.sizeZ) return false;
    uint k = (TO_UINT(z) * TO_UINT(f.sizeY) + TO_UINT(y)) * TO_UINT(f.sizeX) + TO_UINT(x);
    return ((surfaceBits[k >> 5u] >> (k & 31u)) & 1u) != 0u;
}

// `p` in cell coordinates.
FN bool setVoxelNear(GLOBAL(uint, surfaceBits) FieldParams f, vec3 p) {
    int x0 = TO_INT(floor(p.x - f.nudge));
    int y0 = TO_INT(floor(p.y - f.nudge));
    int z0 = TO_INT(floor(p.z - f.nudge));
    int x1 = TO_INT(floor(p.x + f.nudge));
    int y1 = TO_INT(floor(p.y + f.nudge));
    int z1 = TO_INT(floor(p.z + f.nudge));
    bool any = false;
    for (int z = z0; z <= z1; ++z)
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x) any = any || voxelSet(PASS(surfaceBits) f, x, y, z);
    return any;
}

// From `a` to `b`, cell coordinates, within a million voxels of the grid. Returns the fraction of the way at which the first
// set voxel is touched, 0 if `a` touches one already; 2 if none is touched. Without motion only the voxels at `a` are tested.
FN float walkVoxels(GLOBAL(uint, surfaceBits) FieldParams f, vec3 a, vec3 b) {
    if (setVoxelNear(PASS(surfaceBits) f, a)) return 0.0f;
    vec3 d = b - a;
    // The next plane to cross along each axis, and how many there are.
    vec3 fromCell = floor(a);
    vec3 toCell = floor(b);
    float stepX = d.x > 0.0f ? 1.0f : -1.0f;
    float stepY = d.y > 0.0f ? 1.0f : -1.0f;
    float stepZ = d.z > 0.0f ? 1.0f : -1.0f;
    float planeX = d.x > 0.0f ? fromCell.x + 1.0f : fromCell.x;
    float planeY = d.y > 0.0f ? fromCell.y + 1.0f : fromCell.y;
    float planeZ = d.z > 0.0f ? fromCell.z + 1.0f : fromCell.z;
    int leftX = TO_INT((toCell.x - fromCell.x) * stepX);
    int leftY = TO_INT((toCell.y - fromCell.y) * stepY);
    int leftZ = TO_INT((toCell.z - fromCell.z) * stepZ);
    float perX = leftX > 0 ? 1.0f / d.x : 0.0f;
    float perY = leftY > 0 ? 1.0f / d.y : 0.0f;
    float perZ = leftZ > 0 ? 1.0f / d.z : 0.0f;
    int crossings = leftX + leftY + leftZ;
    for (int k = 0; k < crossings; ++k) {
        float tx = leftX > 0 ? min(1.0f, (planeX - a.x) * perX) : 2.0f;
        float ty = leftY > 0 ? min(1.0f, (planeY - a.y) * perY) : 2.0f;
        float tz = leftZ > 0 ? min(1.0f, (planeZ - a.z) * perZ) : 2.0f;
        bool alongX = leftX > 0 && tx <= ty && tx <= tz;
        bool alongY = !alongX && leftY > 0 && ty <= tz;
        float t = alongX ? tx : (alongY ? ty : tz);
        vec3 p = a + d * t;
        if (alongX) {
            p.x = planeX;
            planeX += stepX;
            leftX -= 1;
        } else if (alongY) {
            p.y = planeY;
            planeY += stepY;
            leftY -= 1;
        } else {
            p.z = planeZ;
            planeZ += stepZ;
            leftZ -= 1;
        }
        if (setVoxelNear(PASS(surfaceBits) f, p)) return t;
    }
    return setVoxelNear(PASS(surfaceBits) f, b) ? 1.0f : 2.0f;
}
