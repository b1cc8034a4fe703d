// The frame's uniform block and the geometry of its pixels. "Depth" is the distance along the view axis in metres, positive in front.
#include "shaders/render/frame.h"
layout(std140, binding = 0) uniform FrameBlock { FrameParams frame; };

const float kFar = 1.0e6;  // m, depth where nothing is visible

vec3 viewRay(vec2 pixel) { return vec3(pixel * frame.ray.xy + frame.ray.zw, -1.0); }
float depthOfWindow(float z) { return frame.planes.w / (2.0 * z - 1.0 + frame.planes.z); }
float windowOfDepth(float depth) { return 0.5 - 0.5 * frame.planes.z + 0.5 * frame.planes.w / depth; }
vec3 toWorld(vec3 posView) { return (frame.inverseView * vec4(posView, 1.0)).xyz; }
vec3 directionToWorld(vec3 dirView) { return mat3(frame.inverseView) * dirView; }
vec2 pixelOf(vec3 posView) {  // the pixel of a point in front of the camera
    return (posView.xy / -posView.z - frame.ray.zw) / frame.ray.xy;
}
// Interleaved gradient noise (Jimenez 2014): 0..1, evenly spread over any 3x3 pixels.
float pixelNoise(vec2 pixel) { return fract(52.9829189 * fract(dot(pixel, vec2(0.06711056, 0.00583715)))); }
