/* Attributes of particles and dry volumes from C. With OpenGL a shader of the host's own draws points coloured by an attribute; a path as
   argument: that picture as a .ppm. Exit 77: no OpenGL. */
#include <math.h>
#include <stdlib.h>

#include "check.h"
#include "host.h"

enum { WIDTH = 480, HEIGHT = 320, MOST = 8192 };
static float positions[3 * MOST], origins[4 * MOST], dyes[4 * MOST], rows[4 * MOST], drawn[4 * MOST];
static uint32_t ids[MOST], row_ids[MOST];
static unsigned char picture[3 * WIDTH * HEIGHT];

static size_t read_all(rivulet_world* world) {
    rivulet_particles all = {
        .size = sizeof all, .capacity = MOST, .positions = positions, .ids = ids, .attributes = {origins, dyes, NULL, NULL}};
    DONE(rivulet_world_particles(world, &all, &why));
    return all.count;
}

static rivulet_world* dam(rivulet_context* context) {
    rivulet_world* world = NULL;
    const rivulet_world_options o = {
        .size = sizeof o,
        .json =
            "{\"fluid\": {\"spacing\": 0.025, \"box\": {\"max\": [1, 0.6, 0.25]},"
            " \"attributes\": [{\"name\": \"origin\"}, {\"name\": \"dye\", \"z\": 1}],"
            " \"blocks\": [{\"max\": [0.4, 0.4, 0.25], \"attributes\": [{\"name\": \"dye\", \"y\": 0.5, \"z\": 0.5}]}]}}"};
    DONE(rivulet_world_create(context, &o, &world, &why));
    return world;
}

/* Each particle gets its place as a value, and is dyed in a ball. A second later both are still its own. */
static size_t values_stay(rivulet_world* world) {
    static uint32_t first[MOST];
    static float given[4 * MOST];
    const size_t count = read_all(world);
    for (size_t k = 0; k < count; ++k) {
        CHECK(dyes[4 * k + 1] == 0.5F && origins[4 * k] == 0);
        first[k] = ids[k];
        memcpy(given + 4 * k, positions + 3 * k, 3 * sizeof(float));
        given[4 * k + 3] = (float)ids[k];
    }
    DONE(rivulet_world_set_attribute(world, 0, first, given, count, &why));
    const rivulet_volume ball = {.shape = RIVULET_SPHERE, .position = {0.2F, 0.2F, 0.125F}, .radius = 0.12F};
    DONE(rivulet_world_paint(world, 1, &ball, (const float[4]){1, 0, 0, 1}, &why));
    for (int k = 0; k < 30; ++k) DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    CHECK(read_all(world) == count);
    /* Without a copy: the same particles in the same order, but for rows that hold none. */
    rivulet_rows memory = {.size = sizeof memory};
    DONE(rivulet_world_rows(world, &memory, &why));
    size_t seen = 0;
    for (size_t k = 0; k < memory.count; ++k) {
        if (memory.positions[4 * k + 3] < 0) continue;
        CHECK(memory.ids[k] == ids[seen] && memcmp(memory.positions + 4 * k, positions + 3 * seen, 3 * sizeof(float)) == 0);
        CHECK(memcmp(memory.attributes[0] + 4 * k, origins + 4 * seen, 4 * sizeof(float)) == 0 && memory.attributes[2] == NULL);
        ++seen;
    }
    CHECK(seen == count);
    int red = 0;
    for (size_t k = 0; k < count; ++k) {
        const float dx = origins[4 * k] - 0.2F, dy = origins[4 * k + 1] - 0.2F, dz = origins[4 * k + 2] - 0.125F;
        CHECK(origins[4 * k + 3] == (float)ids[k]);
        CHECK((dyes[4 * k] == 1) == (sqrtf(dx * dx + dy * dy + dz * dz) <= 0.12F));
        red += dyes[4 * k] == 1;
    }
    CHECK(red > 300 && red < 600); /* 4/3 pi 0.12^3 m^3 are 463 */
    return count;
}

static void what_cannot_be_is_refused(rivulet_world* world) {
    rivulet_rows unsized = {0};
    REFUSED(rivulet_world_rows(NULL, &unsized, &why), "world is NULL");
    REFUSED(rivulet_world_rows(world, NULL, &why), "rows is NULL");
    REFUSED(rivulet_world_rows(world, &unsized, &why), "sizeof(rivulet_rows)");
    const rivulet_volume flat = {.shape = 2}, box = {.size = {1, 1, 1}};
    const float red[4] = {1, 0, 0, 1}, endless[4] = {INFINITY, 0, 0, 0};
    const uint32_t none = MOST;
    REFUSED(rivulet_world_set_attribute(world, 2, ids, red, 1, &why), "there is no attribute 2");
    REFUSED(rivulet_world_set_attribute(world, 0, NULL, red, 1, &why), "NULL");
    REFUSED(rivulet_world_set_attribute(world, 0, &none, red, 1, &why), "ids[0] is 8192");
    REFUSED(rivulet_world_set_attribute(world, 0, ids, endless, 1, &why), "not finite");
    static float more[4 * MOST];
    rivulet_particles beyond = {.size = sizeof beyond, .capacity = MOST, .attributes = {NULL, NULL, more}};
    REFUSED(rivulet_world_particles(world, &beyond, &why), "particles.attributes[2] is given, and fluid.attributes has 2");
    REFUSED(rivulet_world_set_attribute(NULL, 0, ids, red, 1, &why), "NULL");
    REFUSED(rivulet_world_paint(world, 0, &flat, red, &why), "volume.shape is 2");
    REFUSED(rivulet_world_paint(world, 0, &box, NULL, &why), "NULL");
    REFUSED(rivulet_world_set(world, "fluid.attributes.0.x=1", &why), "fixed");
    REFUSED(rivulet_world_set_sources(world, "{\"dry\": [{\"size\": [1, 0, 1]}]}", &why), "give three lengths above 0");
    REFUSED(rivulet_world_set_sources(world, "{\"dry\": [{\"size\": [1, 1, 1], \"body\": 0}]}", &why), "no body has this id");
}

/* Nothing is where it is dry, and what was there is gone. */
static void a_volume_stays_dry(rivulet_world* world) {
    const size_t before = read_all(world);
    DONE(rivulet_world_set_sources(world, "{\"dry\": [{\"position\": [0.5, 0, 0.125], \"size\": [0.2, 0.4, 0.3]}]}", &why));
    for (int frame = 0; frame < 10; ++frame) {
        DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
        const size_t count = read_all(world);
        CHECK(count < before && count > before / 2);
        for (size_t k = 0; k < count; ++k)
            CHECK(!(positions[3 * k] > 0.401F && positions[3 * k] < 0.599F && positions[3 * k + 1] < 0.199F));
        DONE(rivulet_world_set(world, "dry.0.position=[0.5, 0, 0.12]", &why));
    }
}

/* Row i of all buffers is the same particle; a shader of the host's colours each point by its dye. */
static void a_shader_reads_them(rivulet_world* world, const char* path) {
    const size_t count = read_all(world);
    rivulet_buffers buffers = {.size = sizeof buffers};
    DONE(rivulet_world_buffers(world, &buffers, &why));
    CHECK(buffers.attributes[0] != 0 && buffers.attributes[1] != 0 && buffers.attributes[2] == 0 && buffers.count <= MOST);
    glGetNamedBufferSubData(buffers.attributes[0], 0, 16 * (GLsizeiptr)buffers.count, rows);
    glGetNamedBufferSubData(buffers.position, 0, 16 * (GLsizeiptr)buffers.count, drawn);
    glGetNamedBufferSubData(buffers.id, 0, 4 * (GLsizeiptr)buffers.count, row_ids);
    size_t there = 0;
    for (uint32_t i = 0; i < buffers.count; ++i) {
        if (drawn[4 * i + 3] < 0) continue;
        ++there;
        CHECK(rows[4 * i + 3] == (float)row_ids[i]);
    }
    CHECK(there == count);
    const char* sources[2] = {
        "#version 450\nlayout(binding = 0, std430) readonly buffer P { vec4 position[]; };"
        "layout(binding = 1, std430) readonly buffer A { vec4 dyes[]; }; out vec3 dye;"
        "void main() { vec4 p = position[gl_VertexID]; dye = dyes[gl_VertexID].rgb * (0.4 + 2.4 * p.z);"
        "gl_Position = p.w < 0.0 ? vec4(2) : vec4(2.0 * p.x - 1.0, 3.2 * p.y - 0.96, 1.0 - 4.0 * p.z, 1.0);"
        "gl_PointSize = 11.0; }",
        "#version 450\nin vec3 dye; out vec4 colour; void main() {"
        "vec2 d = 2.0 * gl_PointCoord - 1.0; float r = dot(d, d); if (r > 1.0) discard;"
        "colour = vec4(dye * (0.4 + 0.6 * sqrt(1.0 - r)), 1.0); }"};
    const GLuint program = program_of(sources[0], sources[1]);
    GLuint array = 0;
    glGenVertexArrays(1, &array);
    glBindVertexArray(array);
    glUseProgram(program);
    glEnable(GL_PROGRAM_POINT_SIZE);
    glEnable(GL_DEPTH_TEST);
    glViewport(0, 0, WIDTH, HEIGHT);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers.position);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffers.attributes[1]);
    glDrawArrays(GL_POINTS, 0, (GLsizei)buffers.count);
    glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGB, GL_UNSIGNED_BYTE, picture);
    size_t red = 0, teal = 0;
    for (size_t k = 0; k < WIDTH * HEIGHT; ++k) {
        const unsigned char* p = picture + 3 * k;
        red += p[0] > 60 && p[1] == 0 && p[2] == 0;
        teal += p[0] == 0 && p[1] > 20 && p[2] == p[1];
    }
    CHECK(red > 1000 && teal > 10000);
    FILE* file = path != NULL ? fopen(path, "wb") : NULL;
    if (file != NULL) {
        fprintf(file, "P6 %d %d 255\n", WIDTH, HEIGHT);
        for (int y = HEIGHT - 1; y >= 0; --y) fwrite(picture + (size_t)3 * WIDTH * (size_t)y, 3, WIDTH, file);
        fclose(file);
    }
    glDisable(GL_DEPTH_TEST);
    glDeleteProgram(program);
    glDeleteVertexArrays(1, &array);
    CHECK(glGetError() == GL_NO_ERROR);
}

int main(int count, char** arguments) {
    const int gl = make_current();
    GLuint target = gl ? make_target(WIDTH, HEIGHT) : 0;
    for (int drawing = 0; drawing <= gl; ++drawing) {
        rivulet_context* context = NULL;
        const rivulet_context_options options = {.size = sizeof options, .backend = "cpu", .find = drawing ? eglGetProcAddress : NULL};
        DONE(rivulet_context_create(&options, &context, &why));
        if (context == NULL) return 1;
        rivulet_world* world = dam(context);
        if (world == NULL) return 1;
        values_stay(world);
        if (drawing) a_shader_reads_them(world, count > 1 ? arguments[1] : NULL);
        what_cannot_be_is_refused(world);
        a_volume_stays_dry(world);
        rivulet_world_destroy(world);
        rivulet_context_destroy(context);
    }
    if (target != 0) glDeleteFramebuffers(1, &target);
    if (failures > 0) return 1;
    return gl ? 0 : 77;
}
