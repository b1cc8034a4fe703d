#include "shaders/render/frame.glsl"
#include "shaders/screen_space/particle.glsl"
#include "shaders/screen_space/ramp.glsl"
ROWS(1, velocities)   // normal, surface: normals, w their length
ROWS(3, absorptions)  // see FluidView
uniform int colourBy;     // 0 speed, 1 density, 2 id, 3 dye, 4 normal, 5 surface, 6 sleep
uniform int alike;        // 1: all particles have ownAbsorption
uniform vec3 ownAbsorption;  // 1/m
uniform float dyeDepth;      // m, depth of liquid and dye that a sphere's colour represents
uniform float fullSpeed;  // m/s, upper end of the colour map
flat out vec4 centreView;  // w: radius
flat out vec3 baseColour;
void main() {
    gl_PointSize = 1.0;
    vec4 velocity = texelFetch(velocities, row()), absorption = alike == 1 ? vec4(0.0) : texelFetch(absorptions, row());
    uint id = texelFetch(ids, row()).r;
    centreView = vec4((frame.view * vec4(particle.xyz, 1.0)).xyz, drawnRadius(particle));
    gl_Position = lost(particle) ? kNowhere : splatQuad(splatOf(particle));
    if (colourBy == 0) baseColour = ramp(length(velocity.xyz) / fullSpeed);
    else if (colourBy == 1) baseColour = ramp(0.5 + 5.0 * (particle.w - 1.0));  // 0.9 .. 1.1 of the rest density
    else if (colourBy == 3) {
        vec3 a = (alike == 1 ? ownAbsorption : absorption.xyz + (absorption.w < 0.0 ? vec3(0.0) : ownAbsorption)) * dyeDepth;
        // A nearly opaque liquid keeps its hue.
        baseColour = 0.9 * exp(-(a - max(min(a.x, min(a.y, a.z)) - 1.0, 0.0)));
    }
    else if (colourBy == 4) baseColour = abs(velocity.xyz) / max(length(velocity.xyz), 1.0e-6);  // the thesis's (9)
    else if (colourBy == 5) baseColour = velocity.w > 0.5 ? vec3(0.05, 0.15, 0.9) : vec3(0.9, 0.75, 0.05);
    else if (colourBy == 6) baseColour = velocity.w < 0.0 ? vec3(0.05, 0.12, 0.45) : vec3(0.95, 0.55, 0.08);
    else baseColour = ramp(fract(float((id * 2654435769u) >> 8) / 16777216.0));
}
