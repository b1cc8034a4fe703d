/* rivulet.h in a host's scene: surroundings, several lights, a shadow map, fog, and a renderer of its own. Exit 77: no OpenGL. */
#include <math.h>
#include <stdlib.h>

#include "check.h"
#include "host.h"

enum { WIDTH = 96, HEIGHT = 72, BYTES = 4 * WIDTH * HEIGHT };

static rivulet_world* world;
static rivulet_snapshot* snapshot;
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
    /* So is a layer of an array, of which another layer is without shade. */
    const float far_away = 1;
    GLuint array = 0, layer = 0;
    glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &array);
    glTextureStorage3D(array, 1, GL_DEPTH_COMPONENT24, 1, 1, 2);
    glTextureSubImage3D(array, 0, 0, 0, 0, 1, 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &far_away);
    glTextureSubImage3D(array, 0, 0, 0, 1, 1, 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
    glGenTextures(1, &layer);
    glTextureView(layer, GL_TEXTURE_2D, array, GL_DEPTH_COMPONENT24, 0, 1, 1, 1);
    rivulet_shadow wrong = shadow;
    wrong.texture = layer;
    lighting.shadow = &wrong;
    CHECK(memcmp(picture(b, &lighting), a, BYTES) == 0);
    wrong.texture = array;
    refuses(&lighting, "texture view");
    glDeleteTextures(1, &layer);
    glDeleteTextures(1, &array);
    wrong = shadow;
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

/* A host's renderer: a green plane across the view, or green points at the particles. */
typedef struct painter {
    int calls;
    float metres; /* of the plane before the eye; 0: points */
    GLuint plane, points, array;
} painter;

static const char* const kGreen = "#version 450\nlayout(location = 0) out vec4 c; void main() { c = vec4(0, 1, 0, 1); }";

static void paint(void* user, const rivulet_drawing* drawing) {
    painter* p = user;
    ++p->calls;
    GLint bound = 0, viewport[4] = {0};
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    glGetIntegerv(GL_VIEWPORT, viewport);
    CHECK((GLuint)bound == drawing->framebuffer && viewport[2] == WIDTH && viewport[3] == HEIGHT);
    CHECK(drawing->width == WIDTH && drawing->height == HEIGHT && !glIsEnabled(GL_DEPTH_TEST) && !glIsEnabled(GL_BLEND));
    glBindVertexArray(p->array);
    glEnable(GL_DEPTH_TEST);
    if (p->metres > 0) {
        const float z = (drawing->projection[14] - drawing->projection[10] * p->metres) / p->metres;
        glUseProgram(p->plane);
        glUniform1f(0, z);
        glDrawArrays(GL_TRIANGLES, 0, 3);
    } else {
        glUseProgram(p->points);
        glUniformMatrix4fv(0, 1, GL_FALSE, drawing->view);
        glUniformMatrix4fv(1, 1, GL_FALSE, drawing->projection);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, drawing->particles->position);
        glPointSize(4);
        glDrawArrays(GL_POINTS, 0, (GLsizei)drawing->particles->count);
    }
    /* Any state may be left. */
    glEnable(GL_BLEND);
    glBlendFunc(GL_ZERO, GL_ZERO);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glViewport(1, 2, 3, 4);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

/* What a renderer calls back is refused, in the draw of a world and of a snapshot. */
static int refused_calls;
static void call_back(void* user, const rivulet_drawing* drawing) {
    (void)drawing;
    rivulet_context* context = user;
    rivulet_error no;
    rivulet_stats stats = {.size = sizeof stats};
    refused_calls += rivulet_world_stats(world, &stats, &no) == RIVULET_BAD_INPUT;
    refused_calls += rivulet_world_step(world, NULL, 1.0 / 60, &no) == RIVULET_BAD_INPUT;
    refused_calls += rivulet_world_draw(world, &from, &to, &no) == RIVULET_BAD_INPUT;
    refused_calls += rivulet_world_snapshot(world, snapshot, &no) == RIVULET_BAD_INPUT;
    refused_calls += rivulet_snapshot_draw(snapshot, &from, &to, &no) == RIVULET_BAD_INPUT;
    refused_calls += rivulet_context_lost(context, &no) == RIVULET_BAD_INPUT;
    rivulet_snapshot_destroy(snapshot); /* is refused and logged */
}

static void a_renderer_must_not_call_back(rivulet_context* context) {
    const rivulet_renderer renderer = {.size = sizeof renderer, .draw = call_back, .user = context};
    from.renderer = &renderer;
    DONE(rivulet_world_snapshot(world, snapshot, &why));
    refused_calls = 0;
    DONE(rivulet_world_draw(world, &from, &to, &why));
    CHECK(refused_calls == 6);
    DONE(rivulet_snapshot_draw(snapshot, &from, &to, &why));
    CHECK(refused_calls == 12);
    from.renderer = NULL;
    DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    DONE(rivulet_world_snapshot(world, snapshot, &why));
    DONE(rivulet_snapshot_draw(snapshot, &from, &to, &why));
}

/* A huge image is refused before any of it is read: there is not a hundredth of it here. */
static void surroundings_keep_to_the_memory_limit(void) {
    rivulet_context* context = NULL;
    const rivulet_context_options options = {
        .size = sizeof options, .find = eglGetProcAddress, .backend = "cpu", .memory_limit = (size_t)64 << 20};
    DONE(rivulet_context_create(&options, &context, &why));
    static const float black[3 * 8 * 4];
    rivulet_surroundings image = {.size = sizeof image, .pixels = black, .width = 16384, .height = 16384};
    const size_t before = rivulet_context_memory(context);
    CHECK(rivulet_context_set_surroundings(context, &image, &why) == RIVULET_FAILED && strstr(why.message, "smaller image") != NULL);
    CHECK(rivulet_context_memory(context) == before);
    image.width = 8;
    image.height = 4;
    DONE(rivulet_context_set_surroundings(context, &image, &why));
    rivulet_context_destroy(context);
}

static int is_green(const unsigned char* p) { return p[0] == 0 && p[1] == 255 && p[2] == 0; }

static void a_hosts_renderer_draws(unsigned char* a, unsigned char* b) {
    painter p = {.plane = program_of("#version 450\nlayout(location = 0) uniform float z;"
                                     "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, z, 1); }",
                                     kGreen),
                 .points = program_of("#version 450\nlayout(location = 0) uniform mat4 view; layout(location = 1) uniform mat4 projection;"
                                      "layout(std430, binding = 0) readonly buffer At { vec4 at[]; };"
                                      "void main() { vec4 p = at[gl_VertexID];"
                                      "gl_Position = p.w < 0 ? vec4(2, 2, 2, 1) : projection * view * vec4(p.xyz, 1); }",
                                      kGreen)};
    glGenVertexArrays(1, &p.array);
    rivulet_renderer renderer = {.size = sizeof renderer, .stage = RIVULET_INSTEAD, .draw = paint, .user = &p};
    picture(a, NULL); /* Rivulet's own */
    from.renderer = &renderer;
    /* Its points are where the block is, which is 1 m wide and 3 to 4 m away: two pixels around it are a point's size. */
    picture(b, NULL);
    CHECK(p.calls == 1);
    GLint bound = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    CHECK((uint32_t)bound == to.framebuffer && !glIsEnabled(GL_BLEND));
    const double metre = 0.5 * HEIGHT * 2.41421356 / 3;
    int green = 0;
    for (int y = 0; y < HEIGHT; ++y)
        for (int x = 0; x < WIDTH; ++x) {
            const unsigned char* pixel = b + 4 * (y * WIDTH + x);
            if (!is_water(pixel)) continue;
            CHECK(is_green(pixel));
            CHECK(fabs(x - 0.5 * WIDTH) < 0.5 * metre + 3 && y > 0.5 * HEIGHT - 0.3 * metre - 3 && y < 0.5 * HEIGHT + 0.1 * metre + 3);
            ++green;
        }
    CHECK(green > 150);
    float depth = 1;
    glReadPixels(WIDTH / 2, (GLint)(0.5 * HEIGHT - 0.1 * metre), 1, 1, GL_DEPTH_COMPONENT, GL_FLOAT, &depth);
    CHECK(depth < 1);
    /* A plane within the block is behind the water's surface, and in view beside it; one before the block hides it. */
    renderer.stage = RIVULET_AFTER;
    p.metres = 3.7F;
    picture(b, NULL);
    int same = 0, water = 0;
    for (int k = 0; k < WIDTH * HEIGHT; ++k) {
        const int is = is_water(a + 4 * k);
        water += is;
        same += is ? memcmp(a + 4 * k, b + 4 * k, 4) == 0 : is_green(b + 4 * k);
    }
    CHECK(water > 150 && same > WIDTH * HEIGHT - 40);
    p.metres = 2;
    picture(b, NULL);
    for (int k = 0; k < WIDTH * HEIGHT; ++k) CHECK(is_green(b + 4 * k));
    /* So in a snapshot. */
    DONE(rivulet_world_snapshot(world, snapshot, &why));
    p.calls = 0;
    rivulet_view view = from;
    DONE(rivulet_snapshot_draw(snapshot, &view, &to, &why));
    CHECK(p.calls == 1);
    renderer.stage = 5;
    refuses(NULL, "RIVULET_INSTEAD");
    renderer.stage = RIVULET_INSTEAD;
    renderer.draw = NULL;
    refuses(NULL, "draw is NULL");
    from.renderer = NULL;
    CHECK(memcmp(picture(b, NULL), a, BYTES) == 0);
    glDeleteProgram(p.plane);
    glDeleteProgram(p.points);
    glDeleteVertexArrays(1, &p.array);
}

int main(void) {
    if (!make_current()) return 77;
    rivulet_context* context = NULL;
    const rivulet_context_options options = {.size = sizeof options, .find = eglGetProcAddress, .backend = "cpu"};
    DONE(rivulet_context_create(&options, &context, &why));
    const rivulet_world_options o = {.size = sizeof o, .json = "{\"fluid\": {\"spacing\": 0.05, \"blocks\": [{\"max\": [1, 0.4, 1]}]}}"};
    DONE(rivulet_world_create(context, &o, &world, &why));
    DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    DONE(rivulet_snapshot_create(context, &snapshot, &why));
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
    lights_add(a, b);
    shade_is_without_the_sun(a, b);
    thick_fog_is_all_that_is_seen(a);
    from.light_colour[0] = from.light_colour[1] = from.light_colour[2] = 1;
    a_hosts_renderer_draws(a, b);
    a_renderer_must_not_call_back(context);
    surroundings_keep_to_the_memory_limit();
    free(a);
    free(b);
    rivulet_snapshot_destroy(snapshot);
    rivulet_world_destroy(world);
    rivulet_context_destroy(context);
    CHECK(glGetError() == GL_NO_ERROR);
    printf("%s\n", failures == 0 ? "all holds" : "something does not hold");
    return failures == 0 ? 0 : 1;
}
