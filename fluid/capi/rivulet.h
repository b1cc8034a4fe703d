/* rivulet.h: water in any engine that can call C.
 *
 *     rivulet_context* context = NULL;
 *     rivulet_context_options options = {.size = sizeof options, .find = (rivulet_find_function)glfwGetProcAddress};
 *     rivulet_context_create(&options, &context, &why);
 *     rivulet_world* world = NULL;
 *     rivulet_world_options scene = {.size = sizeof scene, .json = "{\"fluid\": {\"spacing\": 0.03, \"blocks\": [...]}}"};
 *     rivulet_world_create(context, &scene, &world, &why);
 *     each frame:  rivulet_world_step(world, NULL, 1.0 / 60, &why);
 *                  rivulet_world_draw(world, &view, &target, &why);
 *
 * Units are SI; +Y is up; matrices are 16 floats, column by column, as OpenGL takes them; places and vectors are 3 floats.
 *
 * Structs begin with `size`, which the caller sets to sizeof of it, also where the library fills the rest: so a program built against an
 * older header goes on working. In an array of such each begins its own size after the one before. Structs without it stand in arrays of
 * plain figures (poses, rays, samples, ...) and never change: what needs more gets another name. All that is 0 or NULL means its default.
 *
 * Every function that can fail returns a rivulet_status, and says why in `why`, which may be NULL: one sentence that names what, where and
 * the remedy. Nothing is thrown. A NULL handle is answered with RIVULET_BAD_INPUT; destroying NULL does nothing.
 *
 * Threads: a context, and all that is made of it, is used by one thread at a time; with OpenGL, by one on which the context that it was
 * created in is current. Contexts know nothing of each other: different threads may use different ones at once. Callbacks (log, bodies)
 * come on the thread that called, before the call returns, and must not call back into the same context: that is RIVULET_BAD_INPUT.
 *
 * OpenGL: each function that needs it (all with backend gl; else those that create, destroy and draw) finds the context current that it was
 * created in, or answers RIVULET_BAD_INPUT, and leaves every bit of its state as it was, but for glGetError, whose pending errors may be
 * gone, and for what is bound although it was deleted. Transform feedback, queries that count and conditional rendering must not be under
 * way. What is drawn is what rivulet_world_draw says. Worlds, skins and contexts go before the OpenGL context does: one that is not current
 * keeps them, and the log says so.
 */
#ifndef RIVULET_H
#define RIVULET_H
/* NOLINTBEGIN(readability-identifier-naming): C's own way with names */

#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define RIVULET_API __attribute__((visibility("default")))
#else
#define RIVULET_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Semantic versioning: within a major version, what works goes on working. */
#define RIVULET_VERSION_MAJOR 0
#define RIVULET_VERSION_MINOR 1
#define RIVULET_VERSION_PATCH 0
/* Of the library that runs, "0.1.0". */
RIVULET_API const char* rivulet_version(void);

typedef enum rivulet_status {
    RIVULET_OK = 0,
    RIVULET_FAILED = 1,   /* it could not be carried out: out of memory, no OpenGL 4.5, a file that cannot be written */
    RIVULET_BAD_INPUT = 2 /* what was asked makes no sense */
} rivulet_status;

typedef struct rivulet_error {
    char message[1024];
} rivulet_error;

typedef struct rivulet_context rivulet_context; /* a device that simulates, and where there is OpenGL what draws */
typedef struct rivulet_world rivulet_world;     /* particles in a box, among solids */
typedef struct rivulet_skin rivulet_skin;       /* drops and films on a mesh, and their map */

/* ---- Contexts ---- */

typedef void (*rivulet_function)(void);
typedef rivulet_function (*rivulet_find_function)(const char* name); /* glfwGetProcAddress, SDL_GL_GetProcAddress, eglGetProcAddress */
typedef enum rivulet_level { RIVULET_INFO = 0, RIVULET_NOTICE = 1, RIVULET_WARNING = 2, RIVULET_ERROR = 3 } rivulet_level;

typedef struct rivulet_context_options {
    size_t size;
    /* Finds OpenGL's functions in the context that is current. NULL: there is no OpenGL; worlds are simulated, nothing is drawn. */
    rivulet_find_function find;
    const char* backend; /* auto (NULL), cpu, gl or cl. auto: gl where OpenGL runs on a GPU, else cpu */
    const char* device;  /* of backend cl: its number or a part of its name; NULL: the first */
    void (*log)(void* user, rivulet_level level, const char* sentence); /* NULL: silent */
    void* log_user;
    /* Bytes that the device's buffers may take; as many its pictures; as many what a world of backend cpu or cl brings over to be drawn; as
       many a wall's voxels. What does not fit is RIVULET_FAILED. 0: no limit. */
    size_t memory_limit;
    float sky_horizon[3], sky_zenith[3]; /* what water mirrors, radiance in the target's units; all 0: a grey-blue sky */
    float sky_sun[3];                    /* towards the sun; all 0: as rivulet_view's light by default */
    float clouds;                        /* share of the sky that they cover, about */
} rivulet_context_options;

RIVULET_API rivulet_status rivulet_context_create(const rivulet_context_options* options, rivulet_context** context, rivulet_error* why);
/* Worlds and skins of it are destroyed first. */
RIVULET_API void rivulet_context_destroy(rivulet_context* context);
/* What simulates, "cpu: AMD EPYC, 2 threads"; valid as long as the context. */
RIVULET_API const char* rivulet_context_device(const rivulet_context* context);
/* Bytes in use now, of the device's buffers and of pictures. */
RIVULET_API size_t rivulet_context_memory(const rivulet_context* context);

/* What took how long: of the simulation since this was last called, of the drawing in the last frame that is known. A GPU's figures come
   two or three frames late. */
typedef struct rivulet_pass_time {
    char name[64];
    double ms;
    int32_t calls;
} rivulet_pass_time;
/* `count`, out: of the passes, were there room or not. */
RIVULET_API rivulet_status rivulet_context_times(rivulet_context* context, rivulet_pass_time* times, size_t capacity, size_t* count,
                                                 rivulet_error* why);

/* ---- Worlds ---- */

typedef struct rivulet_pose {
    float position[3]; /* m */
    float rotation[4]; /* unit quaternion, x y z w; all 0: none */
} rivulet_pose;

typedef struct rivulet_mesh {
    size_t size;
    const float* positions; /* m, 3 a vertex */
    size_t vertices;
    const uint32_t* indices; /* 3 a triangle */
    size_t indices_count;
    const float* uvs;   /* 2 a vertex; of skins */
    float friction;     /* of walls: Coulomb's coefficient; negative: as fluid.collision says */
    float restitution;  /* 0..1; negative: as fluid.collision says */
    uint32_t moves;     /* of walls: 1: it follows rivulet_inputs.poses as a whole, its own origin is what it turns about */
    int32_t resolution; /* voxels along its longest side; 0: a quarter of the fluid's spacing each */
    rivulet_pose pose;  /* of walls that move: at t = 0 */
} rivulet_mesh;

/* A body that floats: the fluid pushes it, and it the fluid. Its own frame has its origin at the centre of mass, its axes are the principal
   ones. */
typedef struct rivulet_body {
    size_t size;
    const float* samples; /* m, 3 each: places half a spacing under its surface, about a spacing apart */
    size_t samples_count;
    float mass;       /* kg; 0: it never moves */
    float inertia[3]; /* kg m^2 */
    float volume;     /* m^3 */
    rivulet_pose pose;
} rivulet_body;
typedef struct rivulet_body_state {
    rivulet_pose pose;
    float velocity[3], spin[3]; /* m/s; rad/s, in the world's axes */
} rivulet_body_state;
typedef struct rivulet_body_load {
    double force[3], torque[3]; /* N; N m about the centre of mass, in the world's axes */
} rivulet_body_load;
/* Who moves the bodies: a host's own rigid-body engine. NULL functions: bodies meet nothing but fluid. */
typedef struct rivulet_body_host {
    size_t size;
    void* user;
    /* Moves all bodies on by `seconds` under the loads, the host's own contacts and gravity (m/s^2). */
    void (*advance)(void* user, const rivulet_body_load* loads, const float* gravity, double seconds, rivulet_body_state* states,
                    size_t count);
    void (*reset)(void* user, const rivulet_body_state* states, size_t count); /* back to those of t = 0 */
} rivulet_body_host;

typedef struct rivulet_world_options {
    size_t size;
    /* {"fluid": {...}, "emitters": [...], "sinks": [...], "look": {...}}: as in a scene file; docs/parameters.md has every key. NULL: {} */
    const char* json;
    const rivulet_mesh* walls; /* in the world, or of those that move in their own frame */
    size_t walls_count;
    const rivulet_body* bodies;
    size_t bodies_count;
    const rivulet_body_host* body_host;
} rivulet_world_options;

typedef struct rivulet_inputs {
    size_t size;
    const float* gravity;      /* m/s^2; NULL: as fluid.gravity says */
    const rivulet_pose* poses; /* of the walls that move, in their order, at the frame's end; NULL: as given before, at first and after a
                                  reset those of t = 0, after a restore those that were saved */
    size_t poses_count;
} rivulet_inputs;

typedef struct rivulet_stats {
    size_t size;
    double time;                                    /* s simulated */
    double dropped;                                 /* s asked for that were not simulated: a frame longer than allowed */
    uint32_t particles, lost;                       /* there now; that left the grid or are not finite */
    double average_compression, kinetic, potential; /* a fraction; J */
    double maximum_speed;                           /* m/s */
    double centre_of_mass[3];                       /* m */
    int32_t substeps;                               /* of the last frame */
} rivulet_stats;

RIVULET_API rivulet_status rivulet_world_create(rivulet_context* context, const rivulet_world_options* options, rivulet_world** world,
                                                rivulet_error* why);
RIVULET_API void rivulet_world_destroy(rivulet_world* world);
/* A frame of `seconds`, in as many substeps as are stable; 0 or less: nothing happens. `inputs` may be NULL. */
RIVULET_API rivulet_status rivulet_world_step(rivulet_world* world, const rivulet_inputs* inputs, double seconds, rivulet_error* why);
RIVULET_API rivulet_status rivulet_world_reset(rivulet_world* world, rivulet_error* why);
/* "fluid.viscosity=0.01", "look.quality=fast", "emitters.0.litresPerSecond=2". What is fixed while a world lives is refused. */
RIVULET_API rivulet_status rivulet_world_set(rivulet_world* world, const char* assignment, rivulet_error* why);
/* Two or three frames late on a GPU. */
RIVULET_API rivulet_status rivulet_world_stats(const rivulet_world* world, rivulet_stats* stats, rivulet_error* why);

/* The particles, in host memory: those that are there, at most `capacity`, in no order that lasts: ids do. Arrays may be NULL. Waits. */
typedef struct rivulet_particles {
    size_t size;
    size_t capacity;   /* of each array */
    float* positions;  /* m, 3 each */
    float* velocities; /* m/s, 3 each */
    float* densities;  /* density over rest density */
    uint32_t* ids;
    size_t count; /* out: of the particles, were there room or not */
} rivulet_particles;
RIVULET_API rivulet_status rivulet_world_particles(rivulet_world* world, rivulet_particles* particles, rivulet_error* why);

/* How the bodies stand now, in their order; `count`: as many as there are. */
RIVULET_API rivulet_status rivulet_world_bodies(const rivulet_world* world, rivulet_body_state* states, size_t count, rivulet_error* why);

/* All that the next step depends on, into a file, and back; on the cpu bit for bit. */
RIVULET_API rivulet_status rivulet_world_save(rivulet_world* world, const char* path, rivulet_error* why);
RIVULET_API rivulet_status rivulet_world_restore(rivulet_world* world, const char* path, rivulet_error* why);

/* ---- What a game asks ---- */

/* The water at places (m, 3 each); the field of the particles as they are now. Waits. */
typedef struct rivulet_sample {
    float density;     /* over the rest density; 0 in the air */
    float velocity[3]; /* m/s; 0 in the air */
    float gradient[3]; /* 1/m, of density: points into the water */
} rivulet_sample;
RIVULET_API rivulet_status rivulet_world_sample(rivulet_world* world, const float* places, size_t count, rivulet_sample* samples,
                                                rivulet_error* why);

/* Where rays first cross the water's surface. Waits. */
typedef struct rivulet_ray {
    float origin[3], direction[3]; /* m; of any length: without one it misses */
    float reach;                   /* m; 0: without end */
} rivulet_ray;
typedef struct rivulet_hit {
    uint32_t hit, inside;                   /* 1: it hits; it began in water, and this is where it comes out */
    float distance;                         /* m */
    float place[3], normal[3], velocity[3]; /* m; unit, out of the water; m/s */
} rivulet_hit;
RIVULET_API rivulet_status rivulet_world_cast(rivulet_world* world, const rivulet_ray* rays, size_t count, rivulet_hit* hits,
                                              rivulet_error* why);
/* y (m) of the highest surface at each x, z (2 floats each); NaN where there is no water. Waits. */
RIVULET_API rivulet_status rivulet_world_heights(rivulet_world* world, const float* places, size_t count, float* heights,
                                                 rivulet_error* why);

/* Volumes to watch, 32 at most, each with an id of the host's own: what has entered, what has left, what is there. */
typedef enum rivulet_shape { RIVULET_BOX = 0, RIVULET_SPHERE = 1 } rivulet_shape;
typedef struct rivulet_volume {
    uint32_t id;
    int32_t shape;     /* a rivulet_shape */
    float position[3]; /* m, its centre */
    float size[3];     /* m, of a box */
    float radius;      /* m, of a sphere */
} rivulet_volume;
typedef struct rivulet_volume_count {
    uint32_t id;
    uint64_t entered, left, inside; /* particles; inside = entered - left, since the volume was set */
    double time;                    /* s simulated: when it was so; two or three frames late on a GPU */
    double volume_inside;           /* m^3 */
} rivulet_volume_count;
RIVULET_API rivulet_status rivulet_world_set_volumes(rivulet_world* world, const rivulet_volume* volumes, size_t count, rivulet_error* why);
RIVULET_API rivulet_status rivulet_world_volumes(rivulet_world* world, rivulet_volume_count* counts, size_t capacity, size_t* count,
                                                 rivulet_error* why);
/* Of those where something has come or gone since this was last called: entered and left since then. Room for 32. */
RIVULET_API rivulet_status rivulet_world_volume_events(rivulet_world* world, rivulet_volume_count* counts, size_t capacity, size_t* count,
                                                       rivulet_error* why);

/* ---- Files ---- */

/* The particles as .ply, .vtp (ParaView) or .csv; the water's surface as .obj or .ply. By the path's ending; +Y up, metres. */
RIVULET_API rivulet_status rivulet_world_export(rivulet_world* world, const char* path, rivulet_error* why);
RIVULET_API rivulet_status rivulet_world_export_surface(rivulet_world* world, const char* path, rivulet_error* why);

/* ---- Drawing ---- */

typedef struct rivulet_view {
    size_t size;
    const float* view;       /* world -> view, right-handed, looking down -z */
    const float* projection; /* a perspective, as the target's depth was drawn with: any of glClipControl's depth modes, reversed or not */
    float near_plane, far_plane; /* m, finite, and between them what matters */
    float light_direction[3];    /* towards the light; all 0: (0.4, 0.8, 0.45) */
    float light_colour[3];       /* radiance in the target's units; all 0: 1 */
} rivulet_view;

typedef enum rivulet_colours {
    RIVULET_AUTOMATIC = 0, /* linear where they are floats, else sRGB */
    RIVULET_LINEAR = 1,    /* radiance, which the host tonemaps later */
    RIVULET_SRGB = 2       /* as a screen shows them, 1 is white */
} rivulet_colours;

typedef struct rivulet_target {
    size_t size;
    uint32_t framebuffer;        /* GL name, 0: the window; its colour and depth hold the scene as drawn so far */
    int32_t x, y, width, height; /* pixels */
    int32_t colours;             /* a rivulet_colours */
} rivulet_target;

/* Draws the water over what the target holds: what is nearer hides it, what is farther is seen through it. Colour and depth change where
   there is water, and nowhere else. */
RIVULET_API rivulet_status rivulet_world_draw(rivulet_world* world, const rivulet_view* view, const rivulet_target* target,
                                              rivulet_error* why);

/* Particles as OpenGL buffers, to be drawn by the host: places are those of the time asked for, with fluid.fixedStep between steps. Valid
   until the world's next step. */
typedef struct rivulet_buffers {
    size_t size;
    uint32_t position; /* GL name; vec4 each: xyz m, w density over rest density, negative: not a particle */
    uint32_t velocity; /* GL name; vec4 each: xyz m/s */
    uint32_t id;       /* GL name; uint each */
    uint32_t count;    /* rows */
    float radius;      /* m, of a drawn sphere */
} rivulet_buffers;
RIVULET_API rivulet_status rivulet_world_buffers(rivulet_world* world, rivulet_buffers* buffers, rivulet_error* why);

/* ---- Skins ---- */

typedef struct rivulet_skin_options {
    size_t size;
    const rivulet_mesh* mesh; /* with uvs, whose charts must not overlap */
    const char* json;         /* what flows: {"advancing": 60, ...}, as flow.N.liquid in docs/parameters.md; NULL: tears */
    int32_t map_size;         /* texels of the map's edge, a power of two; 0: 1024 */
} rivulet_skin_options;
typedef struct rivulet_skin_inputs {
    size_t size;
    const float* gravity;   /* m/s^2, in the world; NULL: (0, -9.81, 0) */
    const float* wind;      /* m/s; NULL: none */
    const float* to_world;  /* the mesh's frame -> the world, a matrix without scale; NULL: the same */
    const float* positions; /* m, where the mesh bends: as many as it has vertices; NULL: as it was */
} rivulet_skin_inputs;
typedef struct rivulet_skin_stats {
    size_t size;
    uint64_t drops;                                   /* there now */
    double added, on_skin, left, evaporated, refused; /* m^3 since the start; on_skin: now, as drops and film */
} rivulet_skin_stats;

RIVULET_API rivulet_status rivulet_skin_create(rivulet_context* context, const rivulet_skin_options* options, rivulet_skin** skin,
                                               rivulet_error* why);
RIVULET_API void rivulet_skin_destroy(rivulet_skin* skin);
/* A drop that appears with the next step at the point of the skin nearest to `place` (m, the mesh's frame); microlitres. */
RIVULET_API rivulet_status rivulet_skin_add(rivulet_skin* skin, const float* place, double microlitres, rivulet_error* why);
RIVULET_API rivulet_status rivulet_skin_step(rivulet_skin* skin, const rivulet_skin_inputs* inputs, double seconds, rivulet_error* why);
/* Brings the map up to date: a GL texture over the mesh's uvs, rgba16f with mips: r, g the slope of the liquid's height (m a unit of u, of
   v), b the height (mm), a how wet, 0 to 1. */
RIVULET_API rivulet_status rivulet_skin_texture(rivulet_skin* skin, uint32_t* texture, rivulet_error* why);
RIVULET_API rivulet_status rivulet_skin_stats_of(const rivulet_skin* skin, rivulet_skin_stats* stats, rivulet_error* why); /* waits */

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */
#endif
