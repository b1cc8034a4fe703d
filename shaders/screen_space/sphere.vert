#include "shaders/render/frame.glsl"
#include "shaders/screen_space/particle.glsl"
flat out float sprayed;
flat out vec4 centreView;  // w: radius
void main() {
    centreView = vec4((frame.view * vec4(particle.xyz, 1.0)).xyz, drawnRadius(particle));
    sprayed = spray(particle);
    gl_Position = lost(particle) ? kNowhere : sphereQuad(centreView.xyz, centreView.w);
}
