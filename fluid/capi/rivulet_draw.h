/* rivulet.h: drawing a world into the host's picture, or its particles as OpenGL buffers. */
#ifndef RIVULET_DRAW_H
#define RIVULET_DRAW_H
/* NOLINTBEGIN(readability-identifier-naming): C's own way with names */

#include "rivulet_world.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A light besides the view's, far away. */
typedef struct rivulet_light {
    float direction[3]; /* towards the light, any length but 0; +Y is up */
    float colour[3];    /* radiance in the target's units */
} rivulet_light;

/* Where the view's light is shaded: the host's shadow map. Beyond it all is lit. */
typedef struct rivulet_shadow {
    size_t size;
    /* GL name of a GL_TEXTURE_2D of depths, or of one red channel of floats, without a swizzle. Level 0 is read, and its sampling is not
       used. The layer of an array can be given as a texture view (glTextureView). */
    uint32_t texture;
    const float* projection; /* 16 floats: the world that the view transforms -> the map's clip space */
    uint32_t zero_to_one;    /* 1: the map was drawn with GL_ZERO_TO_ONE; 0: clip depths are -1 to 1 */
    uint32_t reversed;       /* 1: what is nearer to the light has the greater depth */
    float bias;              /* of stored depth, 0 to 1: what is deeper by less is lit; 0.002 suits 24 bits */
} rivulet_shadow;

/* The share of light that passes a distance d. */
typedef enum rivulet_fog_kind {
    RIVULET_NO_FOG = 0,
    RIVULET_EXPONENTIAL = 1,         /* exp(-density d) */
    RIVULET_EXPONENTIAL_SQUARED = 2, /* exp(-(density d)^2) */
    RIVULET_LINEAR_FOG = 3           /* (end - d) / (end - start), 0 to 1 */
} rivulet_fog_kind;

/* The fog that the host's picture already contains: the water is seen through it too. */
typedef struct rivulet_fog {
    size_t size;
    int32_t kind;     /* a rivulet_fog_kind */
    float colour[3];  /* radiance in the target's units; with display: sRGB-encoded */
    float density;    /* 1 / the unit of the view's world */
    float start, end; /* in that unit */
    /* 1: d is the depth along the view axis; 0: the distance from the eye: an orthographic camera has none, and distances are depths */
    uint32_t along_view;
    uint32_t display; /* 1: the host blends fog with sRGB-encoded values; 0: with linear ones */
} rivulet_fog;

typedef struct rivulet_lighting {
    size_t size;
    const rivulet_light* lights; /* up to 7 */
    size_t lights_count;
    const rivulet_shadow* shadow; /* NULL: none */
    const rivulet_fog* fog;       /* NULL: none */
} rivulet_lighting;

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
    uint32_t
        attributes[RIVULET_ATTRIBUTES]; /* GL names; vec4 each, in the order of position: the values of fluid.attributes; 0 beyond them */
} rivulet_buffers;

/* What a host's own renderer draws with, by OpenGL. */
typedef struct rivulet_drawing {
    size_t size;
    const rivulet_buffers* particles; /* velocity: with look.colourBy normal or surface, normals */
    /* The view of rivulet_world_draw in one convention: metres, right-handed, -z ahead, not mirrored, clip depth -1 to 1. Column by column.
     */
    float view[16], projection[16];
    float near_plane, far_plane; /* m */
    int32_t width, height;       /* pixels */
    /* GL name, bound, its viewport set: a colour of floats, linear radiance, and a depth of floats, both with the scene drawn so far; the
       state is otherwise OpenGL's default, and may be left in any state, except active queries, which must be ended. */
    uint32_t framebuffer;
} rivulet_drawing;

typedef enum rivulet_stage {
    RIVULET_INSTEAD = 0, /* of the renderer of the world's look; foam and drops are drawn after it */
    RIVULET_AFTER = 1    /* after it: the depth has the water's surface in it, and what is drawn leaves the target's depth as it is */
} rivulet_stage;

/* A host's own renderer of a world's particles. */
typedef struct rivulet_renderer {
    size_t size;
    int32_t stage; /* a rivulet_stage */
    /* Called once in a draw, where the world has water, on the thread of the call. It must not call the library, and returns; if it throws
       an exception, the draw fails. */
    void (*draw)(void* user, const rivulet_drawing* drawing);
    void* user;
} rivulet_renderer;

typedef struct rivulet_view {
    size_t size;
    const float* view;           /* world -> view: right- or left-handed, mirrored or not */
    const float* projection;     /* a perspective or an orthographic one, with which the target's depth was drawn: any glClipControl mode,
                                    reversed or not, mirrored or not, of an oblique near plane or not */
    float near_plane, far_plane; /* along the view axis, finite; of an infinite projection, the depth of the farthest object */
    float light_direction[3];    /* towards the light; all 0: (0.4, 0.8, 0.45) */
    float light_colour[3];       /* radiance in the target's units; all 0: 1 */
    float units_per_metre;       /* of the world that `view` transforms, and of the planes: 100 for centimetres; 0: 1 */
    const rivulet_lighting* lighting; /* NULL: the light above alone */
    const rivulet_renderer* renderer; /* NULL: that of the world's look */
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

/* What the water reflects beside the picture itself: an image or a texture of the host, linear radiance in the target's units. */
typedef struct rivulet_surroundings {
    size_t size;
    /* Three floats each, red, green, blue: an equirectangular map, the bottom row (-y) first, -z in the middle, +x right of it. NULL:
     * texture */
    const float* pixels;
    int32_t width, height; /* of pixels */
    /* GL name of a GL_TEXTURE_2D that has the same layout, or of a GL_TEXTURE_CUBE_MAP, in a format that is read as floats. Level 0 is read
       in this call; call again when it has changed. 0: pixels */
    uint32_t texture;
    /* 9 floats, column by column: a direction in the world, +Y up, into one of the map: a rotation, which may mirror. NULL: none */
    const float* turn;
} rivulet_surroundings;
/* Replaces the sky of rivulet_context_options. Costs 10 small draws and waits for nothing: it may be called in each frame. On an error the
   surroundings before stay. */
RIVULET_API rivulet_status rivulet_context_set_surroundings(rivulet_context* context, const rivulet_surroundings* surroundings,
                                                            rivulet_error* why);

RIVULET_API rivulet_status rivulet_world_buffers(rivulet_world* world, rivulet_buffers* buffers, rivulet_error* why);

/* For a host's own material: where the wetness of a wall or body is in the two buffers. shaders/material/wet.glsl reads them: wet_cells as
   storage buffer 0, wetness as storage buffer 1. from_world, cells and first_cell are its uniforms wetFromWorld, wetSize and wetFirstCell.
   Its uniform porosity is how much water the material soaks up, which darkens it: 0 (glaze, metal) to 1 (stone, cloth); negative: it
   follows from the roughness and the metallic share that are passed to wetnessAt. docs/embedding.md says what to include before it. */
typedef enum rivulet_solid { RIVULET_WALL = 0, RIVULET_BODY = 1 } rivulet_solid;
typedef struct rivulet_wet_solid {
    size_t size;
    float from_world[16]; /* world (m) -> cells of the solid's grid, from its low corner; column by column */
    int32_t cells[3];
    uint32_t first_cell; /* of wet_cells */
} rivulet_wet_solid;
/* Of the wall or body, a rivulet_solid, with the id `index`; again after each step if it moves, and after walls or bodies came or went.
   On a GPU it may wait for the body. RIVULET_BAD_INPUT: it does not get wet. */
RIVULET_API rivulet_status rivulet_world_wet_solid(const rivulet_world* world, int32_t solid, size_t index, rivulet_wet_solid* wet,
                                                   rivulet_error* why);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */
#endif
