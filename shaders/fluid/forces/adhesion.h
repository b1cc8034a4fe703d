// Adhesion (Akinci et al. 2013): A(q) = (-4 q^2 + 6 q - 2)^(1/4) between h / 2 and h, without its factor.
FN real adhesionShape(real q) { return sqrt(sqrt(max0((1.0f - q) * (4.0f * q - 2.0f)))); }
// The same of a plane of such samples at distance q h: q times the integral of A from q to 1. That of (1 - s^2)^(1/4) by its series, the
// last term such that nothing is left at the end: within 1 %.
FN float adhesionOfPlane(float q) {
    float s = clamp(4.0f * q - 3.0f, -1.0f, 1.0f);
    float s2 = s * s;
    float part = s * (1.0f - s2 * (0.08333333f + s2 * (0.01875f + s2 * 0.02389f)));
    return max(q, 0.0f) * 0.1767767f * max(0.874028f - part, 0.0f);
}
