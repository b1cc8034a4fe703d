// The padded grid: which cell a position is in. One empty cell on every side, so that a particle's 27 cells always exist.
#if !defined(RIVULET_GRID_H)
#define RIVULET_GRID_H
// The cell of `x` (m), x fastest, or cellsX * cellsY * cellsZ ("limbo") where x is outside the unpadded cells, NaN or infinite.
// `origin`: StepParams.gridOrigin. The conditions are true for what is inside, so that a NaN, of which every comparison is false, is outside.
FN uint cellOf(vec3 x, vec4 origin, int cellsX, int cellsY, int cellsZ) {
    float gx = (x.x - origin.x) * origin.w;
    float gy = (x.y - origin.y) * origin.w;
    float gz = (x.z - origin.z) * origin.w;
    int cell = cellsX * cellsY * cellsZ;
    if (gx >= 1.0f && gx < TO_FLOAT(cellsX - 1) && gy >= 1.0f && gy < TO_FLOAT(cellsY - 1) && gz >= 1.0f && gz < TO_FLOAT(cellsZ - 1))
        cell = (TO_INT(gz) * cellsY + TO_INT(gy)) * cellsX + TO_INT(gx);
    return TO_UINT(cell);
}
#endif
