// No-slip walls (after Morris et al. 1997): behind a wall, the fluid is continued with a velocity that equals the wall's at the wall,
// v(-s) = v_wall - (v_i - v_wall) s / d. The viscous pair term over that half-space, in closed form for Wendland C2: the acceleration is
// -nu k(d) (v_i - v_wall), k = 5/8 (1 - x)^6 (5 + 30 x + 69 x^2 + 64 x^3) / (h d), x = d / h; derived for motion along the wall, and also
// used for motion towards it. For distances below h / 10, k has its value at h / 10.
FN float wallFriction(float d, float invH) {
    float x = clamp(d * invH, 0.1f, 1.0f);
    float s = 1.0f - x;
    float s2 = s * s;
    return 0.625f * invH * invH * s2 * s2 * s2 * (5.0f + x * (30.0f + x * (69.0f + x * 64.0f))) / x;
}
