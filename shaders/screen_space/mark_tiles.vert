// Marks the tiles of the picture that a sphere's picture touches: a texel a tile.
#include "shaders/render/frame.glsl"
#include "shaders/screen_space/particle.glsl"
uniform vec2 tiles;  // how many
void main() {
    gl_Position = lost(particle) ? kNowhere : splatQuad(splatOf(particle));
    gl_Position.xy += (corner() - 0.5) * 2.0 / tiles * gl_Position.w;  // half a texel, so that a texel that is only grazed is drawn too
}
