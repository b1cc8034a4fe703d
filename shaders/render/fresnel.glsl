// Reflectance of a clear body, exact for unpolarised light (Fresnel 1823). `c`: cosine of the angle of incidence, from air into index n.
float fresnel(float c, float n) {
    float g = sqrt(n * n - 1.0 + c * c);
    float s = (c - g) / (c + g), p = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * s * s * (1.0 + p * p);
}
// The share of 1 - (reflectance at right angles) that is reflected too (Schlick 1994). `c`: cosine, which rounding may take beyond 1.
float schlick(float c) {
    float x = clamp(1.0 - c, 0.0, 1.0), x2 = x * x;
    return x2 * x2 * x;
}
// The normal that mirrors one direction into the other; 0 between opposite ones.
vec3 halfway(vec3 a, vec3 b) {
    vec3 h = a + b;
    return h * inversesqrt(max(dot(h, h), 1.0e-12));
}
