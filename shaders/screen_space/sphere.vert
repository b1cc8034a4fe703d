#include "shaders/render/frame.glsl"
#include "shaders/screen_space/particle.glsl"
#if defined(INK)
layout(location = 3) in vec4 absorption;  // xyz 1/m, w share of ownAbsorption added
uniform vec3 ownAbsorption;               // 1/m
flat out vec3 ink;                        // 1/m
#endif
flat out float sprayed;
flat out vec4 centreView;  // w: radius
void main() {
    centreView = vec4((frame.view * vec4(particle.xyz, 1.0)).xyz, drawnRadius(particle));
#if defined(INK)
    ink = absorption.xyz + absorption.w * ownAbsorption;
#endif
    sprayed = spray(particle);
    gl_Position = lost(particle) ? kNowhere : sphereQuad(centreView.xyz, centreView.w);
}
