// Chance for foam: by a particle's id and the frame, neither by slot nor by thread. Include after BUFFERS; births.
#if !defined(RIVULET_FOAM_RANDOM_H)
#define RIVULET_FOAM_RANDOM_H
// Numbers in [0, 1), spread evenly (the finaliser of MurmurHash3, Appleby 2011).
FN float random01(uint a, uint b, uint c) {
    uint x = a * 0x9E3779B9u + b * 0x85EBCA6Bu + c * 0xC2B2AE35u + 1u;
    x = x ^ (x >> 16u);
    x = x * 0x85EBCA6Bu;
    x = x ^ (x >> 13u);
    x = x * 0xC2B2AE35u;
    x = x ^ (x >> 16u);
    return TO_FLOAT(x >> 8u) * (1.0f / 16777216.0f);
}
// How many particle `who` makes in the frame, at `births` a second.
FN uint bornOf(float births, uint who, float seconds, float share, uint seed) {
    return TO_UINT(min(births * seconds * share, 64.0f) + random01(who, seed, 0u));
}
#endif
