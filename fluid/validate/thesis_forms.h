// The thesis's formulas (12)-(20) for one triangle or particle, as printed and corrected, in double precision. Tests compare the kernels of
// thesis mode with them and show the defects of the printed forms.
#pragma once

#include <array>

#include "engine/core/math.h"

namespace rivulet {

// Columns T0, B0 and N0 of M0 (14), in metres per unit of u and v, of a triangle with non-zero area in UV.
dmat3 thesisFrame(const std::array<dvec3, 3>& x, const std::array<dvec2, 3>& uv);
// M of (18). `normal`: of the model, any length.
dmat3 printedFrame(const dmat3& m0, const dvec3& normal);    // (15)-(17) as printed
dmat3 correctedFrame(const dmat3& m0, const dvec3& normal);  // T0, B0 and a unit normal

// The angle in radians between the direction in which (Fu, Fv) of the force field moves a particle in space and the part of `force` along
// the triangle; 0 if there is no such part. `m`: M of (18).
double turnedBy(const dmat3& m0, const dmat3& m, const dvec3& force);

// F_N of (20), N. `outward`: F_n of (19); `slope`: |grad rho|.
double printedHold(double outward, double adhesive, double curvature, double slope);
double correctedHold(double outward, double adhesive, double curvature, double slope, double most);

}  // namespace rivulet
