/* rivulet.h in a host's light: surroundings, several lights, a shadow map and fog. Exit 77: no OpenGL. */
#include <stdlib.h>

#include "check.h"
#include "host.h"

enum { WIDTH = 96, HEIGHT = 72, BYTES = 4 * WIDTH * HEIGHT };

static rivulet_error why;
static rivulet_world* world;
static rivulet_view from;
static rivulet_target to;

/* The picture of the water in `lighting`. */
static const unsigned char* picture(unsigned char* into, const rivulet_lighting* lighting) {
    rivulet_view view = from;
    view.lighting = lighting;
    glClearColor(0.5F, 0.25F, 0.25F, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    DONE(rivulet_world_draw(world, &view, &to, &why));
    glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, into);
    return into;
}

static int is_water(const unsigned char* pixel) { return pixel[0] != 128 || pixel[1] != 64 || pixel[2] != 64; }

static int sum(const unsigned char* pixels, int channel) {
    int all = 0;
    for (int k = 0; k < WIDTH * HEIGHT; ++k) all += pixels[4 * k + channel];
    return all;
}

static void refuses(const rivulet_lighting* lighting, const char* word) {
    rivulet_view view = from;
    view.lighting = lighting;
    REFUSED(rivulet_world_draw(world, &view, &to, &why), word);
}

static void surroundings_are_reflected(rivulet_context* context, unsigned char* a, unsigned char* b) {
    static float green[3 * 8 * 4];
    for (int k = 0; k < 8 * 4; ++k) green[3 * k + 1] = 5;
    const rivulet_surroundings image = {.size = sizeof image, .pixels = green, .width = 8, .height = 4};
    const int before = sum(picture(a, NULL), 1);
    DONE(rivulet_context_set_surroundings(context, &image, &why));
    CHECK(sum(picture(a, NULL), 1) > before + 1000);
    /* A cube map of the same light gives the same picture. */
    GLuint cube = 0;
    glGenTextures(1, &cube);
    glBindTexture(GL_TEXTURE_CUBE_MAP, cube);
    for (GLenum face = 0; face < 6; ++face)
        glTexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + face, 0, GL_RGB16F, 4, 4, 0, GL_RGB, GL_FLOAT, green);
    const float turn[9] = {1, 0, 0, 0, 0, 1, 0, -1, 0};
    const rivulet_surroundings texture = {.size = sizeof texture, .texture = cube, .turn = turn};
    DONE(rivulet_context_set_surroundings(context, &texture, &why));
    GLint bound = 0;
    glGetIntegerv(GL_TEXTURE_BINDING_CUBE_MAP, &bound);
    CHECK((GLuint)bound == cube);
    CHECK(memcmp(picture(b, NULL), a, BYTES) == 0);
    rivulet_surroundings wrong = texture;
    wrong.pixels = green;
    REFUSED(rivulet_context_set_surroundings(context, &wrong, &why), "0 x 0");
    wrong.width = wrong.height = 2;
    REFUSED(rivulet_context_set_surroundings(context, &wrong, &why), "one of the two");
    wrong = texture;
    wrong.texture = 0;
    REFUSED(rivulet_context_set_surroundings(context, &wrong, &why), "one of the two");
    REFUSED(rivulet_context_set_surroundings(context, NULL, &why), "surroundings is NULL");
    REFUSED(rivulet_context_set_surroundings(NULL, &texture, &why), "context is NULL");
    CHECK(memcmp(picture(b, NULL), a, BYTES) == 0);
    glDeleteTextures(1, &cube);
}

static void lights_add(unsigned char* a, unsigned char* b) {
    rivulet_light lights[8] = {{{0, 0.2F, 1}, {0, 0, 0}}, {{0, 1, 0}, {0, 0, 0}}};
    rivulet_lighting lighting = {.size = sizeof lighting, .lights = lights, .lights_count = 2};
    picture(a, NULL);
    CHECK(memcmp(picture(b, &lighting), a, BYTES) == 0);
    lights[1].colour[2] = 3;
    CHECK(sum(picture(b, &lighting), 2) > sum(a, 2) && sum(b, 0) == sum(a, 0));
    lighting.lights_count = 8;
    refuses(&lighting, "7 at most");
    lighting.lights = NULL;
    refuses(&lighting, "lights is NULL");
}

static void shade_is_without_the_sun(unsigned char* a, unsigned char* b) {
    const float depth = 0;
    GLuint map = 0;
    glGenTextures(1, &map);
    glBindTexture(GL_TEXTURE_2D, map);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, 1, 1, 0, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
    /* Orthographic, along -y: 10 m wide and deep. */
    const float projection[16] = {0.2F, 0, 0, 0, 0, 0, -0.2F, 0, 0, 0.2F, 0, 0, 0, 0, 0, 1};
    const rivulet_shadow shadow = {.size = sizeof shadow, .texture = map, .projection = projection, .bias = 0.002F};
    rivulet_lighting lighting = {.size = sizeof lighting, .shadow = &shadow};
    from.light_colour[0] = from.light_colour[1] = from.light_colour[2] = 1.0e-20F;
    picture(a, NULL);
    from.light_colour[0] = from.light_colour[1] = from.light_colour[2] = 2;
    CHECK(memcmp(picture(b, NULL), a, BYTES) != 0);
    CHECK(memcmp(picture(b, &lighting), a, BYTES) == 0);
    rivulet_shadow wrong = shadow;
    wrong.projection = NULL;
    lighting.shadow = &wrong;
    refuses(&lighting, "no projection");
    wrong = shadow;
    wrong.texture = 4711;
    refuses(&lighting, "not a texture");
    glDeleteTextures(1, &map);
}

static void thick_fog_is_all_that_is_seen(unsigned char* a) {
    rivulet_fog fog = {.size = sizeof fog, .kind = RIVULET_EXPONENTIAL, .colour = {0.2F, 0.4F, 0.6F}, .density = 10, .display = 1};
    rivulet_lighting lighting = {.size = sizeof lighting, .fog = &fog};
    picture(a, &lighting);
    int water = 0;
    for (int k = 0; k < WIDTH * HEIGHT; ++k) {
        const unsigned char* p = a + 4 * k;
        if (!is_water(p)) continue;
        ++water;
        CHECK(abs(p[0] - 51) <= 1 && abs(p[1] - 102) <= 1 && abs(p[2] - 153) <= 1);
    }
    CHECK(water > 150);
    fog.kind = 9;
    refuses(&lighting, "rivulet_fog_kind");
    fog.kind = RIVULET_LINEAR_FOG;
    refuses(&lighting, "ends beyond its start");
    fog.kind = RIVULET_EXPONENTIAL_SQUARED;
    fog.density = -1;
    refuses(&lighting, "give 0 or more");
}

int main(void) {
    if (!make_current()) return 77;
    rivulet_context* context = NULL;
    const rivulet_context_options options = {.size = sizeof options, .find = eglGetProcAddress, .backend = "cpu"};
    DONE(rivulet_context_create(&options, &context, &why));
    const rivulet_world_options o = {.size = sizeof o, .json = "{\"fluid\": {\"spacing\": 0.05, \"blocks\": [{\"max\": [1, 0.4, 1]}]}}"};
    DONE(rivulet_world_create(context, &o, &world, &why));
    DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    to = (rivulet_target){.size = sizeof to, .framebuffer = make_target(WIDTH, HEIGHT), .width = WIDTH, .height = HEIGHT};
    /* From (0.5, 0.3, 4) along -z; 45 degrees high. */
    const float cot = 2.41421356F, near_plane = 0.1F, far_plane = 20;
    const float view[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -0.5F, -0.3F, -4, 1};
    float projection[16] = {cot * HEIGHT / WIDTH};
    projection[5] = cot;
    projection[10] = -(far_plane + near_plane) / (far_plane - near_plane);
    projection[11] = -1;
    projection[14] = -2 * far_plane * near_plane / (far_plane - near_plane);
    from = (rivulet_view){
        .size = sizeof from, .view = view, .projection = projection, .near_plane = near_plane, .far_plane = far_plane};
    unsigned char *a = malloc(BYTES), *b = malloc(BYTES);
    if (a == NULL || b == NULL) return 1;
    surroundings_are_reflected(context, a, b);
    lights_add(a, b);
    shade_is_without_the_sun(a, b);
    thick_fog_is_all_that_is_seen(a);
    free(a);
    free(b);
    rivulet_world_destroy(world);
    rivulet_context_destroy(context);
    CHECK(glGetError() == GL_NO_ERROR);
    printf("%s\n", failures == 0 ? "all holds" : "something does not hold");
    return failures == 0 ? 0 : 1;
}
