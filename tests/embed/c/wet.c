/* A host's own material on a wall that water has touched: its fragment shader includes shaders/material/wet.glsl as installed, with the
   buffers where docs/embedding.md says. Argument: the folder of the installed headers. Exit 77: no OpenGL. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdlib.h>

#include "check.h"
#include "host.h"
#include "pool.h"

enum { WIDTH = 96, HEIGHT = 48, TEXT = 1 << 17 };
static unsigned char picture[4 * WIDTH * HEIGHT];

/* Appends a file below `folder` to `text`, each #include replaced by its file: what every host with GLSL in files does. */
static void include(char* text, const char* folder, const char* name) {
    char path[4096], line[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE* file = fopen(path, "rb");
    CHECK(file != NULL);
    if (file == NULL) {
        printf("%s is not installed\n", path);
        return;
    }
    while (fgets(line, sizeof line, file) != NULL) {
        char other[1024];
        if (sscanf(line, " # include \"%1023[^\"]\"", other) == 1) {
            if (strstr(other, "lang_") == NULL) include(text, folder, other); /* those of C++ are in other branches of #if */
            continue;
        }
        CHECK(strlen(text) + strlen(line) < TEXT);
        if (strlen(text) + strlen(line) < TEXT) strcat(text, line);
    }
    fclose(file);
}

/* The wall's face at z = 0.2 m, 1 m x 0.5 m, fills the picture. The light comes from the front; that of the surroundings is 0.3. */
static const char* kVertex =
    "#version 450\nout vec3 at; void main() { vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);"
    "at = vec3(corner * vec2(1.0, 0.5), 0.2); gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0); }";
static const char* kBegins =
    "#version 450\n"
    "struct Frame { vec4 lightDir; };\n"
    "const Frame frame = Frame(vec4(0.36, 0.48, -0.8, 0.0));\n"
    "vec3 ambient(vec3 normal) { return vec3(0.3); }\n"
    "vec3 environment(vec3 direction, float roughness) { return vec3(0.3); }\n";
static const char* kMain =
    "in vec3 at; layout(location = 0) out vec4 colour;\n"
    "void main() {\n"
    "    const vec3 normal = vec3(0.0, 0.0, -1.0), albedo = vec3(0.5), light = vec3(2.0);\n"
    "    Wet w = wetnessAt(at, normal, normal, 0.6, 0.0);\n"
    "    vec3 matte = darkened(albedo, w) * (0.3183099 * max(dot(normal, frame.lightDir.xyz), 0.0) * light + ambient(normal));\n"
    "    colour = vec4(wetted(matte, vec3(0.0), 0.0, w, normal, light, 1.0), 1.0);\n"
    "}\n";

static GLuint material(const char* folder) {
    char* text = calloc(TEXT, 1);
    strcat(text, kBegins);
    for (int k = 0; k < 3; ++k) {
        static const char* const kNames[3] = {"surface.glsl", "noise.glsl", "wet.glsl"};
        char name[64];
        snprintf(name, sizeof name, "rivulet/shaders/material/%s", kNames[k]);
        include(text, folder, name);
    }
    strcat(text, kMain);
    const GLuint program = program_of(kVertex, text);
    free(text);
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    CHECK(linked);
    if (!linked) {
        char log[2048];
        glGetProgramInfoLog(program, sizeof log, NULL, log);
        printf("%s\n", log);
    }
    return program;
}

/* Mean brightness, 0 to 255, of the wall from x `low` to `high` (m), y from 0.03 to 0.12. */
static double brightness(double low, double high) {
    double sum = 0;
    int count = 0;
    for (int y = (int)(0.06 * HEIGHT); y < (int)(0.24 * HEIGHT); ++y)
        for (int x = (int)(low * WIDTH); x < (int)(high * WIDTH); ++x, ++count) sum += picture[4 * (y * WIDTH + x)];
    return sum / count;
}

/* A wall is the back of a tank, with water before its left part. */
static void a_wet_wall_is_darker(const char* backend, const char* folder) {
    rivulet_context* context = NULL;
    const rivulet_context_options options = {.size = sizeof options, .find = eglGetProcAddress, .backend = backend};
    DONE(rivulet_context_create(&options, &context, &why));
    if (context == NULL) return;
    float corners[24];
    for (int k = 0; k < 8; ++k) {
        corners[3 * k] = (k & 1) != 0 ? 1.1F : -0.1F;
        corners[3 * k + 1] = (k & 2) != 0 ? 0.7F : -0.1F;
        corners[3 * k + 2] = (k & 4) != 0 ? 0.3F : 0.2F;
    }
    const rivulet_mesh wall = {.size = sizeof wall,
                               .positions = corners,
                               .vertices = 8,
                               .indices = kTriangles,
                               .indices_count = 36,
                               .friction = -1,
                               .restitution = -1};
    rivulet_world* world = NULL;
    const rivulet_world_options o = {
        .size = sizeof o,
        .json =
            "{\"fluid\": {\"spacing\": 0.025, \"box\": {\"max\": [1, 0.6, 0.25]}, \"wetness\": {\"on\": true, \"dries\": 1000}, "
            "\"blocks\": [{\"max\": [0.3, 0.3, 0.2]}]}}",
        .walls = &wall,
        .walls_count = 1};
    DONE(rivulet_world_create(context, &o, &world, &why));
    if (world == NULL) return;
    run(world, 4);
    const float at[6] = {0.15F, 0.08F, 0.2F, 0.85F, 0.08F, 0.2F};
    float there[2] = {9, 9};
    DONE(rivulet_world_wetness(world, at, 2, there, &why));
    CHECK(there[0] > 0.9F && there[1] == 0);

    rivulet_wet_solid solid = {.size = sizeof solid};
    DONE(rivulet_world_wet_solid(world, RIVULET_WALL, 0, &solid, &why));
    rivulet_buffers buffers = {.size = sizeof buffers};
    DONE(rivulet_world_buffers(world, &buffers, &why));
    CHECK(buffers.wet_cells != 0 && buffers.wetness != 0);
    const GLuint program = material(folder);
    GLuint array = 0;
    glGenVertexArrays(1, &array);
    glBindVertexArray(array);
    glUseProgram(program);
    glViewport(0, 0, WIDTH, HEIGHT);
    glUniformMatrix4fv(glGetUniformLocation(program, "wetFromWorld"), 1, GL_FALSE, solid.from_world);
    glUniform3iv(glGetUniformLocation(program, "wetSize"), 1, solid.cells);
    glUniform1ui(glGetUniformLocation(program, "wetFirstCell"), solid.first_cell);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers.wet_cells);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffers.wetness);
    /* Stone, glaze, and what follows from a roughness of 0.6: as stone. */
    static const float kPorosity[3] = {1, 0, -1};
    for (int k = 0; k < 3; ++k) {
        glUniform1f(glGetUniformLocation(program, "porosity"), kPorosity[k]);
        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
        glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, picture);
        const double wet = brightness(0.05, 0.25), dry = brightness(0.75, 0.95);
        printf("%s, porosity %g: %.1f where it is wet, %.1f where it is dry\n", backend, (double)kPorosity[k], wet, dry);
        CHECK(fabs(dry - 255 * 0.5 * (0.3183099 * 0.8 * 2 + 0.3)) < 1);
        if (kPorosity[k] == 0)
            CHECK(wet > 0.9 * dry);
        else
            CHECK(wet < 0.6 * dry);
    }
    glDeleteProgram(program);
    glDeleteVertexArrays(1, &array);
    CHECK(glGetError() == GL_NO_ERROR);
    rivulet_world_destroy(world);
    rivulet_context_destroy(context);
}

int main(int count, char** arguments) {
    if (count < 2) return 2;
    if (!make_current()) return 77;
    GLuint target = make_target(WIDTH, HEIGHT);
    for (int k = 0; k < 2; ++k) a_wet_wall_is_darker(k == 0 ? "cpu" : "gl", arguments[1]);
    glDeleteFramebuffers(1, &target);
    return failures > 0 ? 1 : 0;
}
