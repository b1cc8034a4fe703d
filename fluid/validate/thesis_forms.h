// The thesis's formulas (12)-(20) for one triangle or particle, as printed and mended, in double precision: what the kernels of thesis mode
// are compared with, and what is wrong with the printed ones.
#pragma once

#include <array>

#include "engine/core/math.h"

namespace rivulet {

// Columns T0, B0 and N0 of M0 (14): metres a unit of u and v. Of a triangle with an area in UV.
dmat3 thesisFrame(const std::array<dvec3, 3>& x, const std::array<dvec2, 3>& uv);
// M of (18). `normal`: the model's, of any length.
dmat3 printedFrame(const dmat3& m0, const dvec3& normal);  // (15)-(17) as printed
dmat3 mendedFrame(const dmat3& m0, const dvec3& normal);   // T0, B0 and a unit normal

// Radians between where a force field's (Fu, Fv) moves a particle, in space, and the part of `force` that lies along the triangle. `m`: M
// of (18). 0 where there is no such part.
double turnedBy(const dmat3& m0, const dmat3& m, const dvec3& force);

// F_N of (20), N. `outward`: F_n of (19); `slope`: |grad rho|.
double printedHold(double outward, double adhesive, double curvature, double slope);
double mendedHold(double outward, double adhesive, double curvature, double slope, double most);

}  // namespace rivulet
