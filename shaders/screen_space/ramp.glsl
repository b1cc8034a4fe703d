// A perceptually uniform colour map: dark blue, blue, teal, pale sand, white; interpolated in Oklab (Ottosson 2020).
vec3 oklabToLinear(vec3 c) {
    float l = c.x + 0.3963377774 * c.y + 0.2158037573 * c.z;
    float m = c.x - 0.1055613458 * c.y - 0.0638541728 * c.z;
    float s = c.x - 0.0894841775 * c.y - 1.2914855480 * c.z;
    l = l * l * l; m = m * m * m; s = s * s * s;
    return max(vec3(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s, -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                    -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s), vec3(0.0));
}
vec3 ramp(float t) {  // lightness 0.36 .. 0.95 in even steps
    const vec3 stops[5] = vec3[5](vec3(0.36, -0.02, -0.11), vec3(0.51, -0.06, -0.12), vec3(0.66, -0.085, -0.05), vec3(0.80, -0.04, 0.04), vec3(0.95, 0.00, 0.04));
    float at = clamp(t, 0.0, 1.0) * 4.0;
    int k = min(int(at), 3);
    return oklabToLinear(mix(stops[k], stops[k + 1], at - float(k)));
}
