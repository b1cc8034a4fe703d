/* rivulet.h in a host's OpenGL: water is drawn into its picture, particles and a skin's map are given as its names. Exit 77: no OpenGL. */
#include <math.h>
#include <stdlib.h>

#include "check.h"
#include "host.h"

enum { WIDTH = 96, HEIGHT = 72 };
static unsigned char dry[4 * WIDTH * HEIGHT], wet[4 * WIDTH * HEIGHT];

/* The y component of each velocity in the buffers of a block that has fallen for 0.1 s: -0.98 m/s. Normals have other values. */
static void velocities_are_velocities(rivulet_context* context, const char* look) {
    char json[400];
    snprintf(json, sizeof json,
             "{\"fluid\": {\"spacing\": 0.05, \"box\": {\"max\": [1, 1.5, 1]}, \"forces\": {\"normals\": \"thesis\"},"
             " \"blocks\": [{\"min\": [0.3, 1, 0.3], \"max\": [0.7, 1.4, 0.7]}]}, \"look\": {%s}}",
             look);
    rivulet_world* world = NULL;
    const rivulet_world_options o = {.size = sizeof o, .json = json};
    DONE(rivulet_world_create(context, &o, &world, &why));
    for (int k = 0; k < 6; ++k) DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    rivulet_buffers buffers = {.size = sizeof buffers};
    DONE(rivulet_world_buffers(world, &buffers, &why));
    float* velocity = malloc(16 * (size_t)buffers.count);
    float* position = malloc(16 * (size_t)buffers.count);
    glGetNamedBufferSubData(buffers.velocity, 0, 16 * (GLsizeiptr)buffers.count, velocity);
    glGetNamedBufferSubData(buffers.position, 0, 16 * (GLsizeiptr)buffers.count, position);
    double sum = 0;
    int there = 0;
    for (uint32_t k = 0; k < buffers.count; ++k) {
        if (position[4 * k + 3] < 0) continue;
        ++there;
        sum += (double)velocity[4 * k + 1];
    }
    CHECK(there == 512 && fabs(sum / there + 0.981) < 0.02);
    free(velocity);
    free(position);
    rivulet_world_destroy(world);
}

/* Points coloured by normals, of a world that was not told to find normals: as where it was told. */
static void normals_are_found_where_they_are_drawn(rivulet_context* context, const rivulet_view* from, const rivulet_target* to) {
    const char* scenes[2] = {
        "{\"fluid\": {\"spacing\": 0.05, \"blocks\": [{\"max\": [1, 0.4, 1]}]},"
        " \"look\": {\"renderer\": \"points\", \"colourBy\": \"normal\"}}",
        "{\"fluid\": {\"spacing\": 0.05, \"blocks\": [{\"max\": [1, 0.4, 1]}], \"forces\": {\"normals\": \"thesis\"}},"
        " \"look\": {\"renderer\": \"points\", \"colourBy\": \"normal\"}}"};
    unsigned char* pictures[2] = {dry, wet};
    for (int k = 0; k < 2; ++k) {
        rivulet_world* world = NULL;
        const rivulet_world_options o = {.size = sizeof o, .json = scenes[k]};
        DONE(rivulet_world_create(context, &o, &world, &why));
        DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        DONE(rivulet_world_draw(world, from, to, &why));
        glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, pictures[k]);
        rivulet_world_destroy(world);
    }
    CHECK(memcmp(dry, wet, sizeof dry) == 0);
}

enum { MAP = 64, SIDE = 11, PLACES = SIDE * SIDE };
static float maps[2][4 * MAP * MAP];

/* Where the liquid of a map is, in v, 0 to 1. */
static double middle_of(const float* texels) {
    double sum = 0, height = 0;
    for (int k = 0; k < MAP * MAP; ++k) {
        height += (double)texels[4 * k + 2];
        sum += (double)texels[4 * k + 2] * (k / MAP + 0.5) / MAP;
    }
    return sum / height;
}

/* A compute shader tips up a plate of 10 cm about its middle: its drop runs down, as on a plate that the host tips up itself. */
static void a_skin_follows_a_buffer(const char* backend) {
    rivulet_context* context = NULL;
    const rivulet_context_options o = {.size = sizeof o, .find = eglGetProcAddress, .backend = backend};
    DONE(rivulet_context_create(&o, &context, &why));
    static float at[3 * PLACES], uvs[2 * PLACES], moved[4 * PLACES], places[3 * PLACES];
    static uint32_t triangles[6 * (SIDE - 1) * (SIDE - 1)];
    for (int k = 0; k < PLACES; ++k) {
        uvs[2 * k] = (float)(k % SIDE) / (SIDE - 1);
        uvs[2 * k + 1] = (float)(k / SIDE) / (SIDE - 1);
        at[3 * k] = 0.1F * uvs[2 * k];
        at[3 * k + 2] = -0.1F * uvs[2 * k + 1];
    }
    for (uint32_t k = 0; k < (SIDE - 1) * (SIDE - 1); ++k) {
        const uint32_t low = k / (SIDE - 1) * SIDE + k % (SIDE - 1), high = low + SIDE;
        const uint32_t tile[6] = {low, low + 1, high + 1, low, high + 1, high};
        memcpy(triangles + 6 * k, tile, sizeof tile);
    }
    const rivulet_mesh plate = {.size = sizeof plate,
                                .positions = at,
                                .vertices = PLACES,
                                .indices = triangles,
                                .indices_count = sizeof triangles / sizeof *triangles,
                                .uvs = uvs};
    const rivulet_skin_options skin_options = {.size = sizeof skin_options, .mesh = &plate, .map_size = MAP};
    rivulet_skin* skins[2] = {NULL, NULL}; /* from the buffer; from host memory */
    for (int k = 0; k < 2; ++k) {
        DONE(rivulet_skin_create(context, &skin_options, &skins[k], &why));
        DONE(rivulet_skin_add(skins[k], (const float[3]){0.05F, 0, -0.07F}, 12, &why));
    }
    const char* source = "#version 450\nlayout(local_size_x = 121) in; layout(binding = 3, std430) buffer Moved { vec4 moved[]; };"
                         "uniform float tilt; void main() { uint i = gl_LocalInvocationIndex; float away = 0.01 * float(i / 11u) - 0.05;"
                         "moved[i] = vec4(0.01 * float(i % 11u), away * sin(tilt), -0.05 - away * cos(tilt), 7.0); }";
    const GLuint program = glCreateShaderProgramv(GL_COMPUTE_SHADER, 1, &source);
    GLuint buffers[2];
    glCreateBuffers(2, buffers);
    glNamedBufferStorage(buffers[0], sizeof moved, NULL, 0);
    glNamedBufferStorage(buffers[1], 63, NULL, GL_MAP_READ_BIT);
    double before = 0, after = 0;
    for (int frame = 0; frame < 40; ++frame) {
        glUseProgram(program);
        glProgramUniform1f(program, glGetUniformLocation(program, "tilt"), fminf(1.4F, 0.05F * (float)frame));
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, buffers[0]);
        glDispatchCompute(1, 1, 1);
        const rivulet_skin_inputs in = {.size = sizeof in, .positions_buffer = buffers[0]};
        DONE(rivulet_skin_step(skins[0], &in, 1.0 / 60, &why));
        GLint used = 0;
        glGetIntegerv(GL_CURRENT_PROGRAM, &used);
        CHECK((GLuint)used == program);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        glGetNamedBufferSubData(buffers[0], 0, sizeof moved, moved);
        for (int k = 0; k < 3 * PLACES; ++k) places[k] = moved[4 * (k / 3) + k % 3];
        const rivulet_skin_inputs same = {.size = sizeof same, .positions = places};
        DONE(rivulet_skin_step(skins[1], &same, 1.0 / 60, &why));
        for (int k = 0; k < 2; ++k) {
            uint32_t map = 0;
            DONE(rivulet_skin_texture(skins[k], &map, &why));
            glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
            glGetTextureImage(map, 0, GL_RGBA, GL_FLOAT, sizeof maps[k], maps[k]);
        }
        if (frame == 1) before = middle_of(maps[0]);
        after = middle_of(maps[0]);
        CHECK(memcmp(maps[0], maps[1], sizeof maps[0]) == 0);
    }
    printf("%s: a drop on a plate that a shader tips up is at v = %.2f, then %.2f\n", backend, before, after);
    CHECK(fabs(before - 0.7) < 0.03 && after < 0.5);
    for (int k = 0; k < 2; ++k) {
        rivulet_skin_stats s = {.size = sizeof s};
        DONE(rivulet_skin_stats_of(skins[k], &s, &why));
        CHECK(fabs(s.added - 12e-9) < 1e-14 && fabs(s.added - s.on_skin - s.left - s.evaporated - s.refused) < 1e-14);
    }
    rivulet_skin_inputs wrong = {.size = sizeof wrong, .positions_buffer = buffers[1]};
    REFUSED(rivulet_skin_step(skins[0], &wrong, 1.0 / 60, &why), "has 63 bytes: a skin of 121 vertices needs 1936");
    wrong.positions_buffer = 123456;
    REFUSED(rivulet_skin_step(skins[0], &wrong, 1.0 / 60, &why), "is 123456, which is not the name of a buffer");
    wrong.positions_buffer = buffers[0];
    wrong.positions = at;
    REFUSED(rivulet_skin_step(skins[0], &wrong, 1.0 / 60, &why), "both set");
    GLuint large = 0;
    glCreateBuffers(1, &large);
    glNamedBufferStorage(large, sizeof moved, NULL, GL_MAP_READ_BIT);
    CHECK(glMapNamedBuffer(large, GL_READ_ONLY) != NULL);
    const rivulet_skin_inputs held = {.size = sizeof held, .positions_buffer = large};
    REFUSED(rivulet_skin_step(skins[0], &held, 1.0 / 60, &why), "is mapped");
    glUnmapNamedBuffer(large);
    for (int k = 0; k < 2; ++k) rivulet_skin_destroy(skins[k]);
    CHECK(glIsBuffer(buffers[0])); /* the host's */
    rivulet_context_destroy(context);
    glUseProgram(0);
    glDeleteBuffers(2, buffers);
    glDeleteBuffers(1, &large);
    glDeleteProgram(program);
}

int main(void) {
    rivulet_context* context = NULL;
    rivulet_context_options options = {.size = sizeof options, .find = eglGetProcAddress};
    if (eglGetProcAddress("glGetString") != NULL) {
        CHECK(rivulet_context_create(&options, &context, &why) == RIVULET_FAILED && strstr(why.message, "current") != NULL);
    }
    if (!make_current()) return 77;
    options.backend = "cpu"; /* and drawn with OpenGL */
    DONE(rivulet_context_create(&options, &context, &why));
    if (context == NULL) return 1;
    const GLuint framebuffer = make_target(WIDTH, HEIGHT);
    glClearColor(0.5F, 0.25F, 0.25F, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, dry);

    rivulet_world* world = NULL;
    const rivulet_world_options o = {.size = sizeof o, .json = "{\"fluid\": {\"spacing\": 0.05, \"blocks\": [{\"max\": [1, 0.4, 1]}]}}"};
    DONE(rivulet_world_create(context, &o, &world, &why));
    /* From (0.5, 0.3, 4) along -z; 45 degrees high. */
    const float cot = 2.41421356F, near_plane = 0.1F, far_plane = 20;
    const float view[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -0.5F, -0.3F, -4, 1};
    const float projection[16] = {cot * HEIGHT / WIDTH,
                                  0,
                                  0,
                                  0,
                                  0,
                                  cot,
                                  0,
                                  0,
                                  0,
                                  0,
                                  -(far_plane + near_plane) / (far_plane - near_plane),
                                  -1,
                                  0,
                                  0,
                                  -2 * far_plane * near_plane / (far_plane - near_plane),
                                  0};
    const rivulet_view from = {
        .size = sizeof from, .view = view, .projection = projection, .near_plane = near_plane, .far_plane = far_plane};
    const rivulet_target to = {.size = sizeof to, .framebuffer = framebuffer, .width = WIDTH, .height = HEIGHT};
    for (int k = 0; k < 3; ++k) {
        DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
        DONE(rivulet_world_draw(world, &from, &to, &why));
    }
    GLint bound = 0;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &bound);
    CHECK((GLuint)bound == framebuffer);
    glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, wet);
    /* The block's front, 3 m away, is 0.4 m high: from 0.3 m below the middle to 0.1 m above it. */
    const double metre = 0.5 * HEIGHT * (double)cot / 3, left = 0.5 * WIDTH - 0.5 * metre, right = 0.5 * WIDTH + 0.5 * metre;
    const double bottom = 0.5 * HEIGHT - 0.3 * metre, top = 0.5 * HEIGHT + 0.1 * metre;
    int inside = 0, changed = 0;
    for (int y = 0; y < HEIGHT; ++y)
        for (int x = 0; x < WIDTH; ++x) {
            const int differs = memcmp(dry + 4 * (y * WIDTH + x), wet + 4 * (y * WIDTH + x), 4) != 0;
            if (x < left - 2 || x > right + 2 || y < bottom - 2 || y > top + 2) CHECK(!differs);
            if (x > left + 2 && x < right - 2 && y > bottom + 2 && y < top - 2) {
                ++inside;
                changed += differs;
            }
        }
    printf("%d of %d changed\n", changed, inside);
    CHECK(inside > 150 && changed > 0.98 * inside);

    rivulet_buffers buffers = {.size = sizeof buffers};
    DONE(rivulet_world_buffers(world, &buffers, &why));
    CHECK(glIsBuffer(buffers.position) && glIsBuffer(buffers.velocity) && glIsBuffer(buffers.id));
    CHECK(buffers.count >= 3200 && buffers.radius > 0.02F && buffers.radius < 0.05F);
    float* drawn = malloc(16 * (size_t)buffers.count);
    glGetNamedBufferSubData(buffers.position, 0, 16 * (GLsizeiptr)buffers.count, drawn);
    rivulet_stats stats = {.size = sizeof stats};
    DONE(rivulet_world_stats(world, &stats, &why));
    double middle = 0;
    uint32_t there = 0;
    for (uint32_t k = 0; k < buffers.count; ++k) {
        if (drawn[4 * k + 3] < 0) continue;
        ++there;
        middle += (double)drawn[4 * k + 1];
    }
    free(drawn);
    CHECK(there == stats.particles && fabs(middle / there - stats.centre_of_mass[1]) < 1e-4);
    REFUSED(rivulet_world_buffers(world, NULL, &why), "buffers is NULL");

    velocities_are_velocities(context, "\"colourBy\": \"speed\"");
    velocities_are_velocities(context, "\"colourBy\": \"normal\"");
    velocities_are_velocities(context, "\"colourBy\": \"surface\"");
    normals_are_found_where_they_are_drawn(context, &from, &to);

    rivulet_view wrong = from;
    wrong.projection = NULL;
    REFUSED(rivulet_world_draw(world, &wrong, &to, &why), "projection is NULL");
    wrong = from;
    wrong.far_plane = INFINITY;
    REFUSED(rivulet_world_draw(world, &wrong, &to, &why), "far plane");
    rivulet_target nothing = to;
    nothing.height = 0;
    REFUSED(rivulet_world_draw(world, &from, &nothing, &why), "x 0");

    const float at[12] = {0, 0, 0, 0.1F, 0, 0, 0.1F, 0.1F, 0, 0, 0.1F, 0}, uvs[8] = {0, 0, 1, 0, 1, 1, 0, 1};
    const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
    const rivulet_mesh plate = {.size = sizeof plate, .positions = at, .vertices = 4, .indices = triangles, .indices_count = 6, .uvs = uvs};
    const rivulet_skin_options skin_options = {.size = sizeof skin_options, .mesh = &plate, .map_size = 256};
    rivulet_skin* skin = NULL;
    DONE(rivulet_skin_create(context, &skin_options, &skin, &why));
    DONE(rivulet_skin_add(skin, (const float[3]){0.05F, 0.05F, 0}, 10, &why));
    DONE(rivulet_skin_step(skin, NULL, 1.0 / 60, &why));
    uint32_t map = 0;
    DONE(rivulet_skin_texture(skin, &map, &why));
    CHECK(glIsTexture(map));
    static float texels[4 * 256 * 256];
    glGetTextureImage(map, 0, GL_RGBA, GL_FLOAT, sizeof texels, texels);
    double volume = 0; /* mm over a texel of 0.1 m / 256 */
    for (int k = 0; k < 256 * 256; ++k) volume += (double)texels[4 * k + 2] * 1e-3 * pow(0.1 / 256, 2);
    printf("10 microlitres are %.2f in the map\n", volume * 1e9);
    CHECK(fabs(volume - 10e-9) < 0.5e-9);

    /* Another context is current, whose names are others' things, and then none: nothing is done, nothing is deleted. */
    const EGLDisplay display = eglGetCurrentDisplay();
    const EGLContext own = eglGetCurrentContext();
    CHECK(make_current() && eglGetCurrentContext() != own);
    GLuint theirs[256];
    glGenTextures(256, theirs);
    for (int k = 0; k < 256; ++k) glBindTexture(GL_TEXTURE_2D, theirs[k]);
    for (int k = 0; k < 2; ++k) {
        REFUSED(rivulet_world_draw(world, &from, &to, &why), "not current");
        REFUSED(rivulet_world_buffers(world, &buffers, &why), "not current");
        REFUSED(rivulet_skin_texture(skin, &map, &why), "not current");
        DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why)); /* the cpu's own */
        rivulet_skin_destroy(skin);
        rivulet_world_destroy(world);
        rivulet_context_destroy(context);
        if (k == 0)
            for (int t = 0; t < 256; ++t) CHECK(glIsTexture(theirs[t]));
        CHECK(eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT));
    }
    CHECK(eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, own));
    DONE(rivulet_world_draw(world, &from, &to, &why));
    rivulet_target painted = to;
    painted.colours = 77;
    REFUSED(rivulet_world_draw(world, &from, &painted, &why), "colours is 77");

    CHECK(rivulet_context_memory(context) > 4 * WIDTH * HEIGHT);
    rivulet_skin_destroy(skin);
    rivulet_world_destroy(world);
    CHECK(!glIsTexture(map) && !glIsBuffer(buffers.position));
    rivulet_context_destroy(context);
    a_skin_follows_a_buffer("cpu");
    a_skin_follows_a_buffer("gl");
    CHECK(glGetError() == GL_NO_ERROR);
    printf("%s\n", failures == 0 ? "all holds" : "something does not hold");
    return failures == 0 ? 0 : 1;
}
