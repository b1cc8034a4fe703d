// Thickness along the light, and thickness times depth; blended by addition.
uniform float radius;
uniform float volumeScale;
#if !defined(POINTS)
in vec2 inDisc;
#endif
flat in float depth;
layout(location = 0) out vec2 water;
void main() {
#if defined(POINTS)
    vec2 inDisc = gl_PointCoord * 2.0 - 1.0;
#endif
    float h2 = 1.0 - dot(inDisc, inDisc);
    if (h2 <= 0.0) discard;
    water = 2.0 * radius * volumeScale * sqrt(h2) * vec2(1.0, depth);
}
