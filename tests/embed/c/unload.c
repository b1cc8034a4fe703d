/* The library loaded, used and unloaded again and again in one process: unload BACKEND LIBRARY. Of gl with a context of OpenGL.
 * Exit 77: this machine lacks the backend. */
#include <dlfcn.h>
#include <pthread.h>
#include <stdlib.h>

#include "check.h"
#include "host.h"

/* Whether a part of the library is still mapped. */
static int mapped(const char* library) {
    char line[4096];
    int there = 0;
    FILE* file = fopen("/proc/self/maps", "r");
    const char* name = strrchr(library, '/');
    while (file != NULL && fgets(line, sizeof line, file) != NULL) there |= strstr(line, name) != NULL;
    if (file != NULL) fclose(file);
    return there;
}

#define FIND(name)                 \
    __typeof__(name)* call_##name; \
    *(void**)&call_##name = find(library, #name)
static void* find(void* library, const char* name) {
    void* const function = dlsym(library, name);
    CHECK(function != NULL);
    return function;
}

/* Water that stands and moves, drawn if there is OpenGL. Returns 77 if the backend is not there. */
static int use(void* library, const char* backend, int gl) {
    FIND(rivulet_context_create);
    FIND(rivulet_context_destroy);
    FIND(rivulet_context_device);
    FIND(rivulet_world_create);
    FIND(rivulet_world_destroy);
    FIND(rivulet_world_step);
    FIND(rivulet_world_draw);
    rivulet_context* context = NULL;
    const rivulet_context_options o = {.size = sizeof o, .find = gl ? eglGetProcAddress : NULL, .backend = backend};
    DONE(call_rivulet_context_create(&o, &context, &why));
    if (context == NULL) return 1;
    const int there = strncmp(call_rivulet_context_device(context), backend, strlen(backend)) == 0;
    const rivulet_world_options scene = {.size = sizeof scene,
                                         .json = "{\"fluid\": {\"spacing\": 0.03, \"blocks\": [{\"max\": [0.5, 0.5, 1]}]}}"};
    rivulet_world* world = NULL;
    if (there) DONE(call_rivulet_world_create(context, &scene, &world, &why));
    for (int k = 0; world != NULL && k < 4; ++k) DONE(call_rivulet_world_step(world, NULL, 1.0 / 60, &why));
    if (world != NULL && gl) {
        const float view[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -0.5F, -0.4F, -2.2F, 1};
        const float projection[16] = {1.8F, 0, 0, 0, 0, 2.4F, 0, 0, 0, 0, -1.0202F, -1, 0, 0, -0.20202F, 0};
        const rivulet_view from = {.size = sizeof from, .view = view, .projection = projection, .near_plane = 0.1F, .far_plane = 10};
        const rivulet_target to = {.size = sizeof to, .framebuffer = make_target(64, 48), .width = 64, .height = 48};
        DONE(call_rivulet_world_draw(world, &from, &to, &why));
    }
    call_rivulet_world_destroy(world);
    call_rivulet_context_destroy(context);
    return there ? 0 : 77;
}

struct run {
    const char *backend, *path;
    int gl, result;
};
static int load_and_use(const struct run* run) {
    void* const library = dlopen(run->path, RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) printf("%s\n", dlerror());
    CHECK(library != NULL);
    const int used = library == NULL ? 1 : use(library, run->backend, run->gl);
    if (library != NULL) CHECK(dlclose(library) == 0);
    CHECK(!mapped(run->path));
    return used;
}
/* A thread of the host that ends after the library is gone. */
static void* on_a_thread(void* data) {
    struct run* const run = data;
    run->result = load_and_use(run);
    return NULL;
}

int main(int argc, char** argv) {
    if (argc != 3) return 2;
    struct run run = {argv[1], argv[2], strcmp(argv[1], "gl") == 0, 0};
    if (run.gl && !make_current()) return 77;
    for (int k = 0; k < 5; ++k) {
        if ((run.result = load_and_use(&run)) == 77) return 77;
        if (run.gl) continue;
        pthread_t thread;
        if (pthread_create(&thread, NULL, on_a_thread, &run) != 0) return 1;
        pthread_join(thread, NULL);
    }
    printf("%s: loaded, used and unloaded %d times\n", run.backend, run.gl ? 5 : 10);
    return failures > 0;
}
