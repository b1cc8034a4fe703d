// One instance per tile of the image: only tiles with water are drawn.
uniform sampler2D tileMask;
void main() {
    ivec2 tiles = textureSize(tileMask, 0), tile = ivec2(gl_InstanceID % tiles.x, gl_InstanceID / tiles.x);
    vec2 at = (vec2(tile) + vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1))) / vec2(tiles) * 2.0 - 1.0;
    gl_Position = texelFetch(tileMask, tile, 0).r > 0.0 ? vec4(at, 0.0, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
}
