// What every kernel that draws a flow into UV knows, and how its tables are laid out. Layout shared by C++, GLSL and OpenCL. Lengths in m,
// in the skin's frame. A map's texels come in tiles of 8 x 8; tiles in which no triangle lies are not kept.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
// What a texel shows: its triangle; how often the map's width and height, less one, are added to its own place to lie where the triangle's
// UVs do (they may be outside 0 to 1); and whether other skin is so near that a drop may lie on that instead.
#define TEXEL_NONE 0xFFFFFFFFu
#define TEXEL_TRIANGLE 0x07FFFFFFu
#define TEXEL_TURN_U 27u
#define TEXEL_TURN_V 29u
#define TEXEL_FOLD 0x80000000u
#define TILE_TEXELS 64u
// A tile: where it lies, in tiles, x | y << 16; its first piece and the one past its last; and where its texels begin. A piece is what
// hangs together on the skin. Texels are 64 uints of four bytes: which of the tile's words says what it shows, and of the film the three
// cells about it. Behind them how many words there are and how many blocks (from bit PACKED_BLOCKS), of one cell each or, with
// PACKED_FOURS, of four; then the words; then the first cell of each block, as flow/map_thick has them. A byte counts the blocks' cells. A
// texel without skin: the first byte is PACKED_NONE.
#define TILE_UINTS 4u
#define PACKED_NONE 255u
#define PACKED_BLOCKS 8u
#define PACKED_FOURS 0x80000000u
// A chart, 2 vec4 a triangle: how b1 and b2 grow with u and v, b1u b2u b1v b2v; u and v of its middle, and how near other skin is, m, where
// it was at rest. A pin of a piece, of which its bounds are made: a place; with PIN_PART the places of a triangle's corners and how much
// there is of each at least (in PIN_PARTS, from -PIN_MOST; 16 bits each); or with PIN_RECT a triangle with its turns and then a rectangle
// of texels, x | y << 13 | (width - 1) << 26 | (height - 1) << 29.
#define PIN_RECT 0x80000000u
#define PIN_PART 0x40000000u
#define PIN_MOST 7.0f
#define PIN_PARTS 4096.0f
// What a tile knows of drops, 16 uints. Behind all tiles: how many are to be drawn, and which.
#define NEAR_UINTS 16u
#define NEAR_DRAW 0u  /* bit 0: it is to be drawn; 1: all its rows; 4 to 7: where drops were when it was last drawn */
#define NEAR_HASH 1u  /* of the drops that were there when it was last drawn */
#define NEAR_WET 2u   /* bit 0: it had film then; 4 to 7: drops in its rows 0 and 1, 2 and 3 ... */
#define NEAR_COUNT 3u /* drops; above MOST_NEAR they are all looked at from NEAR_FIRST to before NEAR_END */
#define NEAR_FIRST 4u
#define NEAR_END 5u
#define NEAR_PLACE 6u  /* of the tile in the map, see TILE_UINTS */
#define NEAR_TEXELS 7u /* where its texels begin */
#define NEAR_LIST 8u   /* sorted numbers of MOST_NEAR drops */
#define MOST_NEAR 8u
#define WET_EVERY 16u /* draws: a wet tile is drawn anew that often, for what dries */
#define ANY_EVERY 64u /* and a dry one, for what a drop left that went too fast to be seen in between */
// Of the film's thickness two halves a uint, mm: where those of a triangle begin, which is the t-th, its cells from `first` on.
#define THICK_BEGIN(first, t) (2u * (((first) + (t)) >> 1u))
STRUCT(FlowMapStep) {
    vec4 gridOrigin;  // of the flow's grid, see fluid/world/step_params.h
    vec4 gridScale;
    int cellsX;
    int cellsY;
    int cellsZ;
    uint finer;     // cells of the sort to one of the grid's along x
    uint insideAt;  // index into cellStart: how many drops there are
    uint slots;     // of drops
    uint triangles;
    uint tiles;
    uint pieces;
    uint size;     // texels, of the map's edge
    uint draw;     // number of this one, from 1
    uint moved;    // 1: the skin has moved since the last
    float reach;   // m, radius of a drop's foot at most
    float trail;   // m, film as thick is as wet as can be
    float tap;     // m, from a texel to the places where it takes its film
    uint level;    // of the mip that is made
    uint levelAt;  // texels before it in the map
    uint aboveAt;  // and before the finer one
    uint stampAt;  // where the stamps of level 3 and above begin
    uint stampAbove;
    uint since;           // number of the flow's step that was drawn last
    uint levelTexels;     // of the mip that is made
    float contactRadius;  // of a drop, over the cube root of its volume
    float inverseCorner;  // s/m: one over the speed at which a drop's back becomes a corner
    float inverseReach;   // 1/m
    uint coverFrom;       // texels before those of which flow/map_mips has the cover
    uint unused1;
    uint unused2;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(FlowMapStep) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
