// Marks the tiles of the image that contain water or are adjacent to it: see water_blocks.frag.
uniform sampler2D blocks;
uniform vec2 perTile;  // texels of the spheres' depth along a tile's sides
layout(location = 0) out float marked;
void main() {
    vec2 low = floor(gl_FragCoord.xy) * perTile - 1.0, high = ceil(gl_FragCoord.xy) * perTile + 1.0;
    ivec2 first = max(ivec2(floor(low / 8.0)), ivec2(0)), last = min(ivec2(floor(high / 8.0)), textureSize(blocks, 0) - 1);
    marked = 0.0;
    for (int y = first.y; y <= last.y; ++y)
        for (int x = first.x; x <= last.x; ++x) marked = max(marked, texelFetch(blocks, ivec2(x, y), 0).r);
}
