/* rivulet.h: walls and floating bodies, as a host gives them, and the host's rigid-body engine. */
#ifndef RIVULET_SOLIDS_H
#define RIVULET_SOLIDS_H
/* NOLINTBEGIN(readability-identifier-naming): C's own way with names */

#include "rivulet_context.h"

#ifdef __cplusplus
extern "C" {
#endif

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
    const float* uvs;  /* 2 a vertex; for skins */
    float friction;    /* of a wall: Coulomb's coefficient; negative: that of fluid.collision */
    float restitution; /* of a wall: 0 to 1; negative: that of fluid.collision */
    /* Of a wall: 1: moves rigidly with rivulet_inputs.poses and turns about its own origin; 2: deforms with rivulet_inputs.shapes;
       0: stands still. */
    uint32_t moves;
    int32_t resolution; /* of a wall: voxels along its longest side; 0: voxels of a quarter of the fluid's spacing */
    rivulet_pose pose;  /* of a wall that moves: at t = 0 */
    /* m, the low and the high corner of a box in which a wall that deforms always is; voxels are kept for all of it, `resolution` of them
       along its longest side. All 0: the box of its positions, longer by half of its longest side in each direction. */
    float reach_low[3], reach_high[3];
    /* Of a wall: the collision layers that it is on (bit k is layer k, of 16; 0: the first), and those that it meets (0: all). The water,
       with fluid.collision.layers and .meets, passes through it unless each is on a layer that the other meets. */
    uint32_t layers, meets;
} rivulet_mesh;

/* A floating body, coupled to the fluid both ways. The origin of its frame is its centre of mass, its axes are the principal axes. Or it is
   given as a closed mesh with a density and without samples: mass, inertia and volume are then found from these, and the frame is that of
   the mesh. */
typedef struct rivulet_body {
    size_t size;
    const float* samples; /* m, 3 each: points half a spacing below its surface, about a spacing apart; NULL: those of mesh */
    size_t samples_count;
    float mass;                 /* kg; 0: the body is fixed */
    float inertia[3];           /* kg m^2 */
    float volume;               /* m^3 */
    rivulet_pose pose;          /* of its frame, at t = 0 or when it is added */
    const rivulet_mesh* mesh;   /* its surface, in its frame; NULL: it does not get wet (fluid.wetness), and no water makes room for it */
    float density;              /* kg/m^3, without samples */
    float velocity[3], spin[3]; /* as of rivulet_body_state, at t = 0 or when it is added */
    uint32_t layers, meets;     /* as of rivulet_mesh: whether the water meets it. A body_host knows which bodies meet each other */
} rivulet_body;
typedef struct rivulet_body_state {
    rivulet_pose pose;
    float velocity[3], spin[3]; /* m/s, of the centre of mass; rad/s; in world axes */
} rivulet_body_state;
typedef struct rivulet_body_load {
    double force[3], torque[3]; /* N; N m about the centre of mass; in world axes */
} rivulet_body_load;
/* A contact that may act in a frame, between body a and body b, or between body a and a solid that the host knows. It names a point of each
   of the two surfaces: those that are nearest to each other there. The surfaces may be apart or overlap. */
enum { RIVULET_SOLID = 0x7fffffff }; /* as b: a wall or another solid that the host knows */
typedef struct rivulet_body_contact {
    size_t size;
    uint32_t a, b; /* a: index into the states; b: another one, or RIVULET_SOLID */
    /* m: the point of a, in the frame of a; the point of b, in the frame of b, or of a solid in the world when the frame begins. With a
       radius (m) above 0 the surface there is a ball of this radius, and the point is its centre. */
    float on_a[3], on_b[3], radius_a, radius_b;
    /* Unit vector, from b to a. Of a solid: in the world when the frame begins. Of a body: in the frame of b; in that of a if radius_b is
       above 0. During the frame the surface of b is taken for an infinite plane through on_b, or for the ball. Of a body that moves past b
       give the contact at the place where they come nearest to each other in the frame; otherwise the plane may stop it. */
    float normal[3];
    /* Of a solid that moves: the velocity (m/s) of the point centre_b (m, in the world when the frame begins), and the spin (rad/s) of the
       solid about this point. It moves for seconds_b (s) from the start of the frame on; 0: it does not move. */
    float velocity_b[3], spin_b[3], centre_b[3];
    double seconds_b;
    float friction;    /* Coulomb's coefficient, 0 to 1,000 */
    float restitution; /* 0 to 1 */
} rivulet_body_contact;
/* Adds a contact; it is copied. `to`: as passed to contacts. */
typedef void (*rivulet_add_contact)(void* to, const rivulet_body_contact* contact);
/* The host's rigid-body engine, which moves the bodies. If its functions are NULL, bodies collide with nothing but fluid. */
typedef struct rivulet_body_host {
    size_t size;
    void* user;
    /* Advances all bodies by `seconds` under the loads, gravity (m/s^2) and the host's own contacts. Called once a substep. */
    void (*advance)(void* user, const rivulet_body_load* loads, const float* gravity, double seconds, rivulet_body_state* states,
                    size_t count);
    void (*reset)(void* user, const rivulet_body_state* states,
                  size_t count); /* sets the bodies to these states: those of t = 0 after a reset */
    /* May be NULL. added: a body enters the world, and is the last of the next states. removed: it leaves the world, and the next states
       do not contain it. */
    void (*added)(void* user, uint32_t id, const rivulet_body_state* state);
    void (*removed)(void* user, uint32_t id);
    /* contacts and passed: both or neither, in addition to advance and reset. On a GPU a step waits for the loads before each call of
       advance. With these two functions it does not wait: the GPU moves the bodies, and the host learns their states some frames late.
       contacts is called once or twice a frame, on backend cpu never. It calls `add(to, contact)` for each contact that may act in the next
       `seconds`. `states`: where the bodies are expected. `balls`: for each body 4 floats, xyz (m, in the world) and a radius (m); the
       body's centre of mass is expected to stay in this ball for these `seconds`. `add` must not be called after contacts has returned.
       contacts returns 1; or 0 if the host itself must move the bodies in this frame, for instance because it holds one: then advance is
       called. After 1, passed is called for each substep instead of advance, with the length of the substep; but if more than 384 bodies
       have contacts, or memory is full, advance is called. After an invalid contact no body moves in this frame, and the step returns
       RIVULET_FAILED; its message says what is invalid. */
    int32_t (*contacts)(void* user, const rivulet_body_state* states, const float* balls, size_t count, double seconds,
                        rivulet_add_contact add, void* to);
    void (*passed)(void* user, double seconds);
    /* For contacts; may be NULL: then expected states are those of bodies that move freely. It is as advance, but changes nothing that
       later calls depend on: it advances `states` by `seconds` under these loads. They are the states at the time `from` (s after now;
       negative: before). */
    void (*predict)(void* user, const rivulet_body_load* loads, const float* gravity, double from, double seconds,
                    rivulet_body_state* states, size_t count);
} rivulet_body_host;

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */
#endif
