/* rivulet.h: questions to a world: samples, rays, heights, counted volumes, loads; and its particles and surface as files. */
#ifndef RIVULET_QUERY_H
#define RIVULET_QUERY_H
/* NOLINTBEGIN(readability-identifier-naming): C's own way with names */

#include "rivulet_world.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The water at places (m, 3 each), from the particles as they are now. Waits for the device. */
typedef struct rivulet_sample {
    float density;     /* over the rest density; 0 in air */
    float velocity[3]; /* m/s; 0 in air */
    float gradient[3]; /* 1/m, of the density: points into the water */
} rivulet_sample;
RIVULET_API rivulet_status rivulet_world_sample(rivulet_world* world, const float* places, size_t count, rivulet_sample* samples,
                                                rivulet_error* why);

/* The same without waiting: `then` receives the samples once, at the end of a later call of this world, on backend cpu at the end of this
   one. They are of now and valid within `then`. If the world is destroyed before, `then` is not called. */
RIVULET_API rivulet_status rivulet_world_sample_later(rivulet_world* world, const float* places, size_t count,
                                                      void (*then)(void* user, const rivulet_sample* samples, size_t count), void* user,
                                                      rivulet_error* why);

/* Buoyancy of objects that the host moves and that have no effect on the water, for many small or distant ones: lift by Archimedes at
   points of the object, drag by Morison et al. 1950 against the water's velocity there. An object that displaces water is a rivulet_body.
 */
typedef struct rivulet_float {
    size_t size;
    const float* points;  /* m, 3 each, in the object's frame, whose origin is its centre of mass; at least a spacing apart */
    const float* volumes; /* m^3, one a point: they add up to the object's volume */
    size_t points_count;
    float mass;                        /* kg */
    float linear_drag, quadratic_drag; /* 1/s; 1: about 1 of a cube, 0.5 of a ball */
    rivulet_body_state state;
} rivulet_float;
/* The loads on `count` objects, to be applied for `seconds`: drag never reverses a motion within that time. gravity: m/s^2, NULL: that of
   fluid.gravity. Each object begins its own size after the one before. Waits for the device, once for all objects. */
RIVULET_API rivulet_status rivulet_world_buoyancy(rivulet_world* world, const rivulet_float* floats, size_t count, const float* gravity,
                                                  double seconds, rivulet_body_load* loads, rivulet_error* why);

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

/* How wet solids are at places (m, 3 each) on or near their surface: 0 dry .. 1 wet; 0 off the surface, and without fluid.wetness.on. Waits
   for the device. */
RIVULET_API rivulet_status rivulet_world_wetness(rivulet_world* world, const float* places, size_t count, float* wetness,
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
    double time;                    /* s, simulated time of the count; on a GPU two or three frames before the present */
    double volume_inside;           /* m^3 */
} rivulet_volume_count;
RIVULET_API rivulet_status rivulet_world_set_volumes(rivulet_world* world, const rivulet_volume* volumes, size_t count, rivulet_error* why);
RIVULET_API rivulet_status rivulet_world_volumes(rivulet_world* world, rivulet_volume_count* counts, size_t capacity, size_t* count,
                                                 rivulet_error* why);
/* The volumes that particles entered or left since the last call, with entered and left since then. `capacity` must be at least 32. */
RIVULET_API rivulet_status rivulet_world_volume_events(rivulet_world* world, rivulet_volume_count* counts, size_t capacity, size_t* count,
                                                       rivulet_error* why);

/* Sets fluid.attributes[attribute] of the particles with these ids: `values` are 4 floats each, finite; of an id that is there twice, one
   of them. The water does not depend on it; a reset gives them their values of t = 0 again. Does not wait. rivulet_world_paint does it in a
   volume. */
RIVULET_API rivulet_status rivulet_world_set_attribute(rivulet_world* world, uint32_t attribute, const uint32_t* ids, const float* values,
                                                       size_t count, rivulet_error* why);
/* Sets fluid.attributes[attribute] of all particles that are in the volume now; its id is not read. `value`: 4 floats. Does not wait. */
RIVULET_API rivulet_status rivulet_world_paint(rivulet_world* world, uint32_t attribute, const rivulet_volume* volume, const float* value,
                                               rivulet_error* why);

/* The particles in the memory of backend cpu, without a copy, for reading. RIVULET_BAD_INPUT: another backend; use
   rivulet_world_particles. The memory stays until the world is destroyed; after the next step, reset or restore, which move particles to
   other rows and the newest state to other memory, call again. */
typedef struct rivulet_rows {
    size_t size;
    size_t count;            /* rows of each array */
    const float* positions;  /* 4 each: xyz m, w density over the rest density; negative w: the row holds no particle */
    const float* velocities; /* 4 each: xyz m/s; w unused */
    const uint32_t* ids;
    const float* attributes[RIVULET_ATTRIBUTES]; /* 4 each: the values of fluid.attributes; NULL beyond them */
} rivulet_rows;
RIVULET_API rivulet_status rivulet_world_rows(const rivulet_world* world, rivulet_rows* rows, rivulet_error* why);

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

/* The parts of a world as lines, for the debug drawing of a host. */
typedef enum rivulet_part {
    RIVULET_PART_BOX = 0,     /* fluid.box */
    RIVULET_PART_EMITTER = 1, /* its opening or box, and an arrow as long as the way of its water in a tenth of a second */
    RIVULET_PART_SINK = 2,
    RIVULET_PART_PROBE = 3, /* its region, in the box */
    RIVULET_PART_WALL = 4,  /* of one that moves: the axes of its frame, 4 spacings long */
    RIVULET_PART_BODY = 5   /* likewise */
} rivulet_part;
/* Calls `line` for each line, at the end of this call: `part` a rivulet_part, `from` and `to` m, in the world. `index`: of the emitter,
   sink or probe, the id of the body, or of the wall among those that move, in their order; 0 of the box. Bodies are where
   rivulet_world_expected_bodies has them: this never waits for the device, and on a GPU that moves them it may differ after a blow from a
   picture, which shows bodies of plain materials by the device's own poses. */
RIVULET_API rivulet_status rivulet_world_lines(const rivulet_world* world,
                                               void (*line)(void* user, int32_t part, size_t index, const float* from, const float* to),
                                               void* user, rivulet_error* why);

/* Writes the particles as .ply, .vtp (ParaView) or .csv, the water's surface as .obj or .ply, by the path's ending; +Y up, metres. */
RIVULET_API rivulet_status rivulet_world_export(rivulet_world* world, const char* path, rivulet_error* why);
RIVULET_API rivulet_status rivulet_world_export_surface(rivulet_world* world, const char* path, rivulet_error* why);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */
#endif
