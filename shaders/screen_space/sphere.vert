#include "shaders/render/frame.glsl"
#include "shaders/screen_space/particle.glsl"
#if defined(INK)
ROWS(3, absorptions)         // see FluidView
uniform vec4 ownAbsorption;  // 1/m; w: scattering
flat out vec4 ink;           // 1/m; w: scattering
flat out float other;        // 1: it is one of another liquid than the world's own
#endif
flat out float represented;  // particles by this one
flat out vec4 centreView;  // w: radius, of an ellipsoid that of the ball of its volume
#if defined(ELLIPSOIDS)
flat out mat3 shapeView;  // 1/m^2: 1 on the surface
#endif
void main() {
    gl_PointSize = 1.0;
    Splat s = splatOf(particle);
    float body = 1.0 - leaving(particle);
    s.squares *= body * body;
    centreView = vec4(s.centre, pow(determinant(s.squares), 1.0 / 6.0));
#if defined(ELLIPSOIDS)
    shapeView = inverse(s.squares);
#endif
#if defined(INK)
    vec4 absorption = texelFetch(absorptions, row());
    other = absorption.w < 0.0 ? 1.0 : 0.0;
    ink = absorption.w < 0.0 ? vec4(absorption.xyz, -1.0 - absorption.w) : absorption + ownAbsorption;
#endif
    represented = represents;
    gl_Position = lost(particle) || body < 0.02 ? kNowhere : splatQuad(s);
}
