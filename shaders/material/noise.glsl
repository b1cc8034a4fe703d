// Value noise (Perlin 1985) for materials.
float hashed(vec3 p) {
    uvec3 k = uvec3(ivec3(p)) * uvec3(374761393u, 668265263u, 2246822519u);
    uint h = k.x ^ k.y ^ k.z;
    h = (h ^ (h >> 13)) * 1274126177u;
    return float((h ^ (h >> 16)) & 65535u) / 65535.0;
}
// -1..1, and its gradient.
vec4 noise(vec3 p) {
    vec3 cell = floor(p), f = p - cell, w = f * f * f * (f * (f * 6.0 - 15.0) + 10.0), dw = 30.0 * f * f * (f * (f - 2.0) + 1.0);
    float a = hashed(cell), b = hashed(cell + vec3(1, 0, 0)), c = hashed(cell + vec3(0, 1, 0)), d = hashed(cell + vec3(1, 1, 0));
    float e = hashed(cell + vec3(0, 0, 1)), g = hashed(cell + vec3(1, 0, 1)), h = hashed(cell + vec3(0, 1, 1)), i = hashed(cell + vec3(1));
    float low = mix(mix(a, b, w.x), mix(c, d, w.x), w.y), high = mix(mix(e, g, w.x), mix(h, i, w.x), w.y);
    vec3 slope = dw * vec3(mix(mix(b - a, d - c, w.y), mix(g - e, i - h, w.y), w.z), mix(mix(c - a, d - b, w.x), mix(h - e, i - g, w.x), w.z), high - low);
    return 2.0 * vec4(mix(low, high, w.z), slope) - vec4(1.0, 0.0, 0.0, 0.0);
}
