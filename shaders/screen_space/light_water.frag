// Thickness along the light, and thickness times depth; blended by addition.
uniform float radius;
uniform float volumeScale;
uniform vec2 pointTarget;  // as quads.glsl
in vec2 inDisc;
flat in float depth;
layout(location = 0) out vec2 water;
void main() {
    vec2 p = pointTarget.x > 0.0 ? gl_PointCoord * 2.0 - 1.0 : inDisc;
    float h2 = 1.0 - dot(p, p);
    if (h2 <= 0.0) discard;
    water = 2.0 * radius * volumeScale * sqrt(h2) * vec2(1.0, depth);
}
