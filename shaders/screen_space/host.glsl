// A host's image: its colours, and depths in its own projection.
uniform bool isLinear;
uniform vec4 hostPlanes;  // [2][2], [3][2] of its projection; its depth range
uniform bool zeroToOne;   // its clip space's depth

vec3 fromSrgb(vec3 c) { return mix(c / 12.92, pow((max(c, vec3(0.0404)) + 0.055) / 1.055, vec3(2.4)), step(vec3(0.04045), c)); }
vec3 toSrgb(vec3 c) { return mix(12.92 * c, 1.055 * pow(max(c, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), c)); }

float clipOfHost(float window) {
    float z = (window - hostPlanes.z) / (hostPlanes.w - hostPlanes.z);
    return zeroToOne ? z : 2.0 * z - 1.0;
}
float hostOfDepth(float depth) {  // converts m along the view axis to the host's depth
    float clip = hostPlanes.y / depth - hostPlanes.x;
    return mix(hostPlanes.z, hostPlanes.w, clamp(zeroToOne ? clip : 0.5 * clip + 0.5, 0.0, 1.0));
}
