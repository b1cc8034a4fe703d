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
 * Units are SI and +Y is up. A matrix is 16 floats, column by column, as in OpenGL; a place or a vector is 3 floats.
 *
 * Versions: a struct that begins with `size` may grow. The caller sets it to sizeof the struct, also where the library fills the rest, so a
 * program that was built against an older header still works. In an array of such structs each one begins its own size after the one
 * before. Structs without `size` (poses, rays, samples, ...) never change: an extension gets a new name. A member that is 0 or NULL has its
 * default.
 *
 * Errors: every function that can fail returns a rivulet_status and writes one sentence into `why`, which may be NULL: what is wrong,
 * where, and the remedy. Nothing is thrown. A NULL handle gives RIVULET_BAD_INPUT; destroying NULL does nothing.
 *
 * Threads: one thread at a time uses a context and everything made from it; with OpenGL, a thread on which the context's OpenGL context is
 * current. Contexts are independent: different threads may use different ones at the same time. Callbacks (log, bodies) run on the calling
 * thread, before the call returns. A callback that calls back into the same context gets RIVULET_BAD_INPUT.
 *
 * OpenGL: functions that need it are all with backend gl, else those that create, destroy and draw. They return RIVULET_BAD_INPUT if the
 * OpenGL context of their rivulet_context is not current. They restore all OpenGL state, with two exceptions: pending errors of glGetError
 * may be cleared, and an object that was deleted while bound is unbound. Transform feedback, counting queries and conditional rendering
 * must not be active. Only rivulet_world_draw draws. Destroy worlds, skins and contexts before the OpenGL context: if it is not current,
 * destruction is refused and logged.
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

/* Semantic versioning: a program that works with a version works with later ones of the same major version. */
#define RIVULET_VERSION_MAJOR 0
#define RIVULET_VERSION_MINOR 1
#define RIVULET_VERSION_PATCH 0
/* The version of the loaded library, "0.1.0". */
RIVULET_API const char* rivulet_version(void);

typedef enum rivulet_status {
    RIVULET_OK = 0,
    RIVULET_FAILED = 1,   /* not possible now: out of memory, no OpenGL 4.5, a file that cannot be written */
    RIVULET_BAD_INPUT = 2 /* an argument or the order of calls is wrong */
} rivulet_status;

typedef struct rivulet_error {
    char message[1024];
} rivulet_error;

typedef struct rivulet_context rivulet_context; /* a device that simulates and, with OpenGL, a renderer */
typedef struct rivulet_world rivulet_world;     /* particles in a box, with walls and bodies */
typedef struct rivulet_skin rivulet_skin;       /* drops and films on a mesh, and a map of them */

/* ---- Contexts ---- */

typedef void (*rivulet_function)(void);
typedef rivulet_function (*rivulet_find_function)(const char* name); /* glfwGetProcAddress, SDL_GL_GetProcAddress, eglGetProcAddress */
typedef enum rivulet_level { RIVULET_INFO = 0, RIVULET_NOTICE = 1, RIVULET_WARNING = 2, RIVULET_ERROR = 3 } rivulet_level;

typedef struct rivulet_context_options {
    size_t size;
    /* Finds OpenGL's functions in the current OpenGL context. NULL: no OpenGL; worlds are simulated and cannot be drawn. */
    rivulet_find_function find;
    const char* backend; /* auto (NULL), cpu, gl or cl. auto: gl if OpenGL runs on a GPU, else cpu */
    const char* device;  /* for backend cl: its number or a part of its name; NULL: the first */
    void (*log)(void* user, rivulet_level level, const char* sentence); /* NULL: silent */
    void* log_user;
    /* A limit in bytes, applied to each of: the device's buffers, the renderer's images, what a world of backend cpu or cl copies to
       OpenGL, the voxels of one wall. A call that would exceed it returns RIVULET_FAILED. 0: no limit. */
    size_t memory_limit;
    float sky_horizon[3], sky_zenith[3]; /* reflected by the water, radiance in the target's units; all 0: a grey-blue sky */
    float sky_sun[3];                    /* towards the sun; all 0: the default light direction of rivulet_view */
    float clouds;                        /* share of the sky that they cover, 0 to 1, approximate */
} rivulet_context_options;

RIVULET_API rivulet_status rivulet_context_create(const rivulet_context_options* options, rivulet_context** context, rivulet_error* why);
/* Destroy its worlds and skins first: a context that still has some stays, and the log says so. */
RIVULET_API void rivulet_context_destroy(rivulet_context* context);
/* The device that simulates, "cpu: AMD EPYC, 2 threads"; valid as long as the context. */
RIVULET_API const char* rivulet_context_device(const rivulet_context* context);
/* Bytes in use now by the device's buffers and by images. */
RIVULET_API size_t rivulet_context_memory(const rivulet_context* context);

/* Times of the passes: the simulation's since the last call of rivulet_context_times, the drawing's in the last frame with known times. A
   GPU's times arrive two or three frames late. */
typedef struct rivulet_pass_time {
    char name[64];
    double ms;
    int32_t calls;
} rivulet_pass_time;
/* `count` receives the number of all passes, also where `capacity` is smaller. */
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
    const float* uvs;   /* 2 a vertex; for skins */
    float friction;     /* of a wall: Coulomb's coefficient; negative: that of fluid.collision */
    float restitution;  /* of a wall: 0 to 1; negative: that of fluid.collision */
    uint32_t moves;     /* of a wall: 1: moves rigidly with rivulet_inputs.poses and turns about its own origin; 0: stands still */
    int32_t resolution; /* of a wall: voxels along its longest side; 0: voxels of a quarter of the fluid's spacing */
    rivulet_pose pose;  /* of a wall that moves: at t = 0 */
} rivulet_mesh;

/* A floating body, coupled to the fluid both ways. The origin of its frame is its centre of mass, its axes are the principal axes. */
typedef struct rivulet_body {
    size_t size;
    const float* samples; /* m, 3 each: points half a spacing below its surface, about a spacing apart */
    size_t samples_count;
    float mass;       /* kg; 0: the body is fixed */
    float inertia[3]; /* kg m^2 */
    float volume;     /* m^3 */
    rivulet_pose pose;
} rivulet_body;
typedef struct rivulet_body_state {
    rivulet_pose pose;
    float velocity[3], spin[3]; /* m/s; rad/s; in world axes */
} rivulet_body_state;
typedef struct rivulet_body_load {
    double force[3], torque[3]; /* N; N m about the centre of mass; in world axes */
} rivulet_body_load;
/* The host's rigid-body engine, which moves the bodies. NULL functions: bodies collide with nothing but fluid. */
typedef struct rivulet_body_host {
    size_t size;
    void* user;
    /* Advances all bodies by `seconds` under the loads, gravity (m/s^2) and the host's own contacts. Called once a substep. */
    void (*advance)(void* user, const rivulet_body_load* loads, const float* gravity, double seconds, rivulet_body_state* states,
                    size_t count);
    void (*reset)(void* user, const rivulet_body_state* states,
                  size_t count); /* sets the bodies to these states: those of t = 0 after a reset */
} rivulet_body_host;

typedef struct rivulet_world_options {
    size_t size;
    /* {"fluid": {...}, "emitters": [...], "sinks": [...], "look": {...}}, as in a scene file; docs/parameters.md lists all keys. NULL: {}
     */
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
} rivulet_world_options;

typedef struct rivulet_inputs {
    size_t size;
    const float* gravity;      /* m/s^2; NULL: fluid.gravity */
    const rivulet_pose* poses; /* of the walls that move, in their order, at the end of the frame; NULL: as given before; after a reset
                                  those of t = 0, after a restore those that were saved */
    size_t poses_count;
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
} rivulet_stats;

RIVULET_API rivulet_status rivulet_world_create(rivulet_context* context, const rivulet_world_options* options, rivulet_world** world,
                                                rivulet_error* why);
RIVULET_API void rivulet_world_destroy(rivulet_world* world);
/* Advances by a frame of `seconds`, in as many substeps as stability needs; 0 or less: nothing happens. `inputs` may be NULL. */
RIVULET_API rivulet_status rivulet_world_step(rivulet_world* world, const rivulet_inputs* inputs, double seconds, rivulet_error* why);
RIVULET_API rivulet_status rivulet_world_reset(rivulet_world* world, rivulet_error* why);
/* Sets a parameter: "fluid.viscosity=0.01", "look.quality=fast", "emitters.0.litresPerSecond=2". A parameter that docs/parameters.md calls
   fixed is refused. */
RIVULET_API rivulet_status rivulet_world_set(rivulet_world* world, const char* assignment, rivulet_error* why);
/* On a GPU the values are two or three frames old. */
RIVULET_API rivulet_status rivulet_world_stats(const rivulet_world* world, rivulet_stats* stats, rivulet_error* why);

/* Copies the particles to host memory, at most `capacity`. Their order changes from step to step; ids do not. Arrays may be NULL. Waits for
   the device. */
typedef struct rivulet_particles {
    size_t size;
    size_t capacity;   /* of each array */
    float* positions;  /* m, 3 each */
    float* velocities; /* m/s, 3 each */
    float* densities;  /* over the rest density */
    uint32_t* ids;
    size_t count; /* out: the number of all particles, also where capacity is smaller */
} rivulet_particles;
RIVULET_API rivulet_status rivulet_world_particles(rivulet_world* world, rivulet_particles* particles, rivulet_error* why);

/* The states of the bodies now, in their order; `count` must be their number. */
RIVULET_API rivulet_status rivulet_world_bodies(const rivulet_world* world, rivulet_body_state* states, size_t count, rivulet_error* why);

/* Saves and restores all that the next step depends on; on the cpu the restored run is bit-identical. */
RIVULET_API rivulet_status rivulet_world_save(rivulet_world* world, const char* path, rivulet_error* why);
RIVULET_API rivulet_status rivulet_world_restore(rivulet_world* world, const char* path, rivulet_error* why);

/* ---- Queries ---- */

/* The water at places (m, 3 each), from the particles as they are now. Waits for the device. */
typedef struct rivulet_sample {
    float density;     /* over the rest density; 0 in air */
    float velocity[3]; /* m/s; 0 in air */
    float gradient[3]; /* 1/m, of the density: points into the water */
} rivulet_sample;
RIVULET_API rivulet_status rivulet_world_sample(rivulet_world* world, const float* places, size_t count, rivulet_sample* samples,
                                                rivulet_error* why);

/* The first crossing of each ray with the water's surface. Waits for the device. */
typedef struct rivulet_ray {
    float origin[3], direction[3]; /* m; of any length but 0: a ray of length 0 misses */
    float reach;                   /* m; 0: no limit */
} rivulet_ray;
typedef struct rivulet_hit {
    uint32_t hit, inside;                   /* 1: the ray hits; it begins in water and this is where it leaves it */
    float distance;                         /* m */
    float place[3], normal[3], velocity[3]; /* m; unit, out of the water; m/s */
} rivulet_hit;
RIVULET_API rivulet_status rivulet_world_cast(rivulet_world* world, const rivulet_ray* rays, size_t count, rivulet_hit* hits,
                                              rivulet_error* why);
/* y (m) of the highest surface at each x, z (2 floats each); NaN where there is no water. Waits for the device. */
RIVULET_API rivulet_status rivulet_world_heights(rivulet_world* world, const float* places, size_t count, float* heights,
                                                 rivulet_error* why);

/* Volumes that count particles, at most 32, each with an id that the host chooses. */
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
    double time;                    /* s, simulated time at which they were counted; on a GPU two or three frames ago */
    double volume_inside;           /* m^3 */
} rivulet_volume_count;
RIVULET_API rivulet_status rivulet_world_set_volumes(rivulet_world* world, const rivulet_volume* volumes, size_t count, rivulet_error* why);
RIVULET_API rivulet_status rivulet_world_volumes(rivulet_world* world, rivulet_volume_count* counts, size_t capacity, size_t* count,
                                                 rivulet_error* why);
/* The volumes that particles entered or left since the last call, with entered and left since then. `capacity` must be at least 32. */
RIVULET_API rivulet_status rivulet_world_volume_events(rivulet_world* world, rivulet_volume_count* counts, size_t capacity, size_t* count,
                                                       rivulet_error* why);

/* What fluid.probes measured: the load of the fluid on walls and bodies, in world axes. Means are over the last frame that has arrived; on
   a GPU two or three frames ago. Probes are part of the world's json, or set with rivulet_world_set while their number stays. Their `on` is
   box, body or collider; collider k is walls[k]. */
typedef struct rivulet_load {
    char name[64];             /* of the probe; a longer one is cut */
    double time, seconds;      /* s simulated: the means are of the last `seconds` before `time`; 0: no frame has arrived */
    double force[3];           /* N, on the wall, mean */
    double torque[3];          /* N m, about the probe's point, mean */
    double pressure;           /* Pa, mean over the probe's area; NaN: it has no area, or is on a body */
    double impulse[3];         /* N s, since the start, a reset or a restored state */
    double angular_impulse[3]; /* N m s, likewise */
} rivulet_load;
/* `count` receives the number of all probes, also where `capacity` is smaller. */
RIVULET_API rivulet_status rivulet_world_loads(const rivulet_world* world, rivulet_load* loads, size_t capacity, size_t* count,
                                               rivulet_error* why);

/* ---- Files ---- */

/* Writes the particles as .ply, .vtp (ParaView) or .csv, the water's surface as .obj or .ply, by the path's ending; +Y up, metres. */
RIVULET_API rivulet_status rivulet_world_export(rivulet_world* world, const char* path, rivulet_error* why);
RIVULET_API rivulet_status rivulet_world_export_surface(rivulet_world* world, const char* path, rivulet_error* why);

/* ---- Drawing ---- */

typedef struct rivulet_view {
    size_t size;
    const float* view;       /* world -> view, right-handed, looking down -z */
    const float* projection; /* a perspective, the one that the target's depth was drawn with: any glClipControl mode, reversed or not */
    float near_plane, far_plane; /* m, finite */
    float light_direction[3];    /* towards the light; all 0: (0.4, 0.8, 0.45) */
    float light_colour[3];       /* radiance in the target's units; all 0: 1 */
} rivulet_view;

typedef enum rivulet_colours {
    RIVULET_AUTOMATIC = 0, /* linear in a framebuffer of floats, else sRGB */
    RIVULET_LINEAR = 1,    /* radiance; the host tonemaps later */
    RIVULET_SRGB = 2       /* for the screen, 1 is white */
} rivulet_colours;

typedef struct rivulet_target {
    size_t size;
    uint32_t framebuffer;        /* GL name, 0: the window; its colour and depth hold the scene drawn so far */
    int32_t x, y, width, height; /* pixels */
    int32_t colours;             /* a rivulet_colours */
} rivulet_target;

/* Draws the water over the target's picture: nearer objects hide it, farther ones are seen through it. Colour and depth change only where
   there is water. */
RIVULET_API rivulet_status rivulet_world_draw(rivulet_world* world, const rivulet_view* view, const rivulet_target* target,
                                              rivulet_error* why);

/* The particles as OpenGL buffers, for a host that draws them. With fluid.fixedStep, positions are interpolated between two steps. Valid
   until the world's next step. */
typedef struct rivulet_buffers {
    size_t size;
    uint32_t position; /* GL name; vec4 each: xyz m, w density over rest density; negative w: the row is empty */
    uint32_t velocity; /* GL name; vec4 each: xyz m/s */
    uint32_t id;       /* GL name; uint each */
    uint32_t count;    /* rows */
    float radius;      /* m, of a drawn sphere */
} rivulet_buffers;
RIVULET_API rivulet_status rivulet_world_buffers(rivulet_world* world, rivulet_buffers* buffers, rivulet_error* why);

/* ---- Skins ---- */

typedef struct rivulet_skin_options {
    size_t size;
    const rivulet_mesh* mesh; /* with uvs; their charts must not overlap */
    const char* json;         /* the liquid: {"advancing": 60, ...}, as flow.N.liquid in docs/parameters.md; NULL: tears */
    int32_t map_size;         /* texels of the map's edge, a power of two; 0: 1024 */
} rivulet_skin_options;
typedef struct rivulet_skin_inputs {
    size_t size;
    const float* gravity;   /* m/s^2, in the world; NULL: (0, -9.81, 0) */
    const float* wind;      /* m/s; NULL: none */
    const float* to_world;  /* the mesh's frame -> the world, a matrix without scale; NULL: identity */
    const float* positions; /* m, of all vertices of a mesh that deforms; NULL: as before */
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
/* Adds a drop, which appears with the next step, at the point of the skin nearest to `place` (m, in the mesh's frame). */
RIVULET_API rivulet_status rivulet_skin_add(rivulet_skin* skin, const float* place, double microlitres, rivulet_error* why);
RIVULET_API rivulet_status rivulet_skin_step(rivulet_skin* skin, const rivulet_skin_inputs* inputs, double seconds, rivulet_error* why);
/* Updates the map, a GL texture over the mesh's uvs, rgba16f with mips: r, g the slope of the liquid's height (m a unit of u, of v), b the
   height (mm), a the wetness, 0 to 1. */
RIVULET_API rivulet_status rivulet_skin_texture(rivulet_skin* skin, uint32_t* texture, rivulet_error* why);
RIVULET_API rivulet_status rivulet_skin_stats_of(const rivulet_skin* skin, rivulet_skin_stats* stats,
                                                 rivulet_error* why); /* waits for the device */

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */
#endif
