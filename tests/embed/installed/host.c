/* A second of water through rivulet.h, as C and as C++. Exit 0: it fell, and none of it was lost. With BY_DLOPEN the library is opened while the
 * program runs: host LIBRARY. */
#include <rivulet/rivulet.h>
#include <stdio.h>
#include <string.h>

#include "engine/core/log.h"

#ifdef BY_DLOPEN
#include <dlfcn.h>
#define FIND(name)                                       \
    *(void**)&name##_found = dlsym(library, #name);      \
    if (name##_found == NULL) return fail("no " #name)
#ifdef __cplusplus
#define DECLARE(name) decltype(&name) name##_found
#else
#define DECLARE(name) __typeof__(&name) name##_found
#endif
#define CALL(name) name##_found
#else
#define FIND(name)
#define DECLARE(name)
#define CALL(name) name
#endif

static int PASS(int value) { return value; }

static int fail(const char* why) {
    fprintf(stderr, "%s: %s\n", HOST_LOG, why);
    return 1;
}

int main(int count, char** arguments) {
    rivulet_error why;
    rivulet_context* context = NULL;
    rivulet_world* world = NULL;
    rivulet_context_options options;
    rivulet_world_options scene;
    rivulet_stats stats;
    DECLARE(rivulet_version);
    DECLARE(rivulet_context_create);
    DECLARE(rivulet_context_destroy);
    DECLARE(rivulet_world_create);
    DECLARE(rivulet_world_destroy);
    DECLARE(rivulet_world_step);
    DECLARE(rivulet_world_stats);
#ifdef BY_DLOPEN
    void* library = count > 1 ? dlopen(arguments[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    if (library == NULL) return fail("the library cannot be opened");
#endif
    (void)count;
    (void)arguments;
    FIND(rivulet_version);
    FIND(rivulet_context_create);
    FIND(rivulet_context_destroy);
    FIND(rivulet_world_create);
    FIND(rivulet_world_destroy);
    FIND(rivulet_world_step);
    FIND(rivulet_world_stats);

    memset(&options, 0, sizeof options);
    options.size = sizeof options;
    options.backend = "cpu";
    memset(&scene, 0, sizeof scene);
    scene.size = sizeof scene;
    scene.json = "{\"fluid\": {\"spacing\": 0.05, \"blocks\": [{\"min\": [0.2, 0.2, 0.2], \"max\": [0.6, 0.6, 0.6]}]}}";
    memset(&stats, 0, sizeof stats);
    stats.size = sizeof stats;
    if (CALL(rivulet_context_create)(&options, &context, &why) != RIVULET_OK) return fail(why.message);
    if (CALL(rivulet_world_create)(context, &scene, &world, &why) != RIVULET_OK) return fail(why.message);
    for (int frame = 0; frame < 60; ++frame)
        if (CALL(rivulet_world_step)(world, NULL, 1.0 / 60, &why) != RIVULET_OK) return fail(why.message);
    if (CALL(rivulet_world_stats)(world, &stats, &why) != RIVULET_OK) return fail(why.message);
    CALL(rivulet_world_destroy)(world);
    CALL(rivulet_context_destroy)(context);
    printf("%s: %u particles, mean height %.3f m\n", CALL(rivulet_version)(), stats.particles, stats.centre_of_mass[1]);
    return PASS(stats.particles == 512 && stats.lost == 0 && stats.centre_of_mass[1] > 0.01 && stats.centre_of_mass[1] < 0.2 ? 0 : 1);
}
