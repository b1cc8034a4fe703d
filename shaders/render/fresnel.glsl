// Reflectance of a clear body, exact for unpolarised light (Fresnel 1823). `c`: cosine of the angle of incidence, from air into index n.
float fresnel(float c, float n) {
    float g = sqrt(n * n - 1.0 + c * c);
    float s = (c - g) / (c + g), p = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * s * s * (1.0 + p * p);
}
