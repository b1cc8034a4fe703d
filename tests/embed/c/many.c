/* Worlds come and go a thousand times, stand side by side in one context, and in two threads with a context each: nothing is left behind,
 * and none sees another. Exit 77: no OpenGL. */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>
#include <stdlib.h>
#include <unistd.h>

#include "check.h"
#include "host.h"

enum { WIDTH = 64, HEIGHT = 48, MOST = 1000, NAMES = 4096 };

static const char* kBlock = "{\"fluid\": {\"spacing\": 0.1, \"blocks\": [{\"min\": [0.2, 0.2, 0.2], \"max\": [0.8, 0.6, 0.8]}]}}";
static const char* kFiner = "{\"fluid\": {\"spacing\": 0.08, \"blocks\": [{\"min\": [0.1, 0.5, 0.1], \"max\": [0.6, 0.9, 0.6]}]}}";

/* Bytes that this process holds. */
static size_t resident(void) {
    unsigned long total = 0, pages = 0;
    FILE* file = fopen("/proc/self/statm", "r");
    if (file == NULL || fscanf(file, "%lu %lu", &total, &pages) != 2) pages = 0;
    if (file != NULL) fclose(file);
    return pages * (size_t)sysconf(_SC_PAGESIZE);
}
/* OpenGL's objects that there are, of names that are small; drivers give out the smallest that is free. */
static int objects(void) {
    int there = 0;
    for (GLuint name = 1; name < NAMES; ++name)
        there += glIsBuffer(name) + glIsTexture(name) + glIsProgram(name) + glIsShader(name) + glIsFramebuffer(name) +
                 glIsRenderbuffer(name) + glIsVertexArray(name) + glIsSampler(name) + glIsQuery(name);
    return there;
}

static rivulet_world* make(rivulet_context* context, const char* json) {
    rivulet_error why;
    rivulet_world* world = NULL;
    const rivulet_world_options o = {.size = sizeof o, .json = json};
    if (rivulet_world_create(context, &o, &world, &why) != RIVULET_OK) printf("%s\n", why.message);
    return world;
}
static int draw(rivulet_world* world, GLuint framebuffer) {
    const float view[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -0.5F, -0.4F, -2.2F, 1};
    const float projection[16] = {1.8F, 0, 0, 0, 0, 2.4F, 0, 0, 0, 0, -1.0202F, -1, 0, 0, -0.20202F, 0};
    const rivulet_view from = {.size = sizeof from, .view = view, .projection = projection, .near_plane = 0.1F, .far_plane = 10};
    const rivulet_target to = {.size = sizeof to, .framebuffer = framebuffer, .width = WIDTH, .height = HEIGHT};
    rivulet_error why;
    if (rivulet_world_draw(world, &from, &to, &why) == RIVULET_OK) return 1;
    printf("%s\n", why.message);
    return 0;
}
static rivulet_context* with_gl(const char* backend) {
    rivulet_error why;
    rivulet_context* context = NULL;
    const rivulet_context_options o = {.size = sizeof o, .find = eglGetProcAddress, .backend = backend};
    if (rivulet_context_create(&o, &context, &why) != RIVULET_OK) printf("%s\n", why.message);
    return context;
}

static void a_thousand_leave_nothing(const char* backend, GLuint framebuffer) {
    rivulet_context* context = with_gl(backend);
    if (strncmp(rivulet_context_device(context), backend, strlen(backend)) != 0) { /* it is not on this machine: the cpu runs instead */
        printf("%s: %s\n", backend, rivulet_context_device(context));
        CHECK(getenv("RIVULET_TEST_DEVICES") == NULL);
        rivulet_context_destroy(context);
        return;
    }
    int first_objects = 0;
    size_t first_resident = 0, first_memory = 0;
    for (int k = 0; k < MOST; ++k) {
        rivulet_world* world = make(context, kBlock);
        CHECK(rivulet_world_step(world, NULL, 1.0 / 240, NULL) == RIVULET_OK);
        if (k % 10 == 0) CHECK(draw(world, framebuffer));
        rivulet_world_destroy(world);
        if (k != MOST / 5) continue; /* pools and caches are full by then */
        first_objects = objects();
        first_resident = resident();
        first_memory = rivulet_context_memory(context);
    }
    CHECK(first_objects > 0 && objects() == first_objects && rivulet_context_memory(context) == first_memory);
    const size_t last_resident = resident();
    printf("%s, %d worlds: %d OpenGL objects, %.1f MB resident after a fifth of them, %.1f MB at the end\n", backend, MOST, first_objects,
           1e-6 * (double)first_resident, 1e-6 * (double)last_resident);
    CHECK(last_resident < first_resident + (4 << 20)); /* 800 of their worlds held 40 MB and more */
    rivulet_context_destroy(context);
    CHECK(objects() == 3); /* the host's: a framebuffer and two renderbuffers */
    for (int k = 0; k < 5; ++k) {
        context = with_gl(backend);
        rivulet_world* world = make(context, kBlock);
        CHECK(rivulet_world_step(world, NULL, 1.0 / 60, NULL) == RIVULET_OK && draw(world, framebuffer));
        rivulet_world_destroy(world);
        rivulet_context_destroy(context);
        CHECK(objects() == 3);
    }
}

/* Contexts, too, where nothing is drawn. */
static void a_thousand_contexts_leave_nothing(void) {
    size_t first = 0;
    for (int k = 0; k < MOST; ++k) {
        rivulet_context* context = NULL;
        const rivulet_context_options o = {.size = sizeof o, .backend = "cpu"};
        CHECK(rivulet_context_create(&o, &context, NULL) == RIVULET_OK);
        rivulet_world* world = make(context, kBlock);
        CHECK(rivulet_world_step(world, NULL, 1.0 / 240, NULL) == RIVULET_OK);
        rivulet_world_destroy(world);
        rivulet_context_destroy(context);
        if (k == MOST / 5) first = resident();
    }
    printf("%d contexts: %.1f MB resident after a fifth of them, %.1f MB at the end\n", MOST, 1e-6 * (double)first, 1e-6 * (double)resident());
    CHECK(resident() < first + (1 << 20)); /* oneTBB kept 7 kB of each arena that was */
}

/* What a world looks like after ten frames, alone or beside another. */
typedef struct look {
    float x[3 * 512];
    size_t count;
    unsigned char pixels[3 * WIDTH * HEIGHT];
} look;
static void keep(rivulet_world* world, look* to) {
    rivulet_particles p = {.size = sizeof p, .capacity = 512, .positions = to->x};
    CHECK(rivulet_world_particles(world, &p, NULL) == RIVULET_OK && p.count > 0 && p.count <= 512);
    to->count = p.count;
}
static void picture(rivulet_world* world, GLuint framebuffer, look* to) {
    glClearColor(0.4F, 0.5F, 0.6F, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    CHECK(draw(world, framebuffer));
    glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGB, GL_UNSIGNED_BYTE, to->pixels);
}
static void run_alone(const char* json, look* to) {
    rivulet_context* context = with_gl("cpu");
    const GLuint framebuffer = make_target(WIDTH, HEIGHT);
    rivulet_world* world = make(context, json);
    for (int k = 0; k < 10; ++k) {
        CHECK(rivulet_world_step(world, NULL, 1.0 / 60, NULL) == RIVULET_OK);
        picture(world, framebuffer, to);
    }
    keep(world, to);
    rivulet_world_destroy(world);
    rivulet_context_destroy(context);
    CHECK(glGetError() == GL_NO_ERROR);
}
static int alike(const look* a, const look* b) {
    return a->count == b->count && memcmp(a->x, b->x, 12 * a->count) == 0 && memcmp(a->pixels, b->pixels, sizeof a->pixels) == 0;
}

static look alone[2], beside[2], threads[2];

static void two_in_one_context(void) {
    rivulet_context* context = with_gl("cpu");
    const GLuint framebuffer = make_target(WIDTH, HEIGHT);
    rivulet_world* worlds[2] = {make(context, kBlock), make(context, kFiner)};
    for (int k = 0; k < 10; ++k)
        for (int w = 0; w < 2; ++w) {
            CHECK(rivulet_world_step(worlds[w], NULL, 1.0 / 60, NULL) == RIVULET_OK);
            picture(worlds[w], framebuffer, &beside[w]);
        }
    for (int w = 0; w < 2; ++w) keep(worlds[w], &beside[w]);
    for (int w = 0; w < 2; ++w) CHECK(alike(&beside[w], &alone[w]));
    for (int w = 0; w < 2; ++w) rivulet_world_destroy(worlds[w]);
    rivulet_context_destroy(context);
}

static void* of_a_thread(void* which) {
    const size_t w = (size_t)((look*)which - threads);
    if (!make_current()) return NULL;
    run_alone(w == 0 ? kBlock : kFiner, &threads[w]);
    eglMakeCurrent(eglGetCurrentDisplay(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    return which;
}

int main(void) {
    if (!make_current()) return 77;
    const GLuint framebuffer = make_target(WIDTH, HEIGHT);
    a_thousand_contexts_leave_nothing();
    const char* const backends[] = {"cpu", "gl", "cl"};
    for (int k = 0; k < 3; ++k) a_thousand_leave_nothing(backends[k], framebuffer);
    run_alone(kBlock, &alone[0]);
    run_alone(kFiner, &alone[1]);
    CHECK(!alike(&alone[0], &alone[1]));
    two_in_one_context();
    pthread_t ids[2];
    for (size_t w = 0; w < 2; ++w) CHECK(pthread_create(&ids[w], NULL, of_a_thread, &threads[w]) == 0);
    for (size_t w = 0; w < 2; ++w) {
        void* done = NULL;
        CHECK(pthread_join(ids[w], &done) == 0 && done == &threads[w]);
        CHECK(alike(&threads[w], &alone[w]));
    }
    printf("%s\n", failures == 0 ? "all holds" : "something does not hold");
    return failures == 0 ? 0 : 1;
}
