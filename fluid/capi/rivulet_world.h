/* rivulet.h: worlds: particles in a box, with walls and bodies; steps, parameters, statistics, saved states. */
#ifndef RIVULET_WORLD_H
#define RIVULET_WORLD_H
/* NOLINTBEGIN(readability-identifier-naming): C's own way with names */

#include "rivulet_context.h"
#include "rivulet_solids.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct rivulet_world_options {
    size_t size;
    /* {"fluid": {...}, "emitters": [...], "sinks": [...], "dry": [...], "look": {...}}, as in a scene file; docs/parameters.md lists all
       keys. NULL: {} */
    const char* json;
    const rivulet_mesh* walls; /* in the world's frame; walls that move in their own frame */
    size_t walls_count;
    const rivulet_body* bodies;
    size_t bodies_count;
    const rivulet_body_host* body_host;
    /* Particles at t = 0, in addition to those of fluid.blocks: m, 3 each, inside fluid.box, about fluid.spacing apart. They are of the
       world's own liquid. Those inside a wall or body are left out, and the log reports their number. */
    const float* particles;
    const float* particle_velocities; /* m/s, 3 each; NULL: at rest */
    size_t particles_count;
    /* m^3 of water that drops of skins are expected to bring in 10 s: memory is reserved for it, see rivulet_world_step_skins. 0: the
       world's water and its skins do not mix. */
    double skins_bring;
} rivulet_world_options;

typedef struct rivulet_inputs {
    size_t size;
    const float* gravity;      /* m/s^2; NULL: fluid.gravity */
    const rivulet_pose* poses; /* of the walls that move, in the order of their ids, at the end of the frame; NULL: as given before; after a
                                  reset those of t = 0, after a restore those that were saved */
    size_t poses_count;
    /* Of the walls that deform, in the order of their ids, those too that are still being baked: the positions of all vertices at the end
       of the frame, m, in the world's frame; an entry that is NULL, or NULL itself: as before. Between, vertices move uniformly. */
    const float* const* shapes;
    size_t shapes_count;
} rivulet_inputs;

typedef struct rivulet_stats {
    size_t size;
    double time;                                    /* s simulated */
    double dropped;                                 /* s that were not simulated: frames longer than allowed */
    uint32_t particles, lost;                       /* in the world now; that left the grid or became not finite */
    double average_compression, kinetic, potential; /* a fraction; J */
    double maximum_speed;                           /* m/s */
    double centre_of_mass[3];                       /* m */
    int32_t substeps;                               /* in the last frame */
    uint32_t asleep;                                /* of the particles: see fluid.sleep in docs/parameters.md */
} rivulet_stats;

RIVULET_API rivulet_status rivulet_world_create(rivulet_context* context, const rivulet_world_options* options, rivulet_world** world,
                                                rivulet_error* why);
RIVULET_API void rivulet_world_destroy(rivulet_world* world);
/* Advances by a frame of `seconds`, in as many substeps as stability needs; 0 or less: nothing happens. `inputs` may be NULL.
   RIVULET_FAILED: memory ran out. The world keeps the substeps of the frame that were whole, as the time of its statistics says, and is
   valid; if there were none, nothing has changed, and the same call succeeds with the same results once memory is free.
   RIVULET_FAILED, after rivulet_context_stop: while a stop is asked a step does nothing, and the world stays as it was; a step that it
   interrupted leaves the world incomplete: then end the stop, and reset or restore the world before the next step. A callback that was left
   by longjmp leaves it incomplete, too; one that threw does not: its bodies stay where they are for the rest of the frame. */
RIVULET_API rivulet_status rivulet_world_step(rivulet_world* world, const rivulet_inputs* inputs, double seconds, rivulet_error* why);
RIVULET_API rivulet_status rivulet_world_reset(rivulet_world* world, rivulet_error* why);
/* Sets a parameter: "fluid.viscosity=0.01", "look.quality=fast", "emitters.0.litresPerSecond=2". A parameter that docs/parameters.md calls
   fixed is refused. */
RIVULET_API rivulet_status rivulet_world_set(rivulet_world* world, const char* assignment, rivulet_error* why);
/* Walls that come and go while the world runs. Those of rivulet_world_options have their index as id; `id` receives that of another one,
   which is greater than all before. A wall is baked beside the frames, on one core: 0.1 to 5 s. It acts from the step on before which its
   bake ended; particles that are inside it then are removed, and the log reports their number. The poses of rivulet_inputs are those of all
   walls that move, in the order of their ids, whether they are baked yet or not. A wall that stands still and was given at creation acts
   until the others of these are baked without it; all others end with the call. With fluid.wetness.on those that stay keep their wetness.
   A wall that the water does not meet only has an id. */
typedef enum rivulet_wall_state {
    RIVULET_WALL_BAKES = 0, /* it does not act yet */
    RIVULET_WALL_ACTS = 1,
    RIVULET_WALL_LEAVES = 2 /* it was removed, and acts until the others are baked */
} rivulet_wall_state;
RIVULET_API rivulet_status rivulet_world_add_wall(rivulet_world* world, const rivulet_mesh* wall, uint32_t* id, rivulet_error* why);
RIVULET_API rivulet_status rivulet_world_remove_wall(rivulet_world* world, uint32_t id, rivulet_error* why);
/* `state`: a rivulet_wall_state. RIVULET_FAILED: its bake failed, and why; it never acts. RIVULET_BAD_INPUT: there is no such wall. */
RIVULET_API rivulet_status rivulet_world_wall(const rivulet_world* world, uint32_t id, int32_t* state, rivulet_error* why);
/* Sets all emitters, sinks and dry volumes: {"emitters": [...], "sinks": [...], "dry": [...]}, as in the world's json; a list that is
   absent is empty. A dry volume, such as the inside of a boat, has no water: the picture is cut there, and particles in it are removed
   after each step. With `body`, a body's id, it moves with it. With another number of emitters or sinks than before, all emitters begin
   anew. Emitters spawn into free memory: fluid.maxParticles reserves it. RIVULET_BAD_INPUT: another number in a world with skins_bring
   above 0, or with fluid.grid linked_list. */
RIVULET_API rivulet_status rivulet_world_set_sources(rivulet_world* world, const char* json, rivulet_error* why);
/* On a GPU the values are two or three frames old. */
RIVULET_API rivulet_status rivulet_world_stats(const rivulet_world* world, rivulet_stats* stats, rivulet_error* why);

enum { RIVULET_ATTRIBUTES = 4 }; /* at most, of a world */
/* Copies the particles to host memory. Their order changes from step to step; ids do not. Arrays may be NULL. Waits for the device. */
typedef struct rivulet_particles {
    size_t size;
    size_t capacity;   /* of each array: no more are copied */
    float* positions;  /* m, 3 each */
    float* velocities; /* m/s, 3 each */
    float* densities;  /* over the rest density */
    uint32_t* ids;
    size_t count;                          /* out: the number of all particles, also where capacity is smaller */
    float* attributes[RIVULET_ATTRIBUTES]; /* 4 each: the values of fluid.attributes; NULL beyond them */
} rivulet_particles;
RIVULET_API rivulet_status rivulet_world_particles(rivulet_world* world, rivulet_particles* particles, rivulet_error* why);

/* The states of the bodies now, in the order of rivulet_world_body_ids; `count` must be their number. Without rivulet_body_host a GPU moves
   the bodies; then this call and rivulet_world_body wait for it, the steps do not. */
RIVULET_API rivulet_status rivulet_world_bodies(const rivulet_world* world, rivulet_body_state* states, size_t count, rivulet_error* why);
/* The same without waiting, for pictures: where a GPU moves the bodies, they are continued from their states two or three frames earlier,
   and a sudden blow shows as late; else they are exact. */
RIVULET_API rivulet_status rivulet_world_expected_bodies(const rivulet_world* world, rivulet_body_state* states, size_t count,
                                                         rivulet_error* why);
/* Bodies that come and go while the world runs, within the memory of fluid.bodies.maxSamples. Ids are as those of walls; those of
   rivulet_world_options have their index. A body with a mesh is made ready beside the frames, on one core. It enters the world at the first
   step after that; other bodies enter at once. Water inside its mesh is then removed, and the log reports the number of particles. The
   other bodies keep their states. After a reset it is where it was added; particles of t = 0 inside it are left out. A saved state can be
   restored where the same bodies are. RIVULET_BAD_INPUT: no room; inside a wall; as rivulet_world_create; a probe measures the removed one,
   or a dry volume moves with it. */
RIVULET_API rivulet_status rivulet_world_add_body(rivulet_world* world, const rivulet_body* body, uint32_t* id, rivulet_error* why);
RIVULET_API rivulet_status rivulet_world_remove_body(rivulet_world* world, uint32_t id, rivulet_error* why);
/* `inside`: 1 if it is in the world; 0: not yet, and state and load are as they were. These may be NULL; the load is of the last substep.
   RIVULET_FAILED: it could not be made ready or added, and why. RIVULET_BAD_INPUT: there is no such body. */
RIVULET_API rivulet_status rivulet_world_body(const rivulet_world* world, uint32_t id, int32_t* inside, rivulet_body_state* state,
                                              rivulet_body_load* load, rivulet_error* why);
/* The ids of the bodies in the world, at most `capacity`; `count`: of all. `ids` may be NULL. */
RIVULET_API rivulet_status rivulet_world_body_ids(const rivulet_world* world, uint32_t* ids, size_t capacity, size_t* count,
                                                  rivulet_error* why);

/* Saves and restores all that the next step depends on; on the cpu the restored run is bit-identical. */
RIVULET_API rivulet_status rivulet_world_save(rivulet_world* world, const char* path, rivulet_error* why);
RIVULET_API rivulet_status rivulet_world_restore(rivulet_world* world, const char* path, rivulet_error* why);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */
#endif
