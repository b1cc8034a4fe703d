// Weakly compressible SPH: Tait's equation with Wendland C2 or the cubic spline (Monaghan 1994; Wendland 1995), and the thesis's form of it
// (Mueller et al. 2003: poly6, spiky, linear equation of state).
#pragma once

namespace rivulet {

struct MethodRow;

MethodRow wcsphMethod();
MethodRow wcsphThesisMethod();

}  // namespace rivulet
