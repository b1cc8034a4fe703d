#include "shaders/render/frame.glsl"
#include "shaders/screen_space/particle.glsl"
#if defined(INK)
layout(location = 3) in vec4 absorption;  // xyz 1/m, w share of ownAbsorption added
uniform vec3 ownAbsorption;               // 1/m
flat out vec3 ink;                        // 1/m
#endif
flat out float sprayed;
flat out vec4 centreView;  // w: radius, of an ellipsoid that of the ball of its volume
#if defined(ELLIPSOIDS)
flat out mat3 shapeView;  // 1/m^2: 1 on the surface
#endif
void main() {
    Splat s = splatOf(particle);
    centreView = vec4(s.centre, pow(determinant(s.squares), 1.0 / 6.0));
#if defined(ELLIPSOIDS)
    shapeView = inverse(s.squares);
#endif
#if defined(INK)
    ink = absorption.xyz + absorption.w * ownAbsorption;
#endif
    sprayed = spray(particle);
    gl_Position = lost(particle) ? kNowhere : splatQuad(s);
}
