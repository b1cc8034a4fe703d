#include "shaders/render/frame.glsl"
#include "shaders/screen_space/particle.glsl"
#include "shaders/screen_space/ramp.glsl"
layout(location = 1) in vec4 velocity;  // normal, surface: normals, w their length
layout(location = 2) in uint id;
uniform int colourBy;     // 0 speed, 1 density, 2 id, 3 normal, 4 surface
uniform float fullSpeed;  // m/s, the colour map's end
flat out vec4 centreView;  // w: radius
flat out vec3 baseColour;
void main() {
    centreView = vec4((frame.view * vec4(particle.xyz, 1.0)).xyz, drawnRadius(particle));
    gl_Position = lost(particle) ? kNowhere : sphereQuad(centreView.xyz, centreView.w);
    if (colourBy == 0) baseColour = ramp(length(velocity.xyz) / fullSpeed);
    else if (colourBy == 1) baseColour = ramp(0.5 + 5.0 * (particle.w - 1.0));  // 0.9 .. 1.1 of the rest density
    else if (colourBy == 3) baseColour = abs(velocity.xyz) / max(length(velocity.xyz), 1.0e-6);  // the thesis's (9)
    else if (colourBy == 4) baseColour = velocity.w > 0.5 ? vec3(0.05, 0.15, 0.9) : vec3(0.9, 0.75, 0.05);
    else baseColour = ramp(fract(float((id * 2654435769u) >> 8) / 16777216.0));
}
