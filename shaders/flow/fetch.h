// Prefetches the data of the drops that are processed next: they are in random order, and a thread would wait for memory. On the CPU only:
// a GPU has other threads to run meanwhile, and these loads would race with the threads of those drops.
#if !defined(RIVULET_FETCH_H)
#define RIVULET_FETCH_H
FN void fetchDrops(GLOBAL(uint, id) GLOBAL(uint, drop) GLOBAL(vec4, motion) GLOBAL(uint, skin) GLOBAL(vec4, basis) uint i, uint count) {
#if defined(__cplusplus)
    if (i + 8u < count) {
        uint slot = id[i + 8u];
        PREFETCH(drop[DROP_UINTS * slot]);
        PREFETCH(motion[MOTION_VECS * slot]);
    }
    if (i + 4u < count) {
        uint t = drop[DROP_UINTS * id[i + 4u] + DROP_TRIANGLE] & DROP_NUMBER;
        PREFETCH(skin[SKIN_UINTS * t]);
        PREFETCH(basis[5u * t]);
        PREFETCH(basis[5u * t + 4u]);
    }
#endif
}
// Also the neighbours of a drop's triangle, and its film.
FN void fetchBeside(GLOBAL(uint, id) GLOBAL(uint, drop) GLOBAL(uint, skin) GLOBAL(vec4, basis) GLOBAL(uint, film) uint i, uint count) {
#if defined(__cplusplus)
    if (i + 2u >= count) return;
    uint t = SKIN_UINTS * (drop[DROP_UINTS * id[i + 2u] + DROP_TRIANGLE] & DROP_NUMBER);
    for (uint cell = 0u; cell < min(skin[t + 7u] * skin[t + 7u], 64u); cell += 16u) PREFETCH(film[skin[t + 6u] + cell]);
    for (uint edge = 0u; edge < 3u; ++edge) {
        uint across = skin[t + 3u + edge] >> 2u;
        if (across == SKIN_OPEN >> 2u) continue;
        PREFETCH(skin[SKIN_UINTS * across]);
        PREFETCH(basis[5u * across]);
        PREFETCH(basis[5u * across + 4u]);
    }
#endif
}
#endif
