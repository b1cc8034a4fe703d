// The edges of the fluid's box: 12 quads of a given width in pixels, 4 vertices each.
#include "shaders/render/frame.glsl"
uniform vec3 low, high;  // m
uniform float width;     // pixels
out float across;        // -1..1
out vec3 posView;
void main() {
    int axis = gl_InstanceID >> 2, k = gl_InstanceID & 3;
    vec3 from = vec3(0.0), along = vec3(0.0);
    along[axis] = 1.0;
    from[(axis + 1) % 3] = float(k & 1);
    from[(axis + 2) % 3] = float(k >> 1);
    vec3 a = (frame.view * vec4(mix(low, high, from), 1.0)).xyz, b = (frame.view * vec4(mix(low, high, from + along), 1.0)).xyz;
    float front = -2.0 * frame.planes.x;  // both ends are moved in front of the camera
    if (a.z > front && b.z > front) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); across = 0.0; posView = a; return; }
    if (a.z > front) a = mix(b, a, (front - b.z) / (a.z - b.z));
    if (b.z > front) b = mix(a, b, (front - a.z) / (b.z - a.z));
    vec2 dir = pixelOf(b) - pixelOf(a);
    dir = length(dir) > 1.0e-3 ? normalize(dir) : vec2(1.0, 0.0);
    posView = (gl_VertexID & 1) == 0 ? a : b;
    across = (gl_VertexID & 2) == 0 ? -1.0 : 1.0;
    vec4 clip = frame.projection * vec4(posView, 1.0);
    clip.xy += vec2(-dir.y, dir.x) * across * (0.5 * width + 0.5) * 2.0 * frame.viewport.zw * clip.w;
    gl_Position = clip;
}
