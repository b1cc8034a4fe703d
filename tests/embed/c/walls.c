/* Walls, emitters and sinks that come and go while a world runs. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdlib.h>

#include "pool.h"

/* A box of 12 triangles. */
struct box {
    float corners[24];
};
static rivulet_mesh box_of(struct box* box, const float low[3], const float high[3]) {
    for (int k = 0; k < 8; ++k)
        for (int axis = 0; axis < 3; ++axis) box->corners[3 * k + axis] = (k >> axis & 1) != 0 ? high[axis] : low[axis];
    return (rivulet_mesh){.size = sizeof(rivulet_mesh),
                          .positions = box->corners,
                          .vertices = 8,
                          .indices = kTriangles,
                          .indices_count = 36,
                          .friction = -1,
                          .restitution = -1};
}

static float farthest(rivulet_world* world) {
    float x = 0;
    for (size_t k = 0, n = count_of(world); k < n; ++k) x = positions[3 * k] > x ? positions[3 * k] : x;
    return x;
}
static int state_of(const rivulet_world* world, uint32_t id) {
    int32_t state = -1;
    DONE(rivulet_world_wall(world, id, &state, &why));
    return state;
}
static void wait_for_bake(const rivulet_world* world, uint32_t id) {
    rivulet_world* stepped = (rivulet_world*)world;
    while (state_of(world, id) == RIVULET_WALL_BAKES) {
        wait_a_little(stepped, 1.0e-6); /* it acts from the step on before which its bake ended */
    }
}

static rivulet_world* tank(rivulet_context* context, const rivulet_mesh* walls, size_t count) {
    rivulet_world* world = NULL;
    const rivulet_world_options o = {.size = sizeof o,
                                     .json =
                                         "{\"fluid\": {\"spacing\": 0.025, \"box\": {\"max\": [1, 0.6, 0.25]}, \"maxParticles\": 15000,"
                                         " \"blocks\": [{\"max\": [0.28, 0.4, 0.25]}]}}",
                                     .walls = walls,
                                     .walls_count = count};
    DONE(rivulet_world_create(context, &o, &world, &why));
    return world;
}

static const float kGateLow[3] = {0.3F, -0.1F, -0.1F}, kGateHigh[3] = {0.35F, 0.7F, 0.35F};
static const float kFarLow[3] = {0.6F, -0.1F, -0.1F}, kFarHigh[3] = {0.65F, 0.7F, 0.35F};

/* A gate that holds water opens, and one that is baked meanwhile stops it. */
static void gates_open_and_close(rivulet_context* context, int moves, int both) {
    struct box gate, far, post;
    rivulet_mesh walls[2] = {box_of(&gate, kGateLow, kGateHigh), {0}}, stop = box_of(&far, kFarLow, kFarHigh);
    const float low[3] = {0.9F, 0, 0.1F}, high[3] = {0.95F, 0.3F, 0.15F};
    walls[0].moves = (uint32_t)moves;
    walls[1] = box_of(&post, low, high);
    rivulet_world* world = tank(context, walls, both ? 2 : 1);
    run(world, 20);
    CHECK(farthest(world) < 0.3F && state_of(world, 0) == RIVULET_WALL_ACTS);
    const size_t before = count_of(world);
    uint32_t id = 0;
    DONE(rivulet_world_add_wall(world, &stop, &id, &why));
    CHECK(id == (both ? 2U : 1U));
    wait_for_bake(world, id);
    CHECK(state_of(world, id) == RIVULET_WALL_ACTS);
    DONE(rivulet_world_remove_wall(world, 0, &why));
    int32_t state = 0;
    if (!moves && both) { /* until the post is baked alone */
        for (int tries = 0; tries < 5000 && rivulet_world_wall(world, 0, &state, NULL) == RIVULET_OK; ++tries) {
            CHECK(state == RIVULET_WALL_LEAVES);
            wait_a_little(world, 1.0e-6);
        }
    }
    REFUSED(rivulet_world_wall(world, 0, &state, &why), "no wall 0");
    REFUSED(rivulet_world_remove_wall(world, 0, &why), "no wall 0");
    run(world, 60);
    const float reached = farthest(world);
    CHECK(reached > 0.55F && reached < 0.6F && count_of(world) == before);
    if (both) CHECK(state_of(world, 1) == RIVULET_WALL_ACTS);
    DONE(rivulet_world_remove_wall(world, id, &why));
    run(world, 30);
    CHECK(farthest(world) > 0.85F && count_of(world) == before);
    rivulet_world_destroy(world);
}

/* A paddle that is added while the world runs pushes the water; poses are those of all walls that move, baked or not. */
static void a_paddle_is_added(rivulet_context* context) {
    struct box shape;
    const float low[3] = {-0.02F, -0.3F, -0.2F}, high[3] = {0.02F, 0.3F, 0.2F};
    rivulet_mesh paddle = box_of(&shape, low, high);
    paddle.moves = 1;
    paddle.pose = (rivulet_pose){{0.6F, 0.25F, 0.125F}, {0, 0, 0, 0}};
    rivulet_world* world = tank(context, NULL, 0);
    run(world, 60);
    uint32_t id = 9;
    DONE(rivulet_world_add_wall(world, &paddle, &id, &why));
    CHECK(id == 0);
    rivulet_pose pose = paddle.pose;
    rivulet_inputs in = {.size = sizeof in, .poses = &pose, .poses_count = 0};
    REFUSED(rivulet_world_step(world, &in, 1.0 / 60, &why), "0 poses were given for 1 walls");
    in.poses_count = 1;
    wait_for_bake(world, id);
    const size_t before = count_of(world);
    for (int k = 0; k < 60; ++k) {
        pose.position[0] -= 0.3F / 60;
        DONE(rivulet_world_step(world, &in, 1.0 / 60, &why));
    }
    /* Nothing has passed it: what was on its left is there. */
    size_t crossed = 0;
    const size_t n = count_of(world);
    for (size_t k = 0; k < n; ++k) crossed += positions[3 * k] > 0.28F && positions[3 * k] < 0.32F && positions[3 * k + 1] < 0.5F;
    CHECK(crossed == 0 && n == before);
    rivulet_world_destroy(world);
}

/* A bake that is still running ends with its wall, and with its world; one that cannot be is refused, or says so. */
static void a_bake_may_end_early(rivulet_context* context) {
    enum { SIDE = 200 };
    float* places = malloc(sizeof(float) * 3 * (SIDE + 1) * (SIDE + 1));
    uint32_t* corners = malloc(sizeof(uint32_t) * 6 * SIDE * SIDE);
    for (uint32_t z = 0; z <= SIDE; ++z)
        for (uint32_t x = 0; x <= SIDE; ++x) {
            float* at = places + 3 * (z * (SIDE + 1) + x);
            at[0] = (float)x / SIDE;
            at[1] = 0.02F * (float)((x * 7 + z * 13) % 5);
            at[2] = 0.25F * (float)z / SIDE;
        }
    for (uint32_t z = 0; z < SIDE; ++z)
        for (uint32_t x = 0; x < SIDE; ++x) {
            const uint32_t a = z * (SIDE + 1) + x, quad[6] = {a, a + SIDE + 1, a + 1, a + 1, a + SIDE + 1, a + SIDE + 2};
            memcpy(corners + 6 * (z * SIDE + x), quad, sizeof quad);
        }
    const rivulet_mesh ground = {.size = sizeof ground,
                                 .positions = places,
                                 .vertices = (SIDE + 1) * (SIDE + 1),
                                 .indices = corners,
                                 .indices_count = 6 * SIDE * SIDE,
                                 .resolution = 400};
    rivulet_world* world = tank(context, NULL, 0);
    uint32_t id = 0;
    DONE(rivulet_world_add_wall(world, &ground, &id, &why));
    memset(places, 0, sizeof(float) * 3 * (SIDE + 1) * (SIDE + 1)); /* it was copied */
    CHECK(state_of(world, id) == RIVULET_WALL_BAKES);               /* 80,000 triangles: the call has not waited for them */
    run(world, 1);
    DONE(rivulet_world_remove_wall(world, id, &why));
    int32_t state = 0;
    REFUSED(rivulet_world_wall(world, id, &state, &why), "no wall 0");
    CHECK(rivulet_world_add_wall(world, &ground, &id, &why) == RIVULET_BAD_INPUT); /* all vertices are in one point now */
    free(corners);
    free(places);
    rivulet_world_destroy(world);
}

static void sources_come_and_go(rivulet_context* context) {
    rivulet_world* world = tank(context, NULL, 0);
    run(world, 2);
    const size_t before = count_of(world);
    DONE(rivulet_world_set_sources(world, "{\"emitters\": [{\"litresPerSecond\": 2, \"position\": [0.5, 0.5, 0.125]}]}", &why));
    run(world, 30);
    const double litres = (double)(count_of(world) - before) * 0.025 * 0.025 * 0.025 * 1000;
    CHECK(litres > 0.9 && litres < 1.05);
    DONE(rivulet_world_set(world, "emitters.0.litresPerSecond=4", &why));
    DONE(rivulet_world_set_sources(world, "{\"sinks\": [{\"position\": [0.5, 0.3, 0.125], \"size\": [2, 2, 2]}]}", &why));
    run(world, 2);
    CHECK(count_of(world) == 0);
    DONE(rivulet_world_set_sources(world, "{}", &why));
    REFUSED(rivulet_world_set_sources(world, "{\"fluid\": {}}", &why), "fluid");
    REFUSED(rivulet_world_set_sources(world, "{\"emitters\": [{\"shape\": \"mesh\"}]}", &why), "mesh");
    REFUSED(rivulet_world_set_sources(world, NULL, &why), "NULL");
    REFUSED(rivulet_world_set_sources(NULL, "{}", &why), "NULL");
    rivulet_world_destroy(world);
}

static void what_cannot_be_is_refused(rivulet_context* context) {
    struct box shape;
    rivulet_mesh wall = box_of(&shape, kGateLow, kGateHigh);
    rivulet_world* world = tank(context, NULL, 0);
    uint32_t id = 0;
    int32_t state = 0;
    REFUSED(rivulet_world_add_wall(NULL, &wall, &id, &why), "NULL");
    REFUSED(rivulet_world_add_wall(world, NULL, &id, &why), "NULL");
    REFUSED(rivulet_world_add_wall(world, &wall, NULL, &why), "NULL");
    wall.restitution = 5; /* and nothing of it stays: the next wall is baked and acts */
    REFUSED(rivulet_world_add_wall(world, &wall, &id, &why), "restitution 5");
    wall.restitution = NAN;
    REFUSED(rivulet_world_add_wall(world, &wall, &id, &why), "restitution");
    wall.restitution = -1;
    uint32_t sound = 0;
    DONE(rivulet_world_add_wall(world, &wall, &sound, &why));
    for (int frame = 0; frame < 2000 && state != RIVULET_WALL_ACTS; ++frame) {
        DONE(rivulet_world_step(world, NULL, 1e-4, &why));
        DONE(rivulet_world_wall(world, sound, &state, &why));
    }
    CHECK(state == RIVULET_WALL_ACTS);
    DONE(rivulet_world_remove_wall(world, sound, &why));
    REFUSED(rivulet_world_remove_wall(NULL, 0, &why), "NULL");
    REFUSED(rivulet_world_wall(NULL, 0, &state, &why), "NULL");
    REFUSED(rivulet_world_wall(world, 0, NULL, &why), "NULL");
    wall.resolution = 100000;
    REFUSED(rivulet_world_add_wall(world, &wall, &id, &why), "resolution");
    wall.resolution = 0;
    wall.indices_count = 4;
    REFUSED(rivulet_world_add_wall(world, &wall, &id, &why), "three");
    wall.indices_count = 36;
    wall.layers = 1U << 16;
    REFUSED(rivulet_world_add_wall(world, &wall, &id, &why), "16 layers");
    wall.layers = 0;
    wall.moves = 3;
    REFUSED(rivulet_world_add_wall(world, &wall, &id, &why), "moves");
    rivulet_world_destroy(world);
}

/* A sheet that is added while the world runs holds the water, and gives it room where it is bent to. */
static void a_sheet_is_added(rivulet_context* context) {
    float places[12] = {0.32F, -0.1F, -0.1F, 0.32F, 0.7F, -0.1F, 0.32F, 0.7F, 0.35F, 0.32F, -0.1F, 0.35F};
    const uint32_t both[6] = {0, 1, 2, 0, 2, 3};
    const rivulet_mesh sheet = {.size = sizeof sheet,
                                .positions = places,
                                .vertices = 4,
                                .indices = both,
                                .indices_count = 6,
                                .friction = -1,
                                .restitution = -1,
                                .moves = 2,
                                .reach_low = {0.2F, -0.15F, -0.15F},
                                .reach_high = {0.7F, 0.75F, 0.4F}};
    rivulet_world* world = tank(context, NULL, 0);
    run(world, 1);
    uint32_t id = 9;
    DONE(rivulet_world_add_wall(world, &sheet, &id, &why));
    CHECK(id == 0);
    const float* shapes[1] = {places};
    rivulet_inputs in = {.size = sizeof in, .shapes = shapes, .shapes_count = 0};
    REFUSED(rivulet_world_step(world, &in, 1.0 / 60, &why), "0 shapes were given for 1 walls");
    in.shapes_count = 1;
    wait_for_bake(world, id);
    run(world, 30);
    const size_t before = count_of(world);
    CHECK(farthest(world) < 0.32F);
    for (int k = 0; k < 30; ++k) {
        for (int corner = 0; corner < 4; ++corner) places[3 * corner] += 0.005F;
        DONE(rivulet_world_step(world, &in, 1.0 / 60, &why));
    }
    run(world, 30);
    CHECK(farthest(world) > 0.4F && farthest(world) < 0.47F && count_of(world) == before);
    DONE(rivulet_world_remove_wall(world, id, &why));
    run(world, 30);
    CHECK(farthest(world) > 0.8F && count_of(world) == before);
    rivulet_world_destroy(world);
}

/* After a reset no water of t = 0 stands inside a wall that was added since; a wall that the water does not meet does not hold it. */
static void a_reset_leaves_out_what_is_inside(rivulet_context* context) {
    struct box shape;
    const float low[3] = {0.1F, 0, 0.05F}, high[3] = {0.2F, 0.2F, 0.2F};
    rivulet_mesh block = box_of(&shape, low, high);
    rivulet_world* world = tank(context, NULL, 0);
    const size_t all = count_of(world);
    uint32_t id = 0;
    DONE(rivulet_world_add_wall(world, &block, &id, &why));
    wait_for_bake(world, id);
    DONE(rivulet_world_reset(world, &why));
    size_t inside = 0;
    const size_t after = count_of(world);
    for (size_t k = 0; k < after; ++k) {
        const float* p = positions + 3 * k;
        inside += p[0] > low[0] && p[0] < high[0] && p[1] < high[1] && p[2] > low[2] && p[2] < high[2];
    }
    const double gone = (double)(all - after) * 0.025 * 0.025 * 0.025, volume = 0.1 * 0.2 * 0.15;
    CHECK(inside == 0 && gone > 0.8 * volume && gone < 2 * volume);
    run(world, 30);
    rivulet_stats stats = {.size = sizeof stats};
    DONE(rivulet_world_stats(world, &stats, &why));
    CHECK(stats.particles == after && stats.lost == 0 && stats.maximum_speed < 4);
    DONE(rivulet_world_remove_wall(world, id, &why));
    DONE(rivulet_world_reset(world, &why));
    CHECK(count_of(world) == all);
    rivulet_world_destroy(world);

    rivulet_mesh gate = box_of(&shape, kGateLow, kGateHigh);
    gate.meets = 2; /* the water is on the first layer */
    world = tank(context, &gate, 1);
    DONE(rivulet_world_add_wall(world, &gate, &id, &why));
    CHECK(id == 1 && state_of(world, 0) == RIVULET_WALL_ACTS && state_of(world, 1) == RIVULET_WALL_ACTS);
    run(world, 30);
    CHECK(farthest(world) > 0.8F && count_of(world) == all);
    DONE(rivulet_world_remove_wall(world, 0, &why));
    rivulet_world_destroy(world);
}

/* Walls come and go while wetness is on: what is wet stays wet, what is new is dry. */
static void wetness_stays(rivulet_context* context) {
    struct box gate, post;
    const float low[3] = {0.9F, -0.1F, 0.1F}, high[3] = {0.95F, 0.5F, 0.15F}, at[6] = {0.3F, 0.1F, 0.125F, 0.9F, 0.1F, 0.125F};
    const rivulet_mesh walls[1] = {box_of(&gate, kGateLow, kGateHigh)}, added = box_of(&post, low, high);
    rivulet_world* world = NULL;
    const rivulet_world_options o = {
        .size = sizeof o,
        .json =
            "{\"fluid\": {\"spacing\": 0.025, \"box\": {\"max\": [1, 0.6, 0.25]}, \"wetness\": {\"on\": true, \"dries\": 1000}, "
            "\"blocks\": [{\"max\": [0.28, 0.4, 0.25]}]}}",
        .walls = walls,
        .walls_count = 1};
    DONE(rivulet_world_create(context, &o, &world, &why));
    run(world, 10);
    float before[2] = {9, 9}, after[2] = {9, 9};
    DONE(rivulet_world_wetness(world, at, 2, before, &why));
    CHECK(before[0] > 0.5F && before[1] == 0);
    uint32_t id = 0;
    DONE(rivulet_world_add_wall(world, &added, &id, &why));
    wait_for_bake(world, id);
    DONE(rivulet_world_wetness(world, at, 2, after, &why));
    CHECK(after[0] > 0.99F * before[0] && after[1] == 0);
    rivulet_wet_solid solid = {.size = sizeof solid};
    DONE(rivulet_world_wet_solid(world, RIVULET_WALL, id, &solid, &why));
    /* The gate leaves, the post gets wet. */
    DONE(rivulet_world_remove_wall(world, 0, &why));
    run(world, 60);
    DONE(rivulet_world_wetness(world, at, 2, after, &why));
    CHECK(after[0] == 0 && after[1] > 0.5F);
    rivulet_world_destroy(world);
}

/* A host that starts the bake itself, at once: then it is done when the call returns. */
static void start_now(void* user, void (*function)(void* argument), void* argument) {
    ++*(int*)user;
    function(argument);
}
static void run_here(void* user, void (*function)(void* argument, size_t k), void* argument, size_t count) {
    (void)user;
    for (size_t k = 0; k < count; ++k) function(argument, k);
}

int main(void) {
    rivulet_context* context = cpu_context();
    gates_open_and_close(context, 1, 0);
    gates_open_and_close(context, 0, 0);
    gates_open_and_close(context, 0, 1);
    a_paddle_is_added(context);
    a_bake_may_end_early(context);
    sources_come_and_go(context);
    a_sheet_is_added(context);
    a_reset_leaves_out_what_is_inside(context);
    wetness_stays(context);
    what_cannot_be_is_refused(context);
    rivulet_context_destroy(context);
    int started = 0;
    const rivulet_jobs jobs = {.size = sizeof jobs, .user = &started, .run = run_here, .workers = 1, .start = start_now};
    const rivulet_context_options o = {.size = sizeof o, .backend = "cpu", .jobs = &jobs};
    DONE(rivulet_context_create(&o, &context, &why));
    gates_open_and_close(context, 1, 0);
    CHECK(started == 1);
    rivulet_context_destroy(context);
    return failures > 0;
}
