/* A worker steps a world while the host's thread draws snapshots of it: the pictures and the water are those of a run on one thread.
 * Exit 77: no OpenGL. */
#define _POSIX_C_SOURCE 200809L
#include <pthread.h>
#include <stdlib.h>

#include "check.h"
#include "host.h"

enum { WIDTH = 96, HEIGHT = 72, FRAMES = 30 };
typedef unsigned char picture[4 * WIDTH * HEIGHT];

static const char* kScene =
    "{\"fluid\": {\"spacing\": 0.04, \"blocks\": [{\"max\": [0.4, 0.6, 1]}], \"foam\": {\"most\": 500}}, \"look\": {\"quality\": "
    "\"fine\"}}";
static const float kView[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -0.5F, -0.4F, -2.2F, 1};
static const float kProjection[16] = {1.8F, 0, 0, 0, 0, 2.4F, 0, 0, 0, 0, -1.0202F, -1, 0, 0, -0.20202F, 0};
static const rivulet_view kFrom = {.size = sizeof kFrom, .view = kView, .projection = kProjection, .near_plane = 0.1F, .far_plane = 10};
static rivulet_target to = {.size = sizeof to, .width = WIDTH, .height = HEIGHT};

static void clear(void) {
    glClearColor(0.2F, 0.3F, 0.4F, 1);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}
static void read_picture(picture into) { glReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, GL_UNSIGNED_BYTE, into); }
static int differ(const picture a, const picture b) {
    int count = 0;
    for (int k = 0; k < 4 * WIDTH * HEIGHT; ++k) count += abs(a[k] - b[k]) > 2;
    return count;
}

/* What the two threads exchange, under the lock: snapshots that are filled and not drawn, and those that are free. */
struct shared {
    pthread_mutex_t lock;
    pthread_cond_t change;
    rivulet_world* world;
    rivulet_snapshot* snapshots[2];
    int filled[2]; /* the frame that it holds; 0: free */
    int failed;
};
static void* work(void* data) {
    struct shared* s = data;
    for (int frame = 1; frame <= FRAMES; ++frame) {
        rivulet_error wrong;
        if (rivulet_world_step(s->world, NULL, 1.0 / 60, &wrong) != RIVULET_OK) s->failed = 1;
        const int k = frame % 2;
        pthread_mutex_lock(&s->lock);
        while (s->filled[k] != 0) pthread_cond_wait(&s->change, &s->lock);
        pthread_mutex_unlock(&s->lock);
        if (rivulet_world_snapshot(s->world, s->snapshots[k], &wrong) != RIVULET_OK) s->failed = 1;
        pthread_mutex_lock(&s->lock);
        s->filled[k] = frame;
        pthread_cond_broadcast(&s->change);
        pthread_mutex_unlock(&s->lock);
    }
    return NULL;
}

static void a_worker_steps(rivulet_context* context) {
    const rivulet_world_options o = {.size = sizeof o, .json = kScene};
    static picture alone[FRAMES + 1], seen;
    rivulet_world* one = NULL;
    DONE(rivulet_world_create(context, &o, &one, &why));
    for (int frame = 1; frame <= FRAMES; ++frame) {
        DONE(rivulet_world_step(one, NULL, 1.0 / 60, &why));
        clear();
        DONE(rivulet_world_draw(one, &kFrom, &to, &why));
        read_picture(alone[frame]);
    }
    CHECK(differ(alone[1], alone[FRAMES]) > 500);
    struct shared s = {.lock = PTHREAD_MUTEX_INITIALIZER, .change = PTHREAD_COND_INITIALIZER};
    DONE(rivulet_world_create(context, &o, &s.world, &why));
    for (int k = 0; k < 2; ++k) DONE(rivulet_snapshot_create(context, &s.snapshots[k], &why));
    pthread_t worker;
    CHECK(pthread_create(&worker, NULL, work, &s) == 0);
    int worst = 0;
    for (int frame = 1; frame <= FRAMES; ++frame) {
        const int k = frame % 2;
        pthread_mutex_lock(&s.lock);
        while (s.filled[k] != frame) pthread_cond_wait(&s.change, &s.lock);
        pthread_mutex_unlock(&s.lock);
        clear();
        DONE(rivulet_snapshot_draw(s.snapshots[k], &kFrom, &to, &why));
        rivulet_buffers buffers = {.size = sizeof buffers};
        DONE(rivulet_snapshot_buffers(s.snapshots[k], &buffers, &why));
        CHECK(buffers.position != 0 && buffers.velocity != 0 && buffers.id != 0 && buffers.count > 3000);
        read_picture(seen);
        const int away = differ(alone[frame], seen);
        if (away > worst) worst = away;
        pthread_mutex_lock(&s.lock);
        s.filled[k] = 0;
        pthread_cond_broadcast(&s.change);
        pthread_mutex_unlock(&s.lock);
    }
    pthread_join(worker, NULL);
    CHECK(!s.failed);
    printf("%d frames: at most %d of %d values differ from the run on one thread\n", FRAMES, worst, (int)sizeof(picture));
    CHECK(worst == 0);
    rivulet_world_destroy(one);
    rivulet_world_destroy(s.world);
    for (int k = 0; k < 2; ++k) rivulet_snapshot_destroy(s.snapshots[k]);
}

/* A snapshot shows the world as it was, after steps and after the world's end. */
static void a_snapshot_stays(rivulet_context* context) {
    const rivulet_world_options o = {.size = sizeof o, .json = kScene};
    static picture then, later;
    rivulet_world* world = NULL;
    rivulet_snapshot* snapshot = NULL;
    DONE(rivulet_world_create(context, &o, &world, &why));
    DONE(rivulet_snapshot_create(context, &snapshot, &why));
    REFUSED(rivulet_snapshot_draw(snapshot, &kFrom, &to, &why), "empty");
    for (int k = 0; k < 3; ++k) DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    clear();
    DONE(rivulet_world_draw(world, &kFrom, &to, &why));
    read_picture(then);
    DONE(rivulet_world_snapshot(world, snapshot, &why));
    for (int k = 0; k < 6; ++k) DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    clear();
    DONE(rivulet_world_draw(world, &kFrom, &to, &why));
    read_picture(later);
    CHECK(differ(then, later) > 100);
    for (int end = 0; end < 2; ++end) {
        clear();
        DONE(rivulet_snapshot_draw(snapshot, &kFrom, &to, &why));
        read_picture(later);
        CHECK(differ(then, later) == 0);
        if (end == 0) rivulet_world_destroy(world);
    }
    rivulet_snapshot_destroy(snapshot);
}

/* A recording shows each frame as it was drawn, in any order, in another world's look; a file that ends early shows what it has. */
static void a_recording_shows_it_again(rivulet_context* context, const char* folder) {
    enum { RECORDED = 6 };
    static picture drawn[RECORDED], seen;
    char path[512], none[512];
    snprintf(path, sizeof path, "%s/%p.rrec", folder, (void*)context);
    snprintf(none, sizeof none, "%s/no folder/run.rrec", folder);
    const rivulet_world_options o = {.size = sizeof o, .json = kScene};
    rivulet_world* world = NULL;
    rivulet_snapshot* snapshot = NULL;
    DONE(rivulet_world_create(context, &o, &world, &why));
    DONE(rivulet_snapshot_create(context, &snapshot, &why));
    REFUSED(rivulet_world_record(world, NULL, &why), "not being recorded");
    CHECK(rivulet_world_record(world, none, &why) == RIVULET_FAILED && strstr(why.message, "folder does not exist") != NULL);
    DONE(rivulet_world_record(world, path, &why));
    REFUSED(rivulet_world_record(world, path, &why), "is being recorded");
    for (int frame = 0; frame < RECORDED; ++frame) {
        DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
        clear();
        DONE(rivulet_world_draw(world, &kFrom, &to, &why));
        read_picture(drawn[frame]);
    }
    DONE(rivulet_world_record(world, NULL, &why));
    DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why)); /* is not recorded */
    for (size_t k = 0; k < RECORDED; ++k) {
        const size_t frame = (5 * k + 3) % RECORDED;
        rivulet_recorded r = {.size = sizeof r};
        DONE(rivulet_snapshot_replay(snapshot, world, path, frame, &r, &why));
        CHECK(r.frames == RECORDED && r.time > (double)frame / 60 && r.time < (double)(frame + 2) / 60);
        clear();
        DONE(rivulet_snapshot_draw(snapshot, &kFrom, &to, &why));
        read_picture(seen);
        CHECK(differ(drawn[frame], seen) == 0);
    }
    REFUSED(rivulet_snapshot_replay(snapshot, world, path, RECORDED, NULL, &why), "give a frame from 0 to 5");
    REFUSED(rivulet_snapshot_replay(snapshot, world, none, 0, NULL, &why), "cannot be read");
    REFUSED(rivulet_snapshot_replay(snapshot, NULL, path, 0, NULL, &why), "world is NULL");
    DONE(rivulet_world_record(world, path, &why));
    DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    rivulet_world_destroy(world); /* ends it */
    DONE(rivulet_world_create(context, &o, &world, &why));
    rivulet_snapshot* again = NULL;
    rivulet_recorded r = {.size = sizeof r};
    DONE(rivulet_snapshot_create(context, &again, &why));
    DONE(rivulet_snapshot_replay(again, world, path, 0, &r, &why));
    CHECK(r.frames == 1);
    rivulet_snapshot_destroy(again);
    rivulet_snapshot_destroy(snapshot);
    rivulet_world_destroy(world);
}

static rivulet_context* with_gl(const char* backend) {
    rivulet_context* context = NULL;
    const rivulet_context_options o = {.size = sizeof o, .find = eglGetProcAddress, .backend = backend};
    DONE(rivulet_context_create(&o, &context, &why));
    return context;
}

/* A step on a thread without the OpenGL context is refused where the device needs it. */
static void* step_there(void* world) {
    rivulet_error wrong;
    return rivulet_world_step(world, NULL, 1.0 / 60, &wrong) == RIVULET_BAD_INPUT && strstr(wrong.message, "not current") ? world : NULL;
}

int main(int argc, char** argv) {
    if (!make_current() || argc < 2) return 77;
    to.framebuffer = make_target(WIDTH, HEIGHT);
    rivulet_context* cpu = with_gl("cpu");
    rivulet_context* gl = with_gl("gl");
    a_worker_steps(cpu);
    a_snapshot_stays(cpu);
    a_snapshot_stays(gl);
    a_recording_shows_it_again(cpu, argv[1]);
    a_recording_shows_it_again(gl, argv[1]);
    const rivulet_world_options o = {.size = sizeof o, .json = kScene};
    rivulet_world* world = NULL;
    rivulet_snapshot* snapshot = NULL;
    DONE(rivulet_world_create(gl, &o, &world, &why));
    pthread_t thread;
    void* refused = NULL;
    CHECK(pthread_create(&thread, NULL, step_there, world) == 0 && pthread_join(thread, &refused) == 0);
    CHECK(refused == world);
    DONE(rivulet_snapshot_create(cpu, &snapshot, &why));
    REFUSED(rivulet_world_snapshot(world, snapshot, &why), "another context");
    REFUSED(rivulet_world_snapshot(world, NULL, &why), "NULL");
    REFUSED(rivulet_world_snapshot(NULL, snapshot, &why), "NULL");
    REFUSED(rivulet_snapshot_draw(NULL, &kFrom, &to, &why), "NULL");
    REFUSED(rivulet_snapshot_buffers(NULL, NULL, &why), "NULL");
    rivulet_snapshot_destroy(snapshot);
    rivulet_snapshot_destroy(NULL);
    REFUSED(rivulet_snapshot_create(NULL, &snapshot, &why), "NULL");
    REFUSED(rivulet_snapshot_create(cpu, NULL, &why), "NULL");
    rivulet_world_destroy(world);
    rivulet_context_destroy(gl);
    rivulet_context_destroy(cpu);
    return failures > 0;
}
