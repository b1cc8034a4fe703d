// A mesh's depth, from the camera or the light. HOLES: also passes uv, for cut-out materials.
layout(location = 0) in vec3 position;
#if defined(HOLES)
layout(location = 2) in vec3 uv;
out vec2 posUv;
#endif
uniform mat4 toClip;
void main() {
#if defined(HOLES)
    posUv = uv.xy;
#endif
    gl_Position = toClip * vec4(position, 1.0);
}
