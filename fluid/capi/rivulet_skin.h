/* rivulet.h: skins: drops and films on a mesh, and a map of them. */
#ifndef RIVULET_SKIN_H
#define RIVULET_SKIN_H
/* NOLINTBEGIN(readability-identifier-naming): C's own way with names */

#include "rivulet_world.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct rivulet_skin_options {
    size_t size;
    const rivulet_mesh* mesh; /* with uvs; their charts must not overlap: above 2 % a notice says how much does */
    const char* json;         /* the liquid: {"advancing": 60, ...}, as flow.N.liquid in docs/parameters.md; NULL: tears */
    int32_t map_size;         /* texels of the map's edge, a power of two; 0: 1024 */
} rivulet_skin_options;
typedef struct rivulet_skin_inputs {
    size_t size;
    const float* gravity;  /* m/s^2, in the world; NULL: (0, -9.81, 0) */
    const float* wind;     /* m/s; NULL: none */
    const float* to_world; /* the mesh's frame -> the world, a matrix without scale; NULL: identity */
    /* m, of all vertices of a mesh that deforms; NULL: as before. Drops on skin that leaves the box of the mesh's own positions by more
       than a quarter of the box's longest side stray and are counted as left: put what moves or turns the whole mesh into to_world. */
    const float* positions;
    /* The same for a mesh that the host deforms on the GPU, instead of `positions`: GL name of a buffer with a vec4 a vertex of the mesh,
       in its order, xyz m in the mesh's frame, w unused. 0: none. It is read during the call, after all commands issued before it: a memory
       barrier for the writes of a shader is included. Backend gl copies it on the GPU; cpu and cl read it back and so wait for the GPU.
       A vertex that is not finite, or 1000 km from 0 or farther, stays where it was. RIVULET_BAD_INPUT: `positions` is set too, the context
       has no OpenGL, or it is no buffer, too small, or mapped without GL_MAP_PERSISTENT_BIT. */
    uint32_t positions_buffer;
} rivulet_skin_inputs;
typedef struct rivulet_skin_stats {
    size_t size;
    uint64_t drops; /* on the skin now */
    double added, on_skin, left, evaporated,
        refused; /* m^3 since the start; on_skin: now, in drops and film; refused: no drop slot was free */
} rivulet_skin_stats;

RIVULET_API rivulet_status rivulet_skin_create(rivulet_context* context, const rivulet_skin_options* options, rivulet_skin** skin,
                                               rivulet_error* why);
RIVULET_API void rivulet_skin_destroy(rivulet_skin* skin);
/* Adds a drop, which appears with the next step, at the point of the skin nearest to `place` (m, in the mesh's frame), in the shape that
   the last step gave it. Of a skin that a GPU bends (`positions_buffer`), that shape is known as it was two or three steps ago, moved on
   with its velocity of then. Waits for such a skin's shape in the two or three steps after it was first asked for, by this function or by
   rivulet_world_step_skins, and where the GPU is 0.1 s behind; else it does not wait. */
RIVULET_API rivulet_status rivulet_skin_add(rivulet_skin* skin, const float* place, double microlitres, rivulet_error* why);
/* Advances the skin by `seconds`; 0 or less: nothing happens. RIVULET_FAILED after rivulet_context_stop: while a stop is asked, nothing is
   stepped. If the stop interrupts a step, the drops are not valid any more: destroy the skin and create another. */
RIVULET_API rivulet_status rivulet_skin_step(rivulet_skin* skin, const rivulet_skin_inputs* inputs, double seconds, rivulet_error* why);
/* Updates the map, a GL texture over the mesh's uvs, map_size x map_size, rgba16f with mips, which repeats: r, g the slope of the liquid's
   height (m a unit of u, of v), b the height (mm), a the wetness, 0 to 1. Texels without skin are 0. It shows the drops where the last step
   began; before the first step it is empty. Its name is valid until the skin is destroyed, its content until the next call. Commands that
   the host issues later in this OpenGL context see it without a barrier. RIVULET_BAD_INPUT: the context has no OpenGL. */
RIVULET_API rivulet_status rivulet_skin_texture(rivulet_skin* skin, uint32_t* texture, rivulet_error* why);
RIVULET_API rivulet_status rivulet_skin_stats_of(const rivulet_skin* skin, rivulet_skin_stats* stats,
                                                 rivulet_error* why); /* waits for the device */

/* Steps skins, as rivulet_skin_step does each, and the drops in the air between them, which belong to the world: what leaves a skin falls,
   lands on a skin that it meets, goes into the world's water or is lost below `floor`; particles of the world that come down on a skin
   become drops. After the world's step of the same `seconds`. Water is exchanged if rivulet_world_options.skins_bring is above 0; on a GPU
   two or three steps late, without waiting. It waits for the shape of a skin only as rivulet_skin_add does. rivulet_world_draw draws the
   drops in the air and those that hang from the skins, which the skins' maps then leave out. `skins`: of the world's context, others than
   in the last call if need be: drops in the air of a skin that is not among them are lost. `inputs`: an array with one entry for each
   skin; NULL: defaults. A world's reset or restore leaves skins and drops in the air as they are. RIVULET_FAILED: some skins and drops
   have been stepped, others not; all are valid unless a stop has interrupted the step. */
typedef struct rivulet_air {
    size_t size;
    const float* gravity;          /* m/s^2; NULL: fluid.gravity. That of `inputs` is not used */
    float floor;                   /* m */
    uint64_t drops;                /* out: in the air now */
    double in_air, lost;           /* out: m^3; in the air now, below the floor since the start */
    double into_water, from_water; /* out: m^3, since the start: from drops to the world's particles, and from those to drops */
} rivulet_air;
RIVULET_API rivulet_status rivulet_world_step_skins(rivulet_world* world, rivulet_skin* const* skins, const rivulet_skin_inputs* inputs,
                                                    size_t count, double seconds, rivulet_air* air, rivulet_error* why);
/* The drops in the air, for a host that draws them: 4 floats each, xyz m and radius m, of the first `capacity`; `count` receives their
   number. After them, on a GPU: balls of particles that came down on a skin in the last two or three steps. The world has been asked to
   give them up and has not answered yet; rivulet_air counts them once it has. */
RIVULET_API rivulet_status rivulet_world_air_drops(const rivulet_world* world, float* drops, size_t capacity, size_t* count,
                                                   rivulet_error* why);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */
#endif
