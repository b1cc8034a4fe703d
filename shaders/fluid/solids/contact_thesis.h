// The thesis's collision with voxels (thesis 4.3), kept as the baseline: one rounded sample per step of the longest axis, which misses
// walls at their corners; normals from smoothed voxels (24)(25), which are as uneven as the voxels; the velocity into the wall is removed
// (26); the particle moves back by one voxel along its path. Include after fluid/solids/contact.h.
#define THESIS_BACK 1.0f  // voxels
#define THESIS_REACH 3    // voxels, h of the spiky kernel

// As walkVoxels, with the samples of the thesis.
FN float walkThesis(GLOBAL(uint, surfaceBits) FieldParams f, vec3 a, vec3 b) {
    vec3 d = b - a;
    float longest = max(max(abs(d.x), abs(d.y)), abs(d.z));
    int steps = TO_INT(floor(longest + 0.5f));
    float share = steps > 0 ? 1.0f / TO_FLOAT(steps) : 0.0f;
    for (int i = 0; i <= steps; ++i) {
        vec3 p = a + d * (TO_FLOAT(i) * share);
        if (voxelSet(PASS(surfaceBits) f, TO_INT(floor(p.x)), TO_INT(floor(p.y)), TO_INT(floor(p.z)))) return TO_FLOAT(i) * share;
    }
    return 2.0f;
}

// (24)(25): the gradient of the voxels' density with the spiky kernel, pointing into the fluid. Zero where voxels are all around.
FN vec3 thesisNormal(GLOBAL(uint, surfaceBits) FieldParams f, vec3 p) {
    vec3 n = vec3(0.0f, 0.0f, 0.0f);
    int x0 = TO_INT(floor(p.x));
    int y0 = TO_INT(floor(p.y));
    int z0 = TO_INT(floor(p.z));
    float h = TO_FLOAT(THESIS_REACH);
    for (int z = z0 - THESIS_REACH; z <= z0 + THESIS_REACH; ++z)
        for (int y = y0 - THESIS_REACH; y <= y0 + THESIS_REACH; ++y)
            for (int x = x0 - THESIS_REACH; x <= x0 + THESIS_REACH; ++x) {
                if (!voxelSet(PASS(surfaceBits) f, x, y, z)) continue;
                vec3 r = p - vec3(TO_FLOAT(x) + 0.5f, TO_FLOAT(y) + 0.5f, TO_FLOAT(z) + 0.5f);
                float distance_ = length(r);
                if (distance_ > 0.0f && distance_ < h) n = n + r * ((h - distance_) * (h - distance_) / distance_);
            }
    float size = length(n);
    return size > 0.0f ? n * (1.0f / size) : n;
}

FN Slid meetThesis(GLOBAL(uint, surfaceBits) GLOBAL(float, bandDistance) GLOBAL(uint, bandNormal) FieldParams f, vec3 start, vec3 end,
                   vec3 velocity) {
    Slid s;
    s.position = end;
    s.velocity = velocity;
    s.touched = false;
    vec3 a = toCells(f, start);
    vec3 b = toCells(f, end);
    float enters = enterGrid(f, a, b - a);
    if (enters > 1.0f) return s;
    a = a + (b - a) * enters;
    float hit = walkThesis(PASS(surfaceBits) f, a, b);
    if (hit > 1.0f) return s;
    vec3 d = b - a;
    float size = length(d);
    vec3 at = a + d * hit;
    if (size > 0.0f) at = at - d * (THESIS_BACK / size);
    s.touched = true;
    s.velocity = respond(velocity, thesisNormal(PASS(surfaceBits) f, at), 0.0f, 0.0f);
    s.position = f.origin.xyz + at * f.voxel;
    return s;
}
