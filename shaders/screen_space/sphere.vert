#include "shaders/render/frame.glsl"
#include "shaders/screen_space/particle.glsl"
flat out vec3 centreView;
void main() {
    centreView = (frame.view * vec4(particle.xyz, 1.0)).xyz;
    gl_Position = lost(particle) ? kNowhere : sphereQuad(centreView);
}
