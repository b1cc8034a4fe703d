// A photon's picture, as wide as its neighbours have spread.
uniform sampler2D landed;  // texels
uniform sampler2D flux;
uniform float most;        // texels, of a picture's size
flat out vec3 light;
flat out float sigma;  // texels
out float size;
const float kSigma = 0.62, kSizes = 6.5;  // texels: so wide, a level surface gives even light within 0.5 %; a picture's size in sigmas
void main() {
    ivec2 side = textureSize(landed, 0), here = ivec2(gl_VertexID % side.x, gl_VertexID / side.x), last = side - 1;
    vec2 p = texelFetch(landed, here, 0).rg;
    float spread = 1.0;
    for (int k = 0; k < 2; ++k) {
        ivec2 way = ivec2(1 - k, k);
        // To the nearer of both: what is torn apart does not fill the gap.
        float a = distance(p, texelFetch(landed, min(here + way, last), 0).rg), b = distance(p, texelFetch(landed, max(here - way, ivec2(0)), 0).rg);
        spread = max(spread, min(a, b));
    }
    sigma = min(kSigma * spread, most / kSizes);
    size = kSizes * sigma;
    light = texelFetch(flux, here, 0).rgb / (6.2831853 * sigma * sigma);
    gl_Position = vec4(p / vec2(side) * 2.0 - 1.0, 0.0, 1.0);
    gl_PointSize = size;
}
