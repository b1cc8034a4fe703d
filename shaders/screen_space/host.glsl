// A host's image: its colours, and depths in its own projection.
uniform bool isLinear;
uniform vec4 depthRow;      // of HostView
uniform bool hostParallel;  // an orthographic projection
uniform vec2 hostRange;     // glDepthRange
uniform bool zeroToOne;     // its clip space's depth
uniform vec4 mirror;        // pixel p of one picture is mirror.xy + mirror.zw * p of the other

vec3 fromSrgb(vec3 c) { return mix(c / 12.92, pow((max(c, vec3(0.0404)) + 0.055) / 1.055, vec3(2.4)), step(vec3(0.04045), c)); }
vec3 toSrgb(vec3 c) { return mix(12.92 * c, 1.055 * pow(max(c, vec3(0.0031308)), vec3(1.0 / 2.4)) - 0.055, step(vec3(0.0031308), c)); }

ivec2 mirrored(ivec2 p) { return ivec2(mirror.xy) + ivec2(mirror.zw) * p; }
float clipOnAxis(ivec2 p) { return dot(depthRow.xyz, vec3(vec2(p) + 0.5, 1.0)); }
// `p`: the pixel of our picture. 1 / depth in a perspective, else depth; m along the view axis.
float variableOfHost(float window, ivec2 p) {
    float z = (window - hostRange.x) / (hostRange.y - hostRange.x);
    return ((zeroToOne ? z : 2.0 * z - 1.0) - clipOnAxis(p)) / depthRow.w;
}
float hostOfDepth(float depth, ivec2 p) {
    float clip = clipOnAxis(p) + depthRow.w * (hostParallel ? depth : 1.0 / depth);
    return mix(hostRange.x, hostRange.y, clamp(zeroToOne ? clip : 0.5 * clip + 0.5, 0.0, 1.0));
}
