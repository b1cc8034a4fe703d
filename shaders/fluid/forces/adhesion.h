// Adhesion kernel (Akinci et al. 2013): A(q) = (-4 q^2 + 6 q - 2)^(1/4) for q between 1/2 and 1 (q = r / h), without its constant factor.
FN real adhesionShape(real q) { return sqrt(sqrt(max0((1.0f - q) * (4.0f * q - 2.0f)))); }
// The same for a plane of samples at distance q h: q times the integral of A from q to 1. The integral of (1 - s^2)^(1/4) uses its series;
// the last term is chosen so that the result is 0 at the end: within 1 %.
FN float adhesionOfPlane(float q) {
    float s = clamp(4.0f * q - 3.0f, -1.0f, 1.0f);
    float s2 = s * s;
    float part = s * (1.0f - s2 * (0.08333333f + s2 * (0.01875f + s2 * 0.02389f)));
    // Beyond h not even by rounding: the walls of a periodic box are at 1e15 m.
    return q < 1.0f ? max(q, 0.0f) * 0.1767767f * max(0.874028f - part, 0.0f) : 0.0f;
}
