// The inner loop of the distance band: one brick of 4^3 grid points. Plain data, because the unit is compiled for each instruction set.
#pragma once

#include <cstdint>

namespace rivulet {

// Precomputed values for distances to one triangle, in voxels. `unit`: the plane's unit normal. If the triangle has no area, `unit` is
// zero, `area` is -1, and only the edges count.
struct BandTarget {
    double a[3], ab[3], ac[3], bc[3], unit[3];
    double abab, abac, acac, area, perAb, perAc, perBc;
};

// Bound of a triangle for the sieve: a disc in its plane that contains it; if it has no area, a sphere, and `normal` is zero.
struct BandDisc {
    float centre[3];
    float radius;  // rounded up
    float normal[3];
    float slack;  // squared voxels: above the error of a squared distance in floats within the band
};

struct BandBrick {
    const BandTarget* targets;
    const BandDisc* discs;    // of each target
    const uint32_t* entries;  // ascending indices of the targets that may be nearest to a point of the brick
    uint32_t count;
    double first[3];    // the brick's first point
    double width;       // of the band
    float* lower;       // room for 8 * count
    double* square;     // 64 results, z slowest: the squared distance to the nearest target,
    uint32_t* nearest;  // and its index, the lowest of equally near ones; kNoTarget beyond the band
};
inline constexpr uint32_t kNoTarget = 0xFFFFFFFFU;

// Bricks of rows along x whose centre lies within `reach` of a disc. May include bricks that are slightly farther.
struct BandRows {
    const BandDisc* disc;
    float first[3];  // centre of the first brick of the first row; rows follow along y
    uint32_t rows;
    float reach;
    uint32_t* bits;  // of each row: bit k for its brick k, 0..7
};

// Packs directions of any length above 0 into the low 28 bits of packNormal's code.
struct BandPack {
    const double *x, *y, *z;
    uint32_t* code;
    uint32_t count;  // a multiple of 8
};

struct BandKernels {
    void (*brick)(const BandBrick&);
    void (*rows)(const BandRows&);
    void (*pack)(const BandPack&);
};

}  // namespace rivulet

#define RIVULET_BAND_UNIT(isa) \
    namespace rivulet::isa {   \
    BandKernels bandKernels(); \
    }
#if defined(RIVULET_KERNEL_UNIT)
RIVULET_BAND_UNIT(RIVULET_KERNEL_UNIT)
#endif
