// Shared by the depth filters: the source, and with LAST the final step of each. Needs frame.glsl.
uniform sampler2D source;  // m
uniform vec3 low, high;    // m, world: the box of the water
layout(location = 0) out float depth;

ivec2 here, last;
float at(ivec2 p) { return texelFetch(source, clamp(p, ivec2(0), last), 0).r; }
// The depth of this pixel, unfiltered; call it first.
float begin() {
    here = ivec2(gl_FragCoord.xy);
    last = textureSize(source, 0) - 1;
    return texelFetch(source, here, 0).r;
}
// The depths at which the ray through a pixel enters and leaves the box; x > y: it misses. `slant`: m that it moves away from the wall by
// which it enters, for a metre of depth.
vec2 throughBox(vec2 pixel, out float slant) {
    vec3 ray = directionToWorld(sightWay(pixel)), from = frame.cameraPos.xyz + directionToWorld(sightFrom(pixel));
    ray = mix(ray, vec3(1.0e-9), lessThan(abs(ray), vec3(1.0e-9)));  // along a wall
    vec3 a = (low - from) / ray, b = (high - from) / ray;
    vec3 enter = min(a, b), leave = max(a, b), away = abs(ray);
    float entry = max(max(enter.x, enter.y), enter.z);
    slant = entry == enter.x ? away.x : entry == enter.y ? away.y : away.z;
    return vec2(entry, min(min(leave.x, leave.y), leave.z));
}
void end(float filtered) {
    depth = filtered;
#if defined(LAST)
    // Spheres extend slightly out of the box. Clipped, the water is flat at its walls.
    float slant;
    vec2 inside = throughBox(gl_FragCoord.xy, slant);
    depth = inside.x > inside.y || depth > inside.y ? kFar : max(depth, inside.x);
#endif
}
