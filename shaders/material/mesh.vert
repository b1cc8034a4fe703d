// A mesh's vertices in the world. With PART: with what textures and skin need.
#include "shaders/render/frame.glsl"
layout(location = 0) in vec3 position;
#if defined(PART)
layout(location = 1) in vec4 normal;  // w: mean curvature, 1 / the mesh's unit
layout(location = 2) in vec2 uv;
uniform float scale;  // of the mesh's unit, m
#if defined(LAYER)
uniform sampler2D layerMap;
uniform float layerLod;  // a mip whose texels are as wide as the mesh's triangles
out float gl_CullDistance[1];
#endif
out vec2 posUv;
out float curvature;  // 1/m
#else
layout(location = 1) in vec3 normal;
#endif
uniform mat4 toWorldMatrix;
uniform mat3 normalMatrix;
out vec3 posWorld;
out vec3 normalWorld;
void main() {
    posWorld = (toWorldMatrix * vec4(position, 1.0)).xyz;
    normalWorld = normalMatrix * normal.xyz;
#if defined(PART)
    posUv = uv;
    curvature = normal.w / scale;
#if defined(LAYER)
    vec4 around = textureLod(layerMap, uv, layerLod);  // a triangle whose three corners are dry is not drawn
    gl_CullDistance[0] = max(around.z, around.w) - 1.0e-6;
#endif
#endif
    gl_Position = frame.viewProjection * vec4(posWorld, 1.0);
}
