// A photon's picture, as wide as its neighbours have spread: a pyramid, so that those of a level surface add up to even light. One that met
// no water stays where it was, in its own texel alone, and is not drawn here.
uniform sampler2D landed;  // texels
uniform sampler2D flux;    // w: 0: it met no water
uniform float most;        // texels, of a picture's size
flat out vec3 light;
flat out vec2 middle;  // texels
flat out float spread; // texels, half its width
void main() {
    ivec2 side = textureSize(landed, 0), here = ivec2(gl_VertexID % side.x, gl_VertexID / side.x), last = side - 1;
    vec4 own = texelFetch(flux, here, 0);
    gl_PointSize = 1.0;
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    light = vec3(0.0);
    middle = vec2(0.0);
    spread = 0.0;
    if (own.w == 0.0) return;
    middle = texelFetch(landed, here, 0).rg;
    spread = 1.0;
    for (int k = 0; k < 2; ++k) {
        ivec2 way = ivec2(1 - k, k);
        // To the nearer of both: what is torn apart does not fill the gap.
        float a = distance(middle, texelFetch(landed, min(here + way, last), 0).rg), b = distance(middle, texelFetch(landed, max(here - way, ivec2(0)), 0).rg);
        spread = max(spread, min(a, b));
    }
    spread = min(spread, 0.5 * most);
    light = own.rgb / (spread * spread);
    // Of a point, its corners are rounded to whole pixels on some drivers: one pixel more than is needed.
    gl_PointSize = 2.0 * spread + 1.0;
    gl_Position = vec4(middle / vec2(side) * 2.0 - 1.0, 0.0, 1.0);
}
