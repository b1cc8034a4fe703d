// Nearest triangles for a brick of points. A sieve in floats, eight lanes at a time, may keep too many triangles but never drops one that
// counts. The distances to those kept are computed in doubles by the same operations on every instruction set, so the results are equal.
#include "fluid/voxel/kernels/band_brick.h"

#include "shaders/common/lang.h"

namespace rivulet::RIVULET_KERNEL_UNIT {
namespace {

#if defined(__AVX512F__)
constexpr int kWide = 8;
#else
constexpr int kWide = 4;
#endif
typedef double Wide __attribute__((vector_size(8 * kWide)));
typedef int64_t WideMask __attribute__((vector_size(8 * kWide)));
typedef float Narrow __attribute__((vector_size(4 * kWide)));

#if defined(__AVX__) && !defined(__AVX512F__)
INLINE Wide smaller(Wide a, Wide b) { return static_cast<Wide>(_mm256_min_pd(a, b)); }
INLINE Wide larger(Wide a, Wide b) { return static_cast<Wide>(_mm256_max_pd(a, b)); }
#else
INLINE Wide smaller(Wide a, Wide b) { return a < b ? a : b; }
INLINE Wide larger(Wide a, Wide b) { return a > b ? a : b; }
#endif

struct Wide3 {
    Wide x, y, z;
};
INLINE Wide dot(const double* a, const Wide3& b) { return a[0] * b.x + a[1] * b.y + a[2] * b.z; }
INLINE Wide square(const Wide3& v) { return v.x * v.x + v.y * v.y + v.z * v.z; }
INLINE Wide3 less(const Wide3& q, const double* e, Wide t) { return {q.x - e[0] * t, q.y - e[1] * t, q.z - e[2] * t}; }
INLINE Wide within01(Wide t) { return smaller(Wide{} + 1.0, larger(Wide{}, t)); }

// Squared distance to the plane if the projection of the point lies inside the triangle, else to the nearest edge.
INLINE Wide squaredDistance(const BandTarget& t, const Wide3& point) {
    const Wide3 q{point.x - t.a[0], point.y - t.a[1], point.z - t.a[2]};
    const Wide3 fromB{q.x - t.ab[0], q.y - t.ab[1], q.z - t.ab[2]};
    const Wide onAb = dot(t.ab, q), onAc = dot(t.ac, q);
    const Wide v = t.acac * onAb - t.abac * onAc;
    const Wide w = t.abab * onAc - t.abac * onAb;
    const Wide height = dot(t.unit, q);
    const WideMask inside = (v >= 0.0) & (w >= 0.0) & (v + w <= t.area);
    const Wide edges =
        smaller(square(less(q, t.ab, within01(onAb * t.perAb))),
                smaller(square(less(q, t.ac, within01(onAc * t.perAc))), square(less(fromB, t.bc, within01(dot(t.bc, fromB) * t.perBc)))));
    return inside ? height * height : edges;
}

// Bit k: lane k.
INLINE uint32_t bitsOf(LaneMask m) {
#if defined(__AVX__)
    return static_cast<uint32_t>(_mm256_movemask_ps(reinterpret_cast<__m256>(m)));
#else
    uint32_t bits = 0;
    for (int k = 0; k < 8; ++k) bits |= m[k] != 0 ? 1U << k : 0U;
    return bits;
#endif
}

struct Sieved {
    real lower, upper;  // bounds of the squared distance from the target
};
INLINE Sieved sieve(const BandDisc& d, real x, real y, real z) {
    const real3 q(x - d.centre[0], y - d.centre[1], z - d.centre[2]);
    const real square = dot(q, q);
    const real height = q.x * d.normal[0] + q.y * d.normal[1] + q.z * d.normal[2];
    const real flat = height * height;
    const real along = max0(sqrt(max0(square - flat)) - d.radius);
    return {flat + along * along - d.slack, square};
}

// The eight points of a cube, and the target nearest to each so far.
struct Cube {
    Wide3 point[8 / kWide];
    Wide best[8 / kWide];
    WideMask nearest[8 / kWide];
    Lanes bound;    // at least `best`
    float x, y, z;  // the first point
    uint32_t guess;

    INLINE void measure(const BandTarget& t, uint32_t k) {
        for (int h = 0; h < 8 / kWide; ++h) {
            const Wide s = squaredDistance(t, point[h]);
            const WideMask number = WideMask{} + static_cast<int64_t>(k);
            const WideMask better = (s < best[h]) | ((s == best[h]) & (number < nearest[h]));
            best[h] = better ? s : best[h];
            nearest[h] = better ? number : nearest[h];
            const Narrow n = __builtin_convertvector(best[h], Narrow) * 1.000001F;
            memcpy(reinterpret_cast<char*>(&bound) + sizeof(n) * static_cast<unsigned>(h), &n, sizeof(n));
        }
    }
};

constexpr Lanes kX = {0, 1, 0, 1, 0, 1, 0, 1}, kY = {0, 0, 1, 1, 0, 0, 1, 1}, kZ = {0, 0, 0, 0, 1, 1, 1, 1};
constexpr float kCubeRadius = 0.8660255F;

INLINE void start(Cube& cube, int c, const BandBrick& job) {
    const int x0 = 2 * (c & 1), y0 = c & 2, z0 = (c >> 1) & 2;
    cube.x = static_cast<float>(job.first[0] + x0);
    cube.y = static_cast<float>(job.first[1] + y0);
    cube.z = static_cast<float>(job.first[2] + z0);
    for (int h = 0; h < 8 / kWide; ++h) {
        double x[kWide], y[kWide], z[kWide];
        for (int k = 0; k < kWide; ++k) {
            const int at = h * kWide + k;
            x[k] = job.first[0] + x0 + (at & 1);
            y[k] = job.first[1] + y0 + ((at >> 1) & 1);
            z[k] = job.first[2] + z0 + (at >> 2);
        }
        memcpy(&cube.point[h].x, x, sizeof(x));
        memcpy(&cube.point[h].y, y, sizeof(y));
        memcpy(&cube.point[h].z, z, sizeof(z));
        cube.best[h] = Wide{} + job.width * job.width;
        cube.nearest[h] = WideMask{} + static_cast<int64_t>(kNoTarget);
    }
}

void brick(const BandBrick& job) {
    if (job.count == 0) {
        for (int k = 0; k < 64; ++k) job.nearest[k] = kNoTarget;
        return;
    }
    // Sieves each entry by its distance from the centres of the eight cubes.
    LaneMask guess = {};
    real least(1e30F);
    const real middleX = real(kX * 2.0F + 0.5F) + static_cast<float>(job.first[0]),
               middleY = real(kY * 2.0F + 0.5F) + static_cast<float>(job.first[1]),
               middleZ = real(kZ * 2.0F + 0.5F) + static_cast<float>(job.first[2]);
    for (uint32_t n = 0; n < job.count; ++n) {
        const Sieved s = sieve(job.discs[job.entries[n]], middleX, middleY, middleZ);
        memcpy(job.lower + size_t{8} * n, &s.lower.v, 32);
        const LaneMask nearer = s.upper.v < least.v;
        least = select(nearer, s.upper, least);
        guess = nearer ? (LaneMask{} + static_cast<int>(n)) : guess;
    }
    // A likely nearest entry comes first for each cube; its distance bounds the others.
    int guesses[8];
    memcpy(guesses, &guess, 32);
    Cube cubes[8];
    real limits;
    for (int c = 0; c < 8; ++c) {
        Cube& cube = cubes[c];
        start(cube, c, job);
        cube.guess = job.entries[guesses[c]];
        cube.measure(job.targets[cube.guess], cube.guess);
        float furthest = cube.bound[0];
        for (int k = 1; k < 8; ++k) furthest = max(furthest, cube.bound[k]);
        const float reach = sqrt(furthest) * 1.000001F + kCubeRadius;
        limits.v[c] = reach * reach;
    }
    for (uint32_t n = 0; n < job.count; ++n) {
        real lower;
        memcpy(&lower.v, job.lower + size_t{8} * n, 32);
        uint32_t bits = bitsOf(lower <= limits);
        if (bits == 0) continue;
        const uint32_t k = job.entries[n];
        const BandDisc& d = job.discs[k];
        for (; bits != 0; bits &= bits - 1) {
            Cube& cube = cubes[__builtin_ctz(bits)];
            const Sieved s = sieve(d, real(kX + cube.x), real(kY + cube.y), real(kZ + cube.z));
            if (anyLane(s.lower.v <= cube.bound) && k != cube.guess) cube.measure(job.targets[k], k);
        }
    }
    for (int c = 0; c < 8; ++c) {
        const Cube& cube = cubes[c];
        const int first = (c >> 2) * 32 + ((c >> 1) & 1) * 8 + (c & 1) * 2;
        for (int at = 0; at < 8; ++at) {
            const int to = first + (at >> 2) * 16 + ((at >> 1) & 1) * 4 + (at & 1);
            job.square[to] = cube.best[at / kWide][at % kWide];
            job.nearest[to] = static_cast<uint32_t>(cube.nearest[at / kWide][at % kWide]);
        }
    }
}

void rows(const BandRows& job) {
    const Lanes step = {0, 4, 8, 12, 16, 20, 24, 28};
    const real x(step + job.first[0]), limit(job.reach * job.reach);
    for (uint32_t r = 0; r < job.rows; ++r)
        job.bits[r] = bitsOf(sieve(*job.disc, x, real(job.first[1] + 4.0F * static_cast<float>(r)), real(job.first[2])).lower <= limit);
}

INLINE Wide magnitude(Wide a) { return larger(a, -a); }

void pack(const BandPack& job) {
    for (uint32_t k = 0; k < job.count; k += kWide) {
        Wide3 d;
        memcpy(&d.x, job.x + k, sizeof(Wide));
        memcpy(&d.y, job.y + k, sizeof(Wide));
        memcpy(&d.z, job.z + k, sizeof(Wide));
        const Wide per = 1.0 / (magnitude(d.x) + magnitude(d.y) + magnitude(d.z));
        d = {d.x * per, d.y * per, d.z * per};
        const Wide foldX = 1.0 - magnitude(d.y), foldY = 1.0 - magnitude(d.x);
        const Wide x = d.z < 0.0 ? (d.x < 0.0 ? -foldX : foldX) : d.x;
        const Wide y = d.z < 0.0 ? (d.y < 0.0 ? -foldY : foldY) : d.y;
        // Of the four neighbouring codes, the one whose direction has the largest cosine (positive for all four). u, v: -8191 to 8191.
        typedef int32_t Codes __attribute__((vector_size(4 * kWide)));
        const Wide lowX =
            smaller(__builtin_convertvector(__builtin_convertvector(x * 8191.0 + 8191.0, Codes), Wide), Wide{} + 16381.0) - 8191.0;
        const Wide lowY =
            smaller(__builtin_convertvector(__builtin_convertvector(y * 8191.0 + 8191.0, Codes), Wide), Wide{} + 16381.0) - 8191.0;
        Wide best = Wide{} - 1.0, bestSquare = Wide{} + 1.0, bestU = lowX, bestV = lowY;
        for (int c = 0; c < 4; ++c) {
            const Wide u = lowX + (c & 1), v = lowY + (c >> 1);
            const Wide z = 8191.0 - magnitude(u) - magnitude(v);
            const Wide fold = larger(-z, Wide{});
            const Wide nx = u < 0.0 ? u + fold : u - fold, ny = v < 0.0 ? v + fold : v - fold;
            const Wide along = nx * d.x + ny * d.y + z * d.z, nn = nx * nx + ny * ny + z * z;
            const WideMask better = along * along * bestSquare > best * nn;
            best = better ? along * along : best;
            bestSquare = better ? nn : bestSquare;
            bestU = better ? u : bestU;
            bestV = better ? v : bestV;
        }
        const Codes codes = __builtin_convertvector(bestU + 8191.0, Codes) | (__builtin_convertvector(bestV + 8191.0, Codes) << 14);
        memcpy(job.code + k, &codes, sizeof(codes));
    }
}

}  // namespace

BandKernels bandKernels() { return {brick, rows, pack}; }

}  // namespace rivulet::RIVULET_KERNEL_UNIT
