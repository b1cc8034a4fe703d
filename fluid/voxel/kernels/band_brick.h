// The band's inner work, one brick of 4^3 grid points: plain data, so that the unit can be compiled once an instruction set.
#pragma once

#include <cstdint>

namespace rivulet {

// What distances to one triangle need, worked out once. In voxels. `unit`: of the plane's normal, zero if the triangle has no area;
// `area` is then -1, and its edges are all there is.
struct BandTarget {
    double a[3], ab[3], ac[3], bc[3], unit[3];
    double abab, abac, acac, area, perAb, perAc, perBc;
};

// What sieves know of it: a disc in its plane that holds it; a sphere if it has no area, and then `normal` is zero.
struct BandDisc {
    float centre[3];
    float radius;  // rounded up
    float normal[3];
    float slack;  // squared voxels: more than a squared distance in floats may be wrong by, if it is within reach
};

struct BandBrick {
    const BandTarget* targets;
    const BandDisc* discs;    // of each target
    const uint32_t* entries;  // numbers of the targets that may be nearest to a point of the brick, increasing
    uint32_t count;
    double first[3];    // the brick's first point
    double width;       // of the band
    float* lower;       // room for 8 * count
    double* square;     // 64 results, z slowest: the squared distance to the nearest target,
    uint32_t* nearest;  // and that, the lowest number of those equally near; kNobody beyond the band
};
inline constexpr uint32_t kNobody = 0xFFFFFFFFU;

// Which bricks of rows along x have their middle within `reach` of a disc. May err by saying yes.
struct BandRows {
    const BandDisc* disc;
    float first[3];  // the middle of the first brick of the first row; rows follow along y
    uint32_t rows;
    float reach;
    uint32_t* bits;  // of each row: bit k for its brick k, 0..7
};

// Directions of any length but 0 into the low 28 bits of packNormal's code.
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
