// Blurs four texels along one axis, the size of the noise pattern of occlusion.frag, but not across depth edges.
uniform sampler2D source;  // openness, depth (m)
uniform ivec2 axis;
layout(location = 0) out vec2 openDepth;
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy), last = textureSize(source, 0) - 1;
    openDepth = texelFetch(source, here, 0).rg;
    float sum = openDepth.x, weights = 1.0;
    for (int k = -2; k < 2; ++k) {
        if (k == 0) continue;
        vec2 other = texelFetch(source, clamp(here + k * axis, ivec2(0), last), 0).rg;
        float w = max(1.0 - abs(other.y - openDepth.y) * 30.0 / openDepth.y, 0.0);
        sum += w * other.x;
        weights += w;
    }
    openDepth.x = sum / weights;
}
