// A photon's picture: a Gaussian, whose sum over the texels is 1. Blended by addition.
flat in vec3 light;
flat in float sigma;  // texels
in float size;        // texels
layout(location = 0) out vec4 colour;
void main() {
    vec2 at = (gl_PointCoord - 0.5) * size / sigma;
    colour = vec4(light * exp(-0.5 * dot(at, at)), 1.0);
}
