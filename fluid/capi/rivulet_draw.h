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
    const float* view;           /* world -> view: right- or left-handed, mirrored or not */
    const float* projection;     /* a perspective or an orthographic one, with which the target's depth was drawn: any glClipControl mode,
                                    reversed or not, mirrored or not, of an oblique near plane or not */
    float near_plane, far_plane; /* along the view axis, finite; of an infinite projection, the depth of the farthest object */
    float light_direction[3];    /* towards the light; all 0: (0.4, 0.8, 0.45) */
    float light_colour[3];       /* radiance in the target's units; all 0: 1 */
    float units_per_metre;       /* of the world that `view` transforms, and of the planes: 100 for centimetres; 0: 1 */
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
    uint32_t position;  /* GL name; vec4 each: xyz m, w density over rest density; negative w: the row is empty */
    uint32_t velocity;  /* GL name; vec4 each: xyz m/s */
    uint32_t id;        /* GL name; uint each */
    uint32_t count;     /* rows */
    float radius;       /* m, of a drawn sphere */
    uint32_t wet_cells; /* GL name; int each: see rivulet_world_wet_solid. 0 without fluid.wetness.on */
    uint32_t wetness;   /* GL name; float each: 0 dry .. 1 wet. Another buffer after each step */
} rivulet_buffers;
RIVULET_API rivulet_status rivulet_world_buffers(rivulet_world* world, rivulet_buffers* buffers, rivulet_error* why);

/* For a host's own material: where the wetness of a wall or body is in the two buffers. shaders/material/wet.glsl reads them: wet_cells at
   binding 1, wetness at binding 2, these as its uniforms wetFromWorld, wetSize and wetFirstCell, and as its uniform porosity how much water
   the material soaks up, which darkens it: 0 (glaze, metal) to 1 (stone, cloth). It includes surface.glsl and noise.glsl of the same
   folder. */
typedef enum rivulet_solid { RIVULET_WALL = 0, RIVULET_BODY = 1 } rivulet_solid;
typedef struct rivulet_wet_solid {
    size_t size;
    float from_world[16]; /* world (m) -> cells of the solid's grid, from its low corner; column by column */
    int32_t cells[3];
    uint32_t first_cell; /* of wet_cells */
} rivulet_wet_solid;
/* Of the wall or body, a rivulet_solid, with the id `index`; again after each step if it moves, and after walls or bodies came or went.
   RIVULET_BAD_INPUT: it does not get wet. */
RIVULET_API rivulet_status rivulet_world_wet_solid(const rivulet_world* world, int32_t solid, size_t index, rivulet_wet_solid* wet,
                                                   rivulet_error* why);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */
#endif
