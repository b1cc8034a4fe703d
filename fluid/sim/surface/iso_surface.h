// IsoSurface: the surface of particles at full precision: anisotropic kernels (Yu & Turk 2013), in double, on the host.
//
//     value(p) = sum of spacing^3 |G| W(|G (p - c)|), Wendland C2: about 1 amid water at rest, 0 in the air; the surface is where it is
//     0.5.
//
// Each particle brings the volume spacing^3, however its kernel is stretched. Centres c are smoothed
// (shaders/fluid/surface/anisotropy_params.h has the constants), then put back by what the neighbours' centres moved, too (Vollmer et al.
// 1999): noise goes, the level stays. A lattice that fills a half space has its surface half a spacing beyond the outermost centres, within
// 0.03 spacings (jittered by a quarter spacing, too: measured 0.47 to 0.49); a particle by itself is a ball of 0.51 spacings, half its
// volume.
#pragma once

#include <span>
#include <vector>

#include "engine/core/result.h"
#include "fluid/sim/grid/sparse_cells.h"
#include "shaders/fluid/surface/anisotropy_params.h"

namespace rivulet {

struct IsoSurfaceParams {
    double support = double{ANISOTROPY_SUPPORT_HOST};  // spacings: neighbours nearer shape a particle's kernel
    double smoothing = double{ANISOTROPY_SMOOTHING};   // 0..1
    double kernel = double{ANISOTROPY_KERNEL};         // spacings: support of a round kernel
};

class IsoSurface {
  public:
    static constexpr double kLevel = 0.5;  // value() on the surface

    // `particles`: xyz m, w = density / rest density, below 0: there is none. What is not finite, or a million spacings away, is left out.
    // None at all: a surface that is nowhere. Error (badInput): a spacing (m) or a param that is not positive.
    static Result<IsoSurface> create(std::span<const vec4> particles, float spacing, const IsoSurfaceParams& params = {});

    struct Sample {
        double value = 0;
        dvec3 gradient{0.0};  // 1/m, inward
    };
    Sample sample(const dvec3& p) const;  // p: m
    double value(const dvec3& p) const;
    dvec3 gradient(const dvec3& p) const { return sample(p).gradient; }
    dvec3 normal(const dvec3& p) const;  // outward, unit; +y where there is no gradient

    uint32_t count() const { return static_cast<uint32_t>(kernels_.size()); }  // particles in it
    double spacing() const { return spacing_; }                                // m
    // Cells outside of which the value is 0.
    const SparseCells& cells() const { return cells_; }

  private:
    // A particle's kernel. |G (p - centre)| < 1 is where it reaches; G is symmetric.
    struct Kernel {
        double value(const dvec3& p) const;
        dvec3 centre{0.0};                                      // m
        double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;  // G, 1/m
        double peak = 0;                                        // value at the centre
        double reach = 0;                                       // m
    };

    double spacing_ = 0;
    std::vector<Kernel> kernels_;
    SparseCells cells_;
};

}  // namespace rivulet
