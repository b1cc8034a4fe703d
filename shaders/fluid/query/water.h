// The water at any point: the density ratio of the particles around it (Wendland 1995), their velocity and the gradient. After BUFFERS.
#if !defined(RIVULET_WATER_H)
#define RIVULET_WATER_H
STRUCT(Water) {
    float ratio;    // 0 in the air
    vec3 velocity;  // m/s, times the ratio
    vec3 gradient;  // 1/m, of the ratio: into the water
};
FN Water waterAt(GLOBAL(uint, cellStart) GLOBAL(vec4, position) GLOBAL(vec4, velocity) vec3 at, StepParams s, float weight) {
    Water w;
    w.ratio = 0.0f;
    w.velocity = vec3(0.0f, 0.0f, 0.0f);
    w.gradient = vec3(0.0f, 0.0f, 0.0f);
    if (cellOf(at, s) == s.cellCount) return w;
    int cx = TO_INT((at.x - s.gridOrigin.x) * s.gridScale.x);
    int cy = TO_INT((at.y - s.gridOrigin.y) * s.gridScale.y);
    int cz = TO_INT((at.z - s.gridOrigin.z) * s.gridScale.z);
    // On the cpu the grid has two cells along x for one of a GPU.
    uint perCell = s.cellCount / TO_UINT(s.cellsX * s.cellsY * s.cellsZ);
    for (int c = 0; c < 27; ++c) {
        int x = cellAround(cx, c % 3, s.cellsX, s.period.x);
        int y = cellAround(cy, c / 3 % 3, s.cellsY, s.period.y);
        int z = cellAround(cz, c / 9, s.cellsZ, s.period.z);
        if (x < 0 || y < 0 || z < 0) continue;
#if defined(LINKED_LIST)
        uint first = TO_UINT((z * s.cellsY + y) * s.cellsX + x) * perCell;
        for (uint j = cellStart[first]; j != LIST_END; j = cellStart[NEXT_OF(s.cellCount, j)]) {
#else
        for (uint set = 0u; set <= s.asleepSets; ++set) {
            uint first = cellsOf(set, s) + TO_UINT((z * s.cellsY + y) * s.cellsX + x) * perCell;
            uint end = cellStart[first + perCell];
            for (uint j = cellStart[first]; j < end; ++j) {
#endif
            vec4 other = position[j];
            vec3 d = vec3(shortest(at.x - other.x, s.period.x, s.invPeriod.x), shortest(at.y - other.y, s.period.y, s.invPeriod.y),
                          shortest(at.z - other.z, s.period.z, s.invPeriod.z));
            float q = length(d) * s.invH;
            float t = max(1.0f - q, 0.0f);
            if (other.w < 0.0f || t == 0.0f) continue;
            float share = t * t * t * t * (4.0f * q + 1.0f) * weight;
            w.ratio += share;
            w.velocity += velocity[j].xyz * share;
            w.gradient -= d * (20.0f * t * t * t * s.invH * s.invH * weight);
        }
#if !defined(LINKED_LIST)
    }
#endif
}
return w;
}
#endif
