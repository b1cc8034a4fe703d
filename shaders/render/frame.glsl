// The frame's uniform block and the geometry of its pixels. "Depth" is the distance along the view axis in metres, positive in front.
#include "shaders/render/frame.h"
layout(std140, binding = 0) uniform FrameBlock { FrameParams frame; };

const float kFar = 1.0e6;  // m, depth where nothing is visible

// 1: an orthographic projection, whose lines of sight are parallel; 0: a perspective, where they come from the eye.
float parallel() { return frame.projection[3][3]; }
// The line of sight of a pixel, in view: its point at `depth` is sightFrom + depth * sightWay. Of a point: where its line of sight begins.
vec3 sightFrom(vec2 pixel) { return vec3(parallel() * (pixel * frame.ray.xy + frame.ray.zw), 0.0); }
vec3 sightFrom(vec3 posView) { return vec3(parallel() * posView.xy, 0.0); }
vec3 sightWay(vec2 pixel) { return vec3((1.0 - parallel()) * (pixel * frame.ray.xy + frame.ray.zw), -1.0); }
vec3 towardsEye(vec3 posView) { return normalize(mix(-posView, vec3(0.0, 0.0, 1.0), parallel())); }
// m at `depth`, of what is 1 m at a depth of 1 m in the picture.
float spreadAt(float depth) { return mix(depth, 1.0, parallel()); }
vec2 pixelSize(float depth) { return spreadAt(depth) * frame.ray.xy; }  // m
vec3 placeAt(vec2 pixel, float depth) { return vec3((pixel * frame.ray.xy + frame.ray.zw) * spreadAt(depth), -depth); }
float depthOfWindow(float z) {
    float clip = 2.0 * z - 1.0;
    return (frame.planes.w - parallel() * clip) / (clip + frame.planes.z - parallel() * clip);
}
float windowOfDepth(float depth) {
    if (parallel() > 0.0) return 0.5 + 0.5 * frame.planes.w - 0.5 * frame.planes.z * depth;
    return 0.5 - 0.5 * frame.planes.z + 0.5 * frame.planes.w / depth;
}
vec3 toWorld(vec3 posView) { return (frame.inverseView * vec4(posView, 1.0)).xyz; }
vec3 directionToWorld(vec3 dirView) { return mat3(frame.inverseView) * dirView; }
vec2 pixelOf(vec3 posView) {  // the pixel of a point in front of the camera
    return (posView.xy / spreadAt(-posView.z) - frame.ray.zw) / frame.ray.xy;
}
// Interleaved gradient noise (Jimenez 2014): 0..1, evenly spread over any 3x3 pixels.
float pixelNoise(vec2 pixel) { return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))); }
