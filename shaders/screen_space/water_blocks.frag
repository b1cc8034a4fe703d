// Marks the blocks of 8 x 8 texels of the spheres' depth that contain water.
uniform sampler2D depths;  // m
layout(location = 0) out float water;
void main() {
    ivec2 first = 8 * ivec2(gl_FragCoord.xy), end = min(first + 8, textureSize(depths, 0));
    water = 0.0;
    for (int y = first.y; y < end.y && water == 0.0; ++y)
        for (int x = first.x; x < end.x && water == 0.0; ++x)
            if (texelFetch(depths, ivec2(x, y), 0).r < 1.0e5) water = 1.0;
}
