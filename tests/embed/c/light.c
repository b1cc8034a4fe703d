/* rivulet.h in a host's light: its surroundings. Exit 77: no OpenGL. */
#include <stdlib.h>

#include "check.h"
#include "host.h"

enum { WIDTH = 96, HEIGHT = 72, BYTES = 4 * WIDTH * HEIGHT };

static rivulet_error why;
static rivulet_world* world;
static rivulet_view from;
static rivulet_target to;

/* The picture of the water. */
static const unsigned char* picture(unsigned char* into) {
    glClearColor(0.5F, 0.25F, 0.25F, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    DONE(rivulet_world_draw(world, &from, &to, &why));
    glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, into);
    return into;
}

static int sum(const unsigned char* pixels, int channel) {
    int all = 0;
    for (int k = 0; k < WIDTH * HEIGHT; ++k) all += pixels[4 * k + channel];
    return all;
}

static void surroundings_are_reflected(rivulet_context* context, unsigned char* a, unsigned char* b) {
    static float green[3 * 8 * 4];
    for (int k = 0; k < 8 * 4; ++k) green[3 * k + 1] = 5;
    const rivulet_surroundings image = {.size = sizeof image, .pixels = green, .width = 8, .height = 4};
    const int before = sum(picture(a), 1);
    DONE(rivulet_context_set_surroundings(context, &image, &why));
    CHECK(sum(picture(a), 1) > before + 1000);
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
    CHECK(memcmp(picture(b), a, BYTES) == 0);
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
    CHECK(memcmp(picture(b), a, BYTES) == 0);
    glDeleteTextures(1, &cube);
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
    from = (rivulet_view){.size = sizeof from, .view = view, .projection = projection, .near_plane = near_plane, .far_plane = far_plane};
    unsigned char *a = malloc(BYTES), *b = malloc(BYTES);
    if (a == NULL || b == NULL) return 1;
    surroundings_are_reflected(context, a, b);
    free(a);
    free(b);
    rivulet_world_destroy(world);
    rivulet_context_destroy(context);
    CHECK(glGetError() == GL_NO_ERROR);
    printf("%s\n", failures == 0 ? "all holds" : "something does not hold");
    return failures == 0 ? 0 : 1;
}
