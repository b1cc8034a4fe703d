// The 27 cells around a place, for whoever is no particle of the sort.
#if !defined(RIVULET_AROUND_H)
#define RIVULET_AROUND_H
// The k-th of the cells around c along an axis of n, or -1; where the axis is periodic they wrap round, and none comes twice.
FN int cellAround(int c, int k, int n, float period) {
    int at = c + k - 1;
    if (period > 0.0f) at = k == 2 && n == 4 ? -1 : at < 1 ? n - 2 : at > n - 2 ? 1 : at;
    return at;
}
FN float shortest(float d, float period, float invPeriod) { return d - floor(d * invPeriod + 0.5f) * period; }
#endif
