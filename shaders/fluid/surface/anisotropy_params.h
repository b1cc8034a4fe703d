// The ellipsoid of a particle from its neighbours (Yu and Turk 2013). Kernels and C++ share the constants, so that
// real-time rendering and the reference that it is compared with use the same ellipsoids.
//   w_ij = 1 - (r / R)^3 of neighbours nearer than R, the particle itself included; mean_i = sum w x / sum w.
//   Axes: the eigenvectors of sum w (x - mean)(x - mean)^T / sum w. Half axes, relative to those of a round particle: the square roots of
//   the eigenvalues over ANISOTROPY_FULL R^2, none shorter than the longest over ANISOTROPY_RATIO. share_i = sum w / (ANISOTROPY_CROWD (R /
// spacing)^3): 1 inside the water, 0.5 on a flat surface. From MANY down to FEW the half axes are blended to ANISOTROPY_ALONE: the paper
// counts neighbours and switches at a threshold, which makes drops change size abruptly.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
// Spacings: R on a GPU, where the neighbours at hand reach no further; the reference's is ANISOTROPY_SUPPORT_HOST.
CONSTANT(float, ANISOTROPY_SUPPORT, 2.0f);
CONSTANT(float, ANISOTROPY_SUPPORT_HOST, 3.0f);
CONSTANT(float, ANISOTROPY_SMOOTHING, 0.9f);  // lambda: share of the way to the mean of its neighbours that a centre goes
CONSTANT(float, ANISOTROPY_FULL, 0.15f);  // variance along each axis amid the water, R^2: 1 / ks
CONSTANT(float, ANISOTROPY_CROWD, 2.0943951f);
CONSTANT(float, ANISOTROPY_RATIO, 4.0f);  // kr
CONSTANT(float, ANISOTROPY_ALONE, 0.5f);  // kn: half axes of a particle by itself
CONSTANT(float, ANISOTROPY_FEW, 0.1f);  // shares
CONSTANT(float, ANISOTROPY_MANY, 0.25f);
CONSTANT(float, ANISOTROPY_KERNEL, 2.75f);  // spacings: support of a round particle's kernel, Wendland C2
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
