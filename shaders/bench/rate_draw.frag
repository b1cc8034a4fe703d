// Reads of a texture in a fragment. READS: how many; the difference of two numbers is the time of the reads without the fragment.
// FILTERED 1: sampled between texels, four channels; 0: one texel, one channel.
uniform sampler2D source;  // as large as the target
out vec4 colour;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(source, 0) - 1;
    vec4 sum = gl_FragCoord;
    for (int k = 0; k < READS; ++k) {
#if FILTERED
        sum += texture(source, (vec2(pixel) + 0.3 * float(k)) / vec2(last));
#else
        sum.x += texelFetch(source, min(pixel + ivec2(k, -k & 3), last), 0).x;
#endif
    }
    colour = sum;
}
