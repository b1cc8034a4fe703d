/* rivulet.h: drawing a world into the host's picture, or its particles as OpenGL buffers. */
#ifndef RIVULET_DRAW_H
#define RIVULET_DRAW_H
/* NOLINTBEGIN(readability-identifier-naming): C's own way with names */

#include "rivulet_world.h"

#ifdef __cplusplus
extern "C" {
#endif

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

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */
#endif
