/* What tests share in which walls and bodies come and go. */
#ifndef POOL_H
#define POOL_H

#include <time.h>

#include "check.h"

enum { MOST = 20000 };
static float positions[3 * MOST];

/* Of a box with corner k at the low (bit clear) or high end of x (bit 0), y (1) and z (2). */
static const uint32_t kTriangles[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                        2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};

/* Brings the positions. */
static inline size_t count_of(rivulet_world* world) {
    rivulet_particles all = {.size = sizeof all, .capacity = MOST, .positions = positions};
    DONE(rivulet_world_particles(world, &all, &why));
    return all.count;
}
static inline void run(rivulet_world* world, int frames) {
    for (int k = 0; k < frames; ++k) DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
}
/* For what is made ready beside the frames: it arrives, and `seconds` pass in the world. */
static inline void wait_a_little(rivulet_world* world, double seconds) {
    const struct timespec pause = {0, 1000000};
    nanosleep(&pause, NULL);
    DONE(rivulet_world_step(world, NULL, seconds, &why));
}

#endif
