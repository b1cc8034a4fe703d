// The parameter block of the kernels that draw a flow into UV, and the layout of its tables. Shared by C++, GLSL and OpenCL. Lengths in m,
// in the skin's frame. A map's texels are stored in tiles of 8 x 8; tiles without a triangle are not stored.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
// The word of a texel: its triangle; the number of map widths and heights, minus one, to add to its position to reach the UVs of the
// triangle (which may be outside 0 to 1); and whether other skin is so near that a drop may lie on that instead.
#define TEXEL_NONE 0xFFFFFFFFu
#define TEXEL_TRIANGLE 0x07FFFFFFu
#define TEXEL_TURN_U 27u
#define TEXEL_TURN_V 29u
#define TEXEL_FOLD 0x80000000u
#define TILE_TEXELS 64u
// A tile: its position in tiles, x | y << 16; its first piece and the one past its last; and the offset of its texels. A piece is a
// connected part of the skin. Texels are 64 uints of four bytes: the index of the word that the texel shows, and the three cells of the
// film around it. They are followed by the number of words and of blocks (from bit PACKED_BLOCKS), of one cell each or, with PACKED_FOURS,
// of four; then the words; then the first cell of each block, as in flow/map_thick. A byte is an index into the cells of the blocks. A
// texel without skin has the first byte PACKED_NONE.
#define TILE_UINTS 4u
#define PACKED_NONE 255u
#define PACKED_BLOCKS 8u
#define PACKED_FOURS 0x80000000u
// A chart, 2 vec4 per triangle: the derivatives of b1 and b2 by u and v, b1u b2u b1v b2v; u and v of its centre, and the distance of other
// skin at rest, m. A pin of a piece, from which its bounds are computed: a place; with PIN_PART the places of the corners of a triangle and
// their minimum weights (in PIN_PARTS, from -PIN_MOST; 16 bits each); or with PIN_RECT a triangle with its turns and a rectangle
// of texels, x | y << 13 | (width - 1) << 26 | (height - 1) << 29.
#define PIN_RECT 0x80000000u
#define PIN_PART 0x40000000u
#define PIN_MOST 7.0f
#define PIN_PARTS 4096.0f
// The drops of a tile, 16 uints. After all tiles: the number of tiles to draw, and their indices.
#define NEAR_UINTS 16u
#define NEAR_DRAW 0u  /* bit 0: it must be drawn; 1: all its rows; 4 to 7: where drops were when it was last drawn */
#define NEAR_HASH 1u  /* of the drops that were there when it was last drawn */
#define NEAR_WET 2u   /* bit 0: it had film then; 4 to 7: drops in its rows 0 and 1, 2 and 3 ... */
#define NEAR_COUNT 3u /* drops; above MOST_NEAR they are all looked at from NEAR_FIRST to before NEAR_END */
#define NEAR_FIRST 4u
#define NEAR_END 5u
#define NEAR_PLACE 6u  /* of the tile in the map, see TILE_UINTS */
#define NEAR_TEXELS 7u /* where its texels begin */
#define NEAR_LIST 8u   /* sorted numbers of MOST_NEAR drops */
#define MOST_NEAR 8u
#define WET_EVERY 16u /* draws: interval at which a wet tile is drawn again, because it dries */
#define ANY_EVERY 64u /* and a dry one, for what a drop left that went too fast to be seen in between */
// A drop as it is drawn, 3 vec4: the ball about its foot, m; xyz along its way, as long as how far off the ball's middle the widest line of
// its foot is, a share of the radius, w its height m; and how its back narrows, see map_drop.h;
// its w times 1 - t^2 is never less than q.
#define CAP_VECS 3u
// The film's thickness, two half floats per uint, mm: the offset of a triangle's cells, of which the t-th begins at `first`.
#define THICK_BEGIN(first, t) (2u * (((first) + (t)) >> 1u))
STRUCT(FlowMapStep) {
    vec4 gridOrigin;  // as in fluid/world/step_params.h, for the flow's grid
    vec4 gridScale;
    int cellsX;
    int cellsY;
    int cellsZ;
    uint finer;     // cells of the sort per cell of the grid along x
    uint insideAt;  // index into cellStart: the number of drops
    uint slots;     // number of drop slots
    uint triangles;
    uint tiles;
    uint pieces;
    uint size;     // texels, edge of the map
    uint draw;     // number of this draw, from 1
    uint moved;    // 1: the skin has moved since the last draw
    float reach;   // m, maximum radius of a drop's foot
    float trail;   // m, thickness of a film of wetness 1
    float tap;     // m, distance from a texel to the points where it samples the film
    uint level;    // level of the mip that is computed
    uint levelAt;  // texels before it in the map
    uint aboveAt;  // texels before the finer level
    uint stampAt;  // offset of the stamps of level 3 and above
    uint stampAbove;
    uint since;           // number of the flow's step in the last draw
    uint levelTexels;     // texels of the mip that is computed
    float contactRadius;  // radius of a drop's foot over the cube root of its volume
    float inverseCorner;  // s/m: 1 / the speed at which a drop's back becomes a corner
    float inverseReach;   // 1/m
    uint coverFrom;       // texels before those whose cover flow/map_mips stores
    float advancing;      // rad, contact angles
    float receding;
    float hangsApart;  // 1: drops that hang are drawn as such elsewhere, and only their feet here
    uint unused1;
    uint unused2;
    uint unused3;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(FlowMapStep) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
