// Thickness along the light (added up) and the water's nearest depth (minimum).
uniform float radius;
uniform float volumeScale;
in vec2 inDisc;
flat in float nearest;
layout(location = 0) out float thickness;
layout(location = 1) out float depth;
void main() {
    float h2 = 1.0 - dot(inDisc, inDisc);
    if (h2 <= 0.0) discard;
    thickness = 2.0 * radius * volumeScale * sqrt(h2);
    depth = nearest;
}
