/* A host's job system, its memory and a limit of threads: the water is that of the library's own threads, bit for bit. */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>
#include <stdlib.h>

#include "check.h"

/* A host whose jobs are threads, the last one first. */
struct host {
    int loops, most;
    size_t held, blocks, limit;
    rivulet_context* context;
};
struct job {
    void (*function)(void* argument, size_t k);
    void* argument;
    size_t k;
};
static void* run_job(void* data) {
    const struct job* job = data;
    job->function(job->argument, job->k);
    return NULL;
}
static void run_all(void* user, void (*function)(void* argument, size_t k), void* argument, size_t count) {
    struct host* host = user;
    pthread_t threads[8];
    struct job jobs[8];
    ++host->loops;
    if ((int)count > host->most) host->most = (int)count;
    if (host->context != NULL && host->loops == 3) REFUSED(rivulet_context_lost(host->context, &why), "in use");
    for (size_t k = count; k-- > 0;) {
        jobs[k] = (struct job){function, argument, k};
        if (pthread_create(&threads[k], NULL, run_job, &jobs[k]) != 0) abort();
    }
    for (size_t k = 0; k < count; ++k) pthread_join(threads[k], NULL);
}
static void* take(void* user, size_t bytes, size_t alignment) {
    struct host* host = user;
    if (host->held + bytes > host->limit) return NULL;
    host->held += bytes;
    ++host->blocks;
    return aligned_alloc(alignment, bytes);
}
static void give_back(void* user, void* memory, size_t bytes) {
    struct host* host = user;
    host->held -= bytes;
    --host->blocks;
    free(memory);
}

/* Positions after some steps, beside a wall that is baked. */
static size_t steps(const rivulet_context_options* o, float* positions, size_t capacity, struct host* host) {
    const float corners[12] = {0.3F, 0, 0, 0.3F, 0.3F, 0, 0.3F, 0.3F, 1, 0.3F, 0, 1};
    const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
    const rivulet_mesh wall = {.size = sizeof wall, .positions = corners, .vertices = 4, .indices = triangles, .indices_count = 6};
    const rivulet_world_options scene = {.size = sizeof scene,
                                         .json = "{\"fluid\": {\"spacing\": 0.03, \"blocks\": [{\"max\": [0.28, 0.6, 1]}]}}",
                                         .walls = &wall,
                                         .walls_count = 1};
    rivulet_context* context = NULL;
    rivulet_world* world = NULL;
    DONE(rivulet_context_create(o, &context, &why));
    if (host != NULL) host->context = context;
    DONE(rivulet_world_create(context, &scene, &world, &why));
    for (int k = 0; k < 4; ++k) DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    rivulet_particles all = {.size = sizeof all, .capacity = capacity, .positions = positions};
    DONE(rivulet_world_particles(world, &all, &why));
    rivulet_world_destroy(world);
    rivulet_context_destroy(context);
    return all.count;
}

int main(void) {
    enum { MOST = 20000 };
    static float own[3 * MOST], given[3 * MOST];
    rivulet_context_options o = {.size = sizeof o, .backend = "cpu"};
    const size_t count = steps(&o, own, MOST, NULL);
    CHECK(count > 5000 && count <= MOST);
    struct host host = {.limit = (size_t)-1};
    rivulet_jobs jobs = {.size = sizeof jobs, .user = &host, .run = run_all, .workers = 3};
    rivulet_memory memory = {.size = sizeof memory, .user = &host, .allocate = take, .release = give_back};
    o.jobs = &jobs;
    o.memory = &memory;
    CHECK(steps(&o, given, MOST, &host) == count && memcmp(own, given, 3 * sizeof(float) * count) == 0);
    CHECK(host.loops > 100 && host.most == 3 && host.held == 0 && host.blocks == 0);
    printf("the host ran %d loops\n", host.loops);
    o.threads = 2;
    host.most = 0;
    CHECK(steps(&o, given, MOST, NULL) == count && memcmp(own, given, 3 * sizeof(float) * count) == 0 && host.most == 2);
    o.jobs = NULL;
    o.threads = 1;
    const int before = host.loops;
    CHECK(steps(&o, given, MOST, NULL) == count && memcmp(own, given, 3 * sizeof(float) * count) == 0 && host.loops == before);

    rivulet_context* context = NULL;
    rivulet_world* world = NULL;
    host.limit = 100000;
    DONE(rivulet_context_create(&o, &context, &why));
    const rivulet_world_options scene = {.size = sizeof scene,
                                         .json = "{\"fluid\": {\"spacing\": 0.03, \"blocks\": [{\"max\": [0.3, 0.6, 1]}]}}"};
    CHECK(rivulet_world_create(context, &scene, &world, &why) == RIVULET_FAILED && strstr(why.message, "memory") != NULL);
    CHECK(host.held == 0);
    rivulet_context_destroy(context);
    o.threads = -1;
    REFUSED(rivulet_context_create(&o, &context, &why), "options.threads");
    o.threads = 0;
    o.jobs = &jobs;
    jobs.workers = 0;
    REFUSED(rivulet_context_create(&o, &context, &why), "worker");
    jobs.size = 0;
    REFUSED(rivulet_context_create(&o, &context, &why), "sizeof(rivulet_jobs)");
    o.jobs = NULL;
    memory.release = NULL;
    REFUSED(rivulet_context_create(&o, &context, &why), "release");
    return failures > 0;
}
