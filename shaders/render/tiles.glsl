// Square glazed tiles with joints between them, each tile a little lighter or darker. Averaged over a pixel, so that they neither shimmer
// nor show moire far away.

// The integral from 0 to x of what is 1 within `wide` of the start of each unit interval.
vec2 jointsUpTo(vec2 x, float wide) { return floor(x) * wide + min(fract(x), wide); }

float tileShade(vec2 tile) {
    uvec2 k = uvec2(ivec2(tile) + 32768);
    uint h = (k.x * 1597334677u) ^ (k.y * 3812015801u);
    h = (h ^ (h >> 15)) * 2246822519u;
    return float((h >> 16) & 255u) / 255.0 - 0.5;
}

// At `p`, in sides of a tile: the share of joint in a pixel of size `pixel`; `shade`: how much lighter the tile is, a fraction.
float tileJoint(vec2 p, vec2 pixel, out float shade) {
    const float kJoint = 0.026;
    vec2 half_ = 0.5 * max(pixel, vec2(0.004));
    vec2 share = (jointsUpTo(p + half_, kJoint) - jointsUpTo(p - half_, kJoint)) / (2.0 * half_);
    shade = 0.16 * tileShade(floor(p)) * (1.0 - smoothstep(0.2, 0.8, max(pixel.x, pixel.y)));
    return 1.0 - (1.0 - share.x) * (1.0 - share.y);
}
