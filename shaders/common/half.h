// Conversion between floats and the bits of half floats, equal on every compiler: for textures of 16-bit floats that a kernel writes.
// Rounded to the nearest, at most 65504; a NaN becomes 0. There are no branches, so that the CPU's compiler can vectorize it.
FN uint halfBits(float x) {
    float a = x < 0.0f ? -x : x;
    a = a < 65504.0f ? a : a >= 65504.0f ? 65504.0f : 0.0f;
    uint bits = FLOAT_BITS(a);
    uint whole = (bits + 0x0FFFu + ((bits >> 13u) & 1u) - 0x38000000u) >> 13u;
    uint denormal = FLOAT_BITS(a + 0.5f) - 0x3F000000u;  // steps of 2^-24
    return (a < 6.103515625e-5f ? denormal : whole) + (x < 0.0f ? 0x8000u : 0u);
}
// Two halves in one word, `low` first in memory.
FN uint halfPair(float low, float high) { return halfBits(low) | (halfBits(high) << 16u); }
FN float floatOfHalf(uint half_) {
    uint size = half_ & 0x7FFFu;
    float a = size < 0x0400u ? TO_FLOAT(size) * 5.9604644775390625e-8f : BITS_FLOAT((size << 13u) + 0x38000000u);
    return (half_ & 0x8000u) > 0u ? -a : a;
}
