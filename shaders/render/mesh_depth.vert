// A mesh's depth, from the camera or the light. HOLES: also passes uv, for cut-out materials. POSED: it moves with a body on the device.
layout(location = 0) in vec3 position;
#if defined(HOLES)
layout(location = 2) in vec3 uv;
out vec2 posUv;
#endif
#if defined(POSED)
#include "shaders/material/posed.glsl"
uniform mat4 toWorldMatrix;  // to the body's frame
#endif
uniform mat4 toClip;  // POSED: from the world
void main() {
#if defined(HOLES)
    posUv = uv.xy;
#endif
#if defined(POSED)
    gl_Position = toClip * (poseMatrix() * (toWorldMatrix * vec4(position, 1.0)));
#else
    gl_Position = toClip * vec4(position, 1.0);
#endif
}
