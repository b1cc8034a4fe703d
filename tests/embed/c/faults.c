/* What goes wrong: memory that is short, scenes and inputs that make no sense, callbacks that are left by longjmp. The context stays
 * usable. */
#include <math.h>
#include <setjmp.h>
#include <stdlib.h>

#include "check.h"

static rivulet_context* make_context(size_t memory_limit) {
    rivulet_context* context = NULL;
    const rivulet_context_options o = {.size = sizeof o, .backend = "cpu", .memory_limit = memory_limit};
    DONE(rivulet_context_create(&o, &context, &why));
    return context;
}
static rivulet_world* make(rivulet_context* context, const char* json) {
    rivulet_world* world = NULL;
    const rivulet_world_options o = {.size = sizeof o, .json = json};
    DONE(rivulet_world_create(context, &o, &world, &why));
    return world;
}
static double time_of(rivulet_world* world) {
    rivulet_stats s = {.size = sizeof s};
    DONE(rivulet_world_stats(world, &s, &why));
    CHECK(s.lost == 0);
    return s.time;
}

enum { MOST = 10000 };
static float places[3 * MOST], later[3 * MOST];
static size_t places_of(rivulet_world* world, float* to) {
    rivulet_particles p = {.size = sizeof p, .capacity = MOST, .positions = to};
    DONE(rivulet_world_particles(world, &p, &why));
    return p.count;
}

/* 5,000 particles where there is room for 125: their neighbour lists are far larger than those of water at rest. */
static rivulet_world* make_packed(rivulet_context* context) {
    enum { COUNT = 5000 };
    static float packed[3 * COUNT];
    for (int k = 0; k < COUNT; ++k)
        for (int axis = 0; axis < 3; ++axis)
            packed[3 * k + axis] = 0.02F +
                                   0.04F * (float)(axis == 0   ? k % 5
                                                   : axis == 1 ? k / 5 % 5
                                                               : k / 25 % 5) +
                                   1e-5F * (float)(k / 125);
    rivulet_world* world = NULL;
    const rivulet_world_options o = {.size = sizeof o,
                                     .json =
                                         "{\"fluid\": {\"spacing\": 0.04, \"maxSubsteps\": 1, \"pbf\": {\"iterations\": 1}, "
                                         "\"box\": {\"max\": [0.4, 0.4, 0.24]}}}",
                                     .particles = packed,
                                     .particles_count = COUNT};
    DONE(rivulet_world_create(context, &o, &world, &why));
    return world;
}

/* A large world beside them takes the rest of the memory; once it is gone, they are stepped, as if nothing had been. */
static void a_step_without_memory_moves_nothing(void) {
    const char* large = "{\"fluid\": {\"spacing\": 0.02, \"blocks\": [{\"max\": [1, 1, 1], \"jitter\": 0}]}}";
    rivulet_context* free = make_context(0);
    rivulet_world* alike = make_packed(free);
    const size_t before = rivulet_context_memory(free);
    DONE(rivulet_world_step(alike, NULL, 1.0 / 60, &why));
    const size_t grown = rivulet_context_memory(free) - before;
    rivulet_world* beside = make(free, large);
    const size_t both = rivulet_context_memory(free) - grown;
    rivulet_world_destroy(beside);
    CHECK(grown > (1 << 20) && both - before > 2 * grown);

    rivulet_context* context = make_context(both + grown / 2);
    rivulet_world* world = make_packed(context);
    beside = make(context, large);
    if (world == NULL || beside == NULL) return;
    const size_t count = places_of(world, places);
    for (int k = 0; k < 3; ++k) {
        CHECK(rivulet_world_step(world, NULL, 1.0 / 60, &why) == RIVULET_FAILED && strstr(why.message, "memory") != NULL);
        CHECK(time_of(world) == 0 && places_of(world, later) == count && memcmp(places, later, 12 * count) == 0);
    }
    rivulet_world_destroy(beside);
    DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    CHECK(time_of(world) == time_of(alike) && time_of(world) > 0);
    CHECK(places_of(world, places) == places_of(alike, later) && memcmp(places, later, 12 * count) == 0);
    rivulet_world_destroy(world);
    rivulet_world_destroy(alike);
    rivulet_context_destroy(context);
    rivulet_context_destroy(free);
}

static void scenes_that_make_no_sense_are_refused(rivulet_context* context) {
    static const struct {
        const char *json, *words;
    } bad[] = {
        {"{\"fluid\": {\"blocks\": [{\"min\": [2, 2, 2], \"max\": [3, 3, 3]}]}}", "fluid.blocks[0]"},
        {"{\"fluid\": {\"blocks\": [{\"min\": [0.5, 0, 0], \"max\": [0.2, 1, 1]}]}}", "fluid.blocks[0].min"},
        {"{\"fluid\": {\"box\": {\"min\": [2, 0, 0], \"max\": [1, 1, 1]}}}", "fluid.box.min"},
        {"{\"fluid\": {\"box\": {\"max\": [3e38, 1, 1]}}}", "fluid.box.max"},
        {"{\"fluid\": {\"gravity\": [0, -3e38, 0]}}", "fluid.gravity"},
        {"{\"fluid\": {\"foam\": {\"most\": 10, \"airFrom\": 3}}}", "fluid.foam.airFrom"},
        {"{\"emitters\": [{\"position\": [0.5, 4, 0.5]}]}", "emitters[0].position"},
        {"{\"emitters\": [{\"direction\": [0, 0, 0], \"position\": [0.5, 0.5, 0.5]}]}", "emitters[0].direction"},
        {"{\"emitters\": [{\"litresPerSecond\": 1e6, \"speed\": 0.1, \"position\": [0.5, 0.5, 0.5]}]}", "emitters[0].litresPerSecond"},
        {"{\"look\": {\"refractiveIndex\": 0.5}}", "look.refractiveIndex"},
    };
    rivulet_world* world = NULL;
    for (size_t k = 0; k < sizeof bad / sizeof *bad; ++k) {
        const rivulet_world_options o = {.size = sizeof o, .json = bad[k].json};
        REFUSED(rivulet_world_create(context, &o, &world, &why), bad[k].words);
        CHECK(world == NULL);
    }
    const float sample[3] = {0, 0, 0};
    rivulet_body body = {.size = sizeof body, .samples = sample, .samples_count = 1, .mass = 1, .inertia = {1, 1, 1}, .volume = 1e-3F};
    rivulet_world_options o = {.size = sizeof o, .bodies = &body, .bodies_count = 1};
    const float wrong[] = {NAN, 1e30F, -4};
    for (int k = 0; k < 3; ++k) {
        body.pose.position[1] = wrong[k];
        REFUSED(rivulet_world_create(context, &o, &world, &why), "bodies[0].pose");
    }
    body.pose.position[1] = 0.5F;
    body.inertia[1] = INFINITY;
    REFUSED(rivulet_world_create(context, &o, &world, &why), "body 0");
    float corners[9] = {0, 0.5F, 0, 1, 0.5F, 0, 0, 0.5F, 1};
    const uint32_t triangle[3] = {0, 1, 2};
    const rivulet_mesh wall = {.size = sizeof wall, .positions = corners, .vertices = 3, .indices = triangle, .indices_count = 3};
    o = (rivulet_world_options){.size = sizeof o, .walls = &wall, .walls_count = 1};
    for (int k = 0; k < 2; ++k) {
        corners[4] = wrong[k];
        REFUSED(rivulet_world_create(context, &o, &world, &why), "walls[0].positions");
    }
    rivulet_mesh many = wall;
    many.vertices = (size_t)1 << 40;
    o.walls = &many;
    REFUSED(rivulet_world_create(context, &o, &world, &why), "2^32");
    rivulet_context* other = NULL;
    const rivulet_context_options dazzling = {.size = sizeof dazzling, .backend = "cpu", .sky_zenith = {0, INFINITY, 0}};
    REFUSED(rivulet_context_create(&dazzling, &other, &why), "sky_zenith");

    world = make(context,
                 "{\"fluid\": {\"spacing\": 0.05, \"blocks\": [{\"max\": [0.3, 0.3, 0.3]}]},"
                 " \"emitters\": [{\"position\": [0.5, 0.8, 0.5]}]}");
    REFUSED(rivulet_world_set(world, "emitters.0.position=0,7,0", &why), "emitters[0].position");
    REFUSED(rivulet_world_set(world, "fluid.foam.speedFrom=50", &why), "fluid.foam.speedFrom");
    REFUSED(rivulet_world_set(world, "fluid.gravity=0,-3e38,0", &why), "fluid.gravity");
    DONE(rivulet_world_set(world, "emitters.0.position=0.4,0.8,0.5", &why));
    rivulet_world_destroy(world);
}

static void inputs_that_make_no_sense_are_refused(rivulet_context* context) {
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 0, 1};
    const uint32_t triangle[3] = {0, 1, 2};
    const rivulet_mesh wall = {
        .size = sizeof wall, .positions = corners, .vertices = 3, .indices = triangle, .indices_count = 3, .moves = 1};
    const rivulet_world_options o = {
        .size = sizeof o,
        .json = "{\"fluid\": {\"spacing\": 0.05, \"blocks\": [{\"min\": [0.2, 0.2, 0.2], \"max\": [0.5, 0.5, 0.5]}]}}",
        .walls = &wall,
        .walls_count = 1};
    rivulet_world* world = NULL;
    DONE(rivulet_world_create(context, &o, &world, &why));
    const double seconds[] = {NAN, INFINITY, 1e300, 3601};
    for (int k = 0; k < 4; ++k) CHECK(rivulet_world_step(world, NULL, seconds[k], &why) == RIVULET_BAD_INPUT && why.message[0] != '\0');
    const double none[] = {0, -1, -1e300, -INFINITY};
    for (int k = 0; k < 3; ++k) DONE(rivulet_world_step(world, NULL, none[k], &why)); /* nothing happens */
    const float gravities[][3] = {{0, -3e38F, 0}, {0, NAN, 0}, {INFINITY, 0, 0}, {0, 1001, 0}};
    for (int k = 0; k < 4; ++k) {
        const rivulet_inputs in = {.size = sizeof in, .gravity = gravities[k]};
        REFUSED(rivulet_world_step(world, &in, 0.01, &why), "gravity");
    }
    rivulet_pose pose = {{0, 0.1F, 0}, {0, 0, 0, 1}};
    const rivulet_inputs moved = {.size = sizeof moved, .poses = &pose, .poses_count = 1};
    const float heights[] = {1e30F, NAN, -INFINITY, 5e5F}; /* the last is finite, and too far for a frame */
    for (int k = 0; k < 4; ++k) {
        pose.position[1] = heights[k];
        CHECK(rivulet_world_step(world, &moved, 0.01, &why) == RIVULET_BAD_INPUT && why.message[0] != '\0');
    }
    CHECK(time_of(world) == 0);
    pose.position[1] = 0.1F;
    DONE(rivulet_world_step(world, &moved, 0.01, &why));
    CHECK(fabs(time_of(world) - 0.01) < 1e-9);
    rivulet_world_destroy(world);

    const float uvs[6] = {0, 0, 1, 0, 0, 1};
    rivulet_mesh skin_mesh = wall;
    skin_mesh.uvs = uvs;
    const rivulet_skin_options so = {.size = sizeof so, .mesh = &skin_mesh, .map_size = 64};
    rivulet_skin* skin = NULL;
    DONE(rivulet_skin_create(context, &so, &skin, &why));
    const float strong[3] = {0, -1e30F, 0}, nowhere[16] = {NAN};
    const rivulet_skin_inputs gale = {.size = sizeof gale, .wind = strong}, heavy = {.size = sizeof heavy, .gravity = strong},
                              lost = {.size = sizeof lost, .to_world = nowhere};
    REFUSED(rivulet_skin_step(skin, &gale, 0.01, &why), "wind");
    REFUSED(rivulet_skin_step(skin, &heavy, 0.01, &why), "gravity");
    REFUSED(rivulet_skin_step(skin, &lost, 0.01, &why), "to_world");
    REFUSED(rivulet_skin_step(skin, NULL, 1e9, &why), "seconds");
    rivulet_skin_destroy(skin);
}

/* A host with a scripting language whose errors are jumps. */
static jmp_buf handler;
static int jumps, calls;
static void move_or_jump(void* user, const rivulet_body_load* loads, const float* gravity, double seconds, rivulet_body_state* states,
                         size_t count) {
    (void)loads, (void)gravity, (void)seconds, (void)states, (void)count;
    ++calls;
    if (jumps) {
        jumps = 0;
        REFUSED(rivulet_world_step(*(rivulet_world**)user, NULL, 0.01, &why), "callbacks must not");
        longjmp(handler, 1);
    }
}
static void reset_or_jump(void* user, const rivulet_body_state* states, size_t count) {
    (void)states, (void)count;
    if (jumps && *(rivulet_world**)user) {
        jumps = 0;
        longjmp(handler, 1);
    }
}
static int log_jumps;
static void log_or_jump(void* user, rivulet_level level, const char* sentence) {
    (void)user, (void)level;
    CHECK(sentence[0] != '\0');
    if (log_jumps) {
        log_jumps = 0;
        longjmp(handler, 1);
    }
}

/* Deeper on the stack than what was left: its frames lie where those of the unfinished call did. */
static int deeper(rivulet_world* world, int levels, int (*work)(rivulet_world*)) {
    volatile char frame[700];
    frame[0] = (char)levels;
    const int done = levels > 0 ? deeper(world, levels - 1, work) : work(world);
    return done + 0 * frame[0];
}
static int reset_it(rivulet_world* world) { return rivulet_world_reset(world, &why); }
static int step_it(rivulet_world* world) { return rivulet_world_step(world, NULL, 1.0 / 60, &why); }

static void a_callback_may_be_left_by_longjmp(void) {
    rivulet_context* context = NULL;
    const rivulet_context_options co = {.size = sizeof co, .backend = "cpu", .log = log_or_jump};
    DONE(rivulet_context_create(&co, &context, &why));
    const float sample[6] = {0.02F, 0, 0, -0.02F, 0, 0};
    const rivulet_body body = {.size = sizeof body,
                               .samples = sample,
                               .samples_count = 2,
                               .mass = 0.1F,
                               .inertia = {1e-4F, 1e-4F, 1e-4F},
                               .volume = 1e-4F,
                               .pose = {{0.7F, 0.7F, 0.7F}, {0, 0, 0, 1}}};
    static rivulet_world* world;
    world = NULL;
    const rivulet_body_host host = {.size = sizeof host, .user = &world, .advance = move_or_jump, .reset = reset_or_jump};
    const rivulet_world_options o = {.size = sizeof o,
                                     .json = "{\"fluid\": {\"spacing\": 0.05, \"blocks\": [{\"max\": [0.3, 0.3, 0.3]}]}}",
                                     .bodies = &body,
                                     .bodies_count = 1,
                                     .body_host = &host};
    DONE(rivulet_world_create(context, &o, &world, &why));
    DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    const size_t count = places_of(world, places);
    for (volatile int round = 0; round < 6; ++round) {
        jumps = 1;
        if (setjmp(handler) == 0) {
            if (round == 5)
                reset_it(world);
            else if (round % 2 == 1)
                deeper(world, 9, step_it);
            else
                step_it(world);
            CHECK(!"it was left");
        }
        /* The world is incomplete, and says so, from whatever depth it is asked. */
        const int levels = round == 2 || round == 3 ? 20 : 0;
        CHECK(deeper(world, levels, step_it) == RIVULET_FAILED && strstr(why.message, "reset or restore") != NULL);
        CHECK(deeper(world, levels, reset_it) == RIVULET_OK);
        DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
        CHECK(places_of(world, later) == count && memcmp(places, later, 12 * count) == 0);
    }
    CHECK(calls > 10);
    /* Out of the log: the call was done before. */
    log_jumps = 1;
    if (setjmp(handler) == 0) {
        rivulet_context_destroy(context); /* refused and logged: it has a world */
        CHECK(!"it was left");
    }
    const double before = time_of(world);
    DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    CHECK(time_of(world) > before);
    /* Left once more, and destroyed. */
    jumps = 1;
    if (setjmp(handler) == 0) step_it(world);
    rivulet_world_destroy(world);
    const size_t held = rivulet_context_memory(context);
    CHECK(held == 0);
    rivulet_context_destroy(context);
}

int main(void) {
    rivulet_context* context = make_context(0);
    a_step_without_memory_moves_nothing();
    scenes_that_make_no_sense_are_refused(context);
    inputs_that_make_no_sense_are_refused(context);
    rivulet_context_destroy(context);
    a_callback_may_be_left_by_longjmp();
    printf("%s\n", failures == 0 ? "all holds" : "something does not hold");
    return failures == 0 ? 0 : 1;
}
