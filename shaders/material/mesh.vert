#include "shaders/render/frame.glsl"
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 toWorldMatrix;
uniform mat3 normalMatrix;
out vec3 posWorld;
out vec3 normalWorld;
void main() {
    posWorld = (toWorldMatrix * vec4(position, 1.0)).xyz;
    normalWorld = normalMatrix * normal;
    gl_Position = frame.viewProjection * vec4(posWorld, 1.0);
}
