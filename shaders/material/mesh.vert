// A mesh's vertices in world space. PART: also the outputs for textures and skin. POSED: it moves with a body on the device.
#include "shaders/render/frame.glsl"
#if defined(POSED)
#include "shaders/material/posed.glsl"
#endif
layout(location = 0) in vec3 position;
#if defined(PART)
layout(location = 1) in vec4 normal;  // w: mean curvature, 1 / the mesh's unit
layout(location = 2) in vec3 uv;  // z: the longest edge at this vertex
uniform float scale;  // m per unit of the mesh
#if defined(LAYER)
uniform sampler2D layerMap;
out float gl_CullDistance[1];
#endif
out vec2 posUv;
out float curvature;  // 1/m
#else
layout(location = 1) in vec3 normal;
out vec3 posOwn;  // in the frame of the mesh
#endif
uniform mat4 toWorldMatrix;  // POSED: to the body's frame, as normalMatrix
uniform mat3 normalMatrix;
out vec3 posWorld;
out vec3 normalWorld;
// The depth pass draws the same vertices with another program, and what is drawn later must have its depth to the bit.
invariant gl_Position;
void main() {
#if defined(POSED)
    mat4 pose = poseMatrix();
    posWorld = (pose * (toWorldMatrix * vec4(position, 1.0))).xyz;
    normalWorld = mat3(pose) * (normalMatrix * normal.xyz);
#else
    posWorld = (toWorldMatrix * vec4(position, 1.0)).xyz;
    normalWorld = normalMatrix * normal.xyz;
#endif
#if defined(PART)
    posUv = uv.xy;
    curvature = normal.w / scale;
#if defined(LAYER) && defined(BLENDED)
    gl_CullDistance[0] = 1.0;  // blended meshes are drawn once, wet and dry together
#elif defined(LAYER)
    // A triangle with three dry corners is not drawn: the wetness is read from a mip that covers the area between them and the reach of
    // heights and shadows of drops.
    float lod = max(log2(max(0.7 * uv.z * float(textureSize(layerMap, 0).x), 1.0)), 3.0);
    vec4 around = textureLod(layerMap, uv.xy, lod);
    gl_CullDistance[0] = max(around.z, around.w) - 1.0e-6;
#endif
#else
    posOwn = position;
#endif
    gl_Position = frame.viewProjection * vec4(posWorld, 1.0);
}
