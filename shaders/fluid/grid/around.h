// The 27 cells around any point; for kernels whose threads are not sorted particles.
#if !defined(RIVULET_AROUND_H)
#define RIVULET_AROUND_H
// The first of the cells of a set: 0 those of the fluid, 1 those of sleeping particles (StepParams.asleepSets of them).
FN uint cellsOf(uint set, StepParams s) { return set == 0u ? 0u : s.totalCells + 3u; }
// The k-th of the cells around c along an axis of n cells, or -1; on a periodic axis they wrap around, and no cell occurs twice.
FN int cellAround(int c, int k, int n, float period) {
    int at = c + k - 1;
    if (period > 0.0f) at = k == 2 && n == 4 ? -1 : at < 1 ? n - 2 : at > n - 2 ? 1 : at;
    return at;
}
FN float shortest(float d, float period, float invPeriod) { return d - floor(d * invPeriod + 0.5f) * period; }
#endif
