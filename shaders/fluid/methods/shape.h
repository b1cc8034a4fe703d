// The smoothing kernel without its factor: Wendland C2 (Wendland 1995), or with CUBIC the cubic spline (Monaghan 1992) as a sum of
// truncated powers, both zero from h on. W = kernelK * shape(r / h); grad W = gradientK * slope(r) * d.
#undef VISCOUS_WEIGHT
#undef SHAPE_AND_SLOPE
#if defined(CUBIC)
#define VISCOUS_WEIGHT 2.66666667f /* h^2 times what 1 / r^2 in a viscous pair term is replaced by: the same fourth moment */
FN real shape(real q) {
    real a = max0(1.0f - q);
    real b = max0(0.5f - q);
    return a * a * a * 2.0f - b * b * b * 8.0f;
}
FN real slope(real r, float h) {
    real q = max(r * (1.0f / h), 1.0e-4f);
    real a = max0(1.0f - q);
    real b = max0(0.5f - q);
    return (a * a * 6.0f - b * b * 24.0f) / q;
}
#else
#define VISCOUS_WEIGHT 3.0f
FN real shape(real q) {
    real a = max0(1.0f - q);
    real a2 = a * a;
    return a2 * a2 * (4.0f * q + 1.0f);
}
FN real slope(real r, float h) {
    real t = max0(h - r);
    return t * t * t;
}
#endif
// Both at once, for Wendland C2: slope(r) is h^3 times the second.
#define SHAPE_AND_SLOPE(r, invH, w, g) \
    real q_ = (r) * (invH);            \
    real a_ = max0(1.0f - q_);         \
    real g = a_ * a_ * a_;             \
    real w = g * a_ * (4.0f * q_ + 1.0f);
