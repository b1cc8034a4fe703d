// Random numbers for foam: they depend on a particle's id and the frame only, not on slots or threads. Include after BUFFERS.
#if !defined(RIVULET_FOAM_RANDOM_H)
#define RIVULET_FOAM_RANDOM_H
// Uniform random numbers in [0, 1) (the finaliser of MurmurHash3, Appleby 2011).
FN float random01(uint a, uint b, uint c) {
    uint x = a * 0x9E3779B9u + b * 0x85EBCA6Bu + c * 0xC2B2AE35u + 1u;
    x = x ^ (x >> 16u);
    x = x * 0x85EBCA6Bu;
    x = x ^ (x >> 13u);
    x = x * 0xC2B2AE35u;
    x = x ^ (x >> 16u);
    return TO_FLOAT(x >> 8u) * (1.0f / 16777216.0f);
}
// The number of foam particles that particle `who` spawns in the frame, at `births` per second.
FN uint bornOf(float births, uint who, float seconds, float share, uint seed) {
    return TO_UINT(min(births * seconds * share, 64.0f) + random01(who, seed, 0u));
}
#endif
