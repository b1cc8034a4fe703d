/* Every function of rivulet.h from C, on the cpu, where there is no OpenGL: what is asked happens, and what makes no sense is a sentence.
 */
#include <math.h>
#include <stdlib.h>

#include "check.h"

#define MOST 40000

typedef struct cloud {
    size_t count;
    float x[3 * MOST], v[3 * MOST], density[MOST];
    uint32_t id[MOST];
} cloud;

static cloud a, b;

static void read(rivulet_world* world, cloud* c) {
    rivulet_particles p = {
        .size = sizeof p, .capacity = MOST, .positions = c->x, .velocities = c->v, .densities = c->density, .ids = c->id};
    DONE(rivulet_world_particles(world, &p, &why));
    c->count = p.count;
}
static double mean(const cloud* c, const float* values, int axis) {
    double sum = 0;
    for (size_t k = 0; k < c->count; ++k) sum += values[3 * k + (size_t)axis];
    return sum / (double)c->count;
}
static float lowest(const cloud* c) {
    float low = 1e9F;
    for (size_t k = 0; k < c->count; ++k) low = fminf(low, c->x[3 * k + 1]);
    return low;
}
/* Each id of 0..count-1 once. */
static int each_id_once(const cloud* c) {
    static unsigned char seen[MOST];
    memset(seen, 0, sizeof seen);
    for (size_t k = 0; k < c->count; ++k) {
        if (c->id[k] >= c->count || seen[c->id[k]]++) return 0;
    }
    return 1;
}
/* The same particles with the same bits, in whatever order. */
static int same(const cloud* c, const cloud* d) {
    static size_t where[MOST];
    if (c->count != d->count || !each_id_once(c) || !each_id_once(d)) return 0;
    for (size_t k = 0; k < d->count; ++k) where[d->id[k]] = k;
    for (size_t k = 0; k < c->count; ++k) {
        const size_t other = where[c->id[k]];
        if (memcmp(c->x + 3 * k, d->x + 3 * other, 12) != 0 || memcmp(c->v + 3 * k, d->v + 3 * other, 12) != 0) return 0;
    }
    return 1;
}
static rivulet_world* make(rivulet_context* context, const char* json) {
    rivulet_world* world = NULL;
    rivulet_world_options o = {.size = sizeof o, .json = json};
    DONE(rivulet_world_create(context, &o, &world, &why));
    return world;
}
static void run(rivulet_world* world, int frames) {
    for (int k = 0; k < frames; ++k) DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
}

static int said;
static char last[1024];
static void hear(void* user, rivulet_level level, const char* sentence) {
    CHECK(user == &said);
    CHECK(level <= RIVULET_ERROR && sentence[0] != '\0');
    ++said;
    snprintf(last, sizeof last, "%s", sentence);
}

static const char* kDrop =
    "{\"fluid\": {\"spacing\": 0.05, \"box\": {\"max\": [1, 1.5, 1]},"
    " \"blocks\": [{\"min\": [0.3, 1, 0.3], \"max\": [0.7, 1.4, 0.7]}]}}";

static void it_falls_and_is_all_there(rivulet_context* context) {
    rivulet_world* world = make(context, kDrop);
    read(world, &a);
    CHECK(a.count == 512 && each_id_once(&a));
    const double start = mean(&a, a.x, 1);
    CHECK(fabs(start - 1.2) < 1e-3); /* particles start disordered */
    run(world, 15);                  /* a quarter of a second: 0.307 m of the metre below it */
    read(world, &b);
    CHECK(fabs(mean(&b, b.v, 1) + 9.81 * 0.25) < 0.02 * 9.81 * 0.25);
    CHECK(fabs(start - mean(&b, b.x, 1) - 0.5 * 9.81 * 0.0625) < 0.05 * 0.5 * 9.81 * 0.0625);
    CHECK(fabs(mean(&b, b.x, 0) - 0.5) < 1e-3 && fabs(mean(&b, b.x, 2) - 0.5) < 1e-3);
    run(world, 165);
    read(world, &b);
    CHECK(b.count == 512 && each_id_once(&b));
    rivulet_stats s = {.size = sizeof s};
    DONE(rivulet_world_stats(world, &s, &why));
    CHECK(s.particles == 512 && s.lost == 0 && s.substeps > 0);
    CHECK(fabs(s.time - 3) < 1e-6 && s.dropped == 0);
    for (int axis = 0; axis < 3; ++axis) CHECK(fabs(s.centre_of_mass[axis] - mean(&b, b.x, axis)) < 1e-4);
    double kinetic = 0, fastest = 0, density = 0;
    for (size_t k = 0; k < b.count; ++k) {
        const double square =
            (double)b.v[3 * k] * b.v[3 * k] + (double)b.v[3 * k + 1] * b.v[3 * k + 1] + (double)b.v[3 * k + 2] * b.v[3 * k + 2];
        kinetic += 0.5 * 0.125 * square; /* 0.05^3 m^3 of 1000 kg/m^3 each */
        fastest = fmax(fastest, sqrt(square));
        density += b.density[k] / (double)b.count;
        for (int axis = 0; axis < 3; ++axis) CHECK(b.x[3 * k + (size_t)axis] >= 0 && b.x[3 * k + (size_t)axis] <= 1.5F);
    }
    CHECK(fabs(s.kinetic - kinetic) < 0.01 * kinetic + 1e-9 && fabs(s.maximum_speed - fastest) < 0.01 * fastest + 1e-9);
    CHECK(density > 0.7 && density < 1.05 && s.average_compression >= 0 && s.average_compression < 0.05);
    /* 64 litres over a square metre are 6.4 cm deep: their middle is at half of that. */
    CHECK(s.centre_of_mass[1] > 0.025 && s.centre_of_mass[1] < 0.06);

    DONE(rivulet_world_reset(world, &why));
    read(world, &b);
    CHECK(same(&a, &b));
    DONE(rivulet_world_step(world, NULL, 0, &why));
    read(world, &b);
    CHECK(same(&a, &b)); /* no time, no change */

    /* Gravity that a host turns round. */
    const float up[3] = {0, 3, 0};
    const rivulet_inputs in = {.size = sizeof in, .gravity = up};
    for (int k = 0; k < 6; ++k) DONE(rivulet_world_step(world, &in, 1.0 / 60, &why));
    read(world, &b);
    CHECK(fabs(mean(&b, b.v, 1) - 0.3) < 0.01);
    /* Room for ten of them: ten are given, and all are counted. */
    float ten[31] = {0};
    ten[30] = -7;
    rivulet_particles p = {.size = sizeof p, .capacity = 10, .positions = ten};
    DONE(rivulet_world_particles(world, &p, &why));
    CHECK(p.count == 512 && ten[29] > 0 && ten[30] == -7);
    rivulet_world_destroy(world);
}

static void what_is_saved_goes_on_bit_for_bit(rivulet_context* context, const char* folder) {
    char path[1024];
    snprintf(path, sizeof path, "%s/kept.rstate", folder);
    rivulet_world *one = make(context, kDrop), *two = make(context, kDrop);
    run(one, 40);
    DONE(rivulet_world_save(one, path, &why));
    run(one, 20);
    DONE(rivulet_world_restore(two, path, &why));
    run(two, 20);
    read(one, &a);
    read(two, &b);
    CHECK(same(&a, &b));
    CHECK(rivulet_world_save(one, "/no/such/folder/file", &why) == RIVULET_FAILED && why.message[0] != '\0');
    CHECK(rivulet_world_restore(one, "/no/such/folder/file", &why) != RIVULET_OK && strstr(why.message, "/no/such/folder/file") != NULL);
    rivulet_world* other = make(context, "{\"fluid\": {\"spacing\": 0.1}}");
    CHECK(rivulet_world_restore(other, path, &why) == RIVULET_BAD_INPUT && why.message[0] != '\0');
    read(one, &b);
    CHECK(same(&a, &b)); /* what failed changed nothing */
    rivulet_world_destroy(other);
    rivulet_world_destroy(one);
    rivulet_world_destroy(two);
}

static const float kPlate[12] = {-0.2F, 0, -0.2F, 1.2F, 0, -0.2F, 1.2F, 0, 1.2F, -0.2F, 0, 1.2F};
static const uint32_t kSquare[6] = {0, 2, 1, 0, 3, 2};

static rivulet_world* above_a_plate(rivulet_context* context, uint32_t moves, float height, float first) {
    float at[12];
    memcpy(at, kPlate, sizeof at);
    for (int k = 0; k < 4 && moves == 0; ++k) at[3 * k + 1] = height;
    const rivulet_mesh plate = {.size = sizeof plate,
                                .positions = at,
                                .vertices = 4,
                                .indices = kSquare,
                                .indices_count = 6,
                                .friction = -1,
                                .restitution = -1,
                                .moves = moves,
                                .pose = {{0, first, 0}, {0, 0, 0, 0}}};
    const rivulet_world_options o = {.size = sizeof o, .json = kDrop, .walls = &plate, .walls_count = 1};
    rivulet_world* world = NULL;
    DONE(rivulet_world_create(context, &o, &world, &why));
    return world;
}

static void walls_stop_it_and_lift_it(rivulet_context* context) {
    rivulet_world* still = above_a_plate(context, 0, 0.5F, 0);
    run(still, 90);
    read(still, &a);
    CHECK(a.count == 512 && lowest(&a) > 0.5F && lowest(&a) < 0.55F);
    rivulet_world_destroy(still);

    rivulet_world* moving = above_a_plate(context, 1, 0, 0);
    rivulet_pose pose = {{0, 0.3F, 0}, {0, 0, 0, 0}};
    const rivulet_inputs in = {.size = sizeof in, .poses = &pose, .poses_count = 1};
    for (int k = 0; k < 90; ++k) DONE(rivulet_world_step(moving, &in, 1.0 / 60, &why));
    read(moving, &a);
    CHECK(lowest(&a) > 0.3F && lowest(&a) < 0.35F);
    for (int k = 1; k <= 30; ++k) {
        pose.position[1] = 0.3F + 0.01F * (float)k;
        DONE(rivulet_world_step(moving, &in, 1.0 / 60, &why));
    }
    read(moving, &b);
    CHECK(b.count == 512 && lowest(&b) > 0.6F);
    const rivulet_inputs two = {.size = sizeof two, .poses = &pose, .poses_count = 2};
    REFUSED(rivulet_world_step(moving, &two, 0.01, &why), "2 poses");
    pose.rotation[0] = 3;
    REFUSED(rivulet_world_step(moving, &in, 0.01, &why), "unit length");
    rivulet_world_destroy(moving);
}

/* Two plates, one that moves and one that stands still, bear the weight of their water; a reset starts the sums again. */
static void walls_report_their_loads(rivulet_context* context) {
    const char* json =
        "{\"fluid\": {\"spacing\": 0.05, \"box\": {\"max\": [1, 1, 1]}, \"blocks\": [{\"min\": [0, 0.25, 0], \"max\": [1, 0.5, 1]}], "
        "\"probes\": ["
        "{\"name\": \"floor\", \"face\": \"-y\"}, {\"name\": \"plate\", \"on\": \"collider\", \"index\": 0, \"area\": 1}]}}";
    float at[12];
    memcpy(at, kPlate, sizeof at);
    for (uint32_t moves = 0; moves < 2; ++moves) {
        for (int k = 0; k < 4; ++k) at[3 * k + 1] = moves == 0 ? 0.2F : 0;
        const rivulet_mesh plate = {.size = sizeof plate,
                                    .positions = at,
                                    .vertices = 4,
                                    .indices = kSquare,
                                    .indices_count = 6,
                                    .friction = -1,
                                    .restitution = -1,
                                    .moves = moves,
                                    .pose = {{0, 0.2F, 0}, {0, 0, 0, 0}}};
        const rivulet_world_options o = {.size = sizeof o, .json = json, .walls = &plate, .walls_count = 1};
        rivulet_world* world = NULL;
        DONE(rivulet_world_create(context, &o, &world, &why));
        if (world == NULL) return;
        rivulet_load loads[2];
        size_t n = 0;
        DONE(rivulet_world_loads(world, loads, 2, &n, &why));
        CHECK(n == 2 && strcmp(loads[1].name, "plate") == 0 && loads[1].seconds == 0 && isnan(loads[1].pressure));
        run(world, 90);
        DONE(rivulet_world_loads(world, loads, 2, &n, &why));
        rivulet_stats stats = {.size = sizeof stats};
        DONE(rivulet_world_stats(world, &stats, &why));
        const double weight = stats.particles * 1000 * 0.05 * 0.05 * 0.05 * 9.81;
        CHECK(loads[0].force[1] == 0 && loads[1].time == stats.time && fabs(loads[1].seconds - 1.0 / 60) < 1e-9);
        CHECK(fabs(loads[1].impulse[1] / (-weight * stats.time) - 1) < 0.03);
        CHECK(fabs(loads[1].pressure + loads[1].force[1]) < 0.02 * weight);
        DONE(rivulet_world_reset(world, &why));
        run(world, 1);
        DONE(rivulet_world_loads(world, loads, 2, &n, &why));
        CHECK(fabs(loads[1].impulse[1]) < 0.1 * weight);
        rivulet_world_destroy(world);
    }
}

/* The mean upward speed after a frame of free fall: about -0.16 m/s where no wall has pushed the water. */
static double speed_after_a_frame(rivulet_world* world) {
    run(world, 1);
    read(world, &a);
    return mean(&a, a.v, 1);
}

/* A wall that moves begins at its first pose, and a reset or a restore puts it back: it is not swept through the water from elsewhere. */
static void walls_that_move_begin_where_they_are(rivulet_context* context, const char* folder) {
    char path[1024];
    snprintf(path, sizeof path, "%s/wall.rstate", folder);
    const double fall = -9.81 / 60;
    rivulet_world* world = above_a_plate(context, 1, 0, 0.5F);
    run(world, 90);
    read(world, &a);
    CHECK(a.count == 512 && lowest(&a) > 0.5F && lowest(&a) < 0.55F);
    rivulet_pose pose = {{0, 0.8F, 0}, {0, 0, 0, 0}};
    const rivulet_inputs in = {.size = sizeof in, .poses = &pose, .poses_count = 1};
    for (int k = 0; k < 30; ++k) { /* under the water, then through where it began */
        pose.position[1] = 0.5F + 0.03F * (float)(k + 1);
        DONE(rivulet_world_step(world, &in, 1.0 / 60, &why));
    }
    DONE(rivulet_world_reset(world, &why));
    CHECK(fabs(speed_after_a_frame(world) - fall) < 0.02);
    DONE(rivulet_world_reset(world, &why));
    DONE(rivulet_world_save(world, path, &why));
    pose.position[1] = 1.4F;
    DONE(rivulet_world_step(world, &in, 1.0 / 60, &why));
    DONE(rivulet_world_restore(world, path, &why));
    CHECK(fabs(speed_after_a_frame(world) - fall) < 0.02);
    rivulet_world_destroy(world);

    const rivulet_mesh bent = {.size = sizeof bent,
                               .positions = kPlate,
                               .vertices = 4,
                               .indices = kSquare,
                               .indices_count = 6,
                               .moves = 1,
                               .pose = {{0, 0, 0}, {0, 2, 0, 0}}};
    const rivulet_world_options o = {.size = sizeof o, .json = kDrop, .walls = &bent, .walls_count = 1};
    REFUSED(rivulet_world_create(context, &o, &world, &why), "walls[0].pose");
}

/* A host that lowers a cube into the water by hand, and feels how it is pushed. */
typedef struct hand {
    double force[3], seconds; /* N s, s: while it is held under */
    double clock;
    int resets;
    rivulet_world* calls_back; /* what it steps and destroys while it is asked, or NULL */
} hand;
static void lower(void* user, const rivulet_body_load* loads, const float* gravity, double seconds, rivulet_body_state* states,
                  size_t count) {
    hand* h = user;
    CHECK(count == 1 && fabsf(gravity[1] + 9.81F) < 1e-5F && seconds > 0);
    h->clock += seconds;
    if (h->calls_back != NULL) {
        REFUSED(rivulet_world_step(h->calls_back, NULL, 0.01, &why), "callbacks must not");
        rivulet_world_destroy(h->calls_back); /* is refused and logged */
    }
    const int under = h->clock > 3;
    states[0].pose.position[1] = under ? 0.25F : 0.75F - 0.5F / 3 * (float)h->clock;
    states[0].velocity[1] = under ? 0 : -0.5F / 3;
    if (h->clock > 4) {
        for (int axis = 0; axis < 3; ++axis) h->force[axis] += loads[0].force[axis] * seconds;
        h->seconds += seconds;
    }
}
static void back(void* user, const rivulet_body_state* states, size_t count) {
    CHECK(count == 1 && states[0].pose.position[1] == 0.75F && states[0].pose.rotation[3] == 1);
    ++((hand*)user)->resets;
    ((hand*)user)->clock = 0;
}

static void bodies_are_pushed_as_Archimedes_says(rivulet_context* context) {
    enum { N = 8 };
    const float spacing = 0.025F, side = N * 0.025F;
    static float samples[3 * N * N * N];
    size_t n = 0;
    for (int x = 0; x < N; ++x)
        for (int y = 0; y < N; ++y)
            for (int z = 0; z < N; ++z) {
                if (x % (N - 1) != 0 && y % (N - 1) != 0 && z % (N - 1) != 0) continue;
                const int at[3] = {x, y, z};
                for (int axis = 0; axis < 3; ++axis) samples[3 * n + (size_t)axis] = ((float)at[axis] + 0.5F) * spacing - 0.5F * side;
                ++n;
            }
    hand host = {{0}, 0, 0, 0, NULL};
    const rivulet_body_host functions = {.size = sizeof functions, .user = &host, .advance = lower, .reset = back};
    const float mass = 500 * side * side * side, inertia = mass * side * side / 6;
    const rivulet_body cube = {.size = sizeof cube,
                               .samples = samples,
                               .samples_count = n,
                               .mass = mass,
                               .inertia = {inertia, inertia, inertia},
                               .volume = side * side * side,
                               .pose = {{0.3F, 0.75F, 0.3F}, {0, 0, 0, 0}}};
    const char* pool =
        "{\"fluid\": {\"spacing\": 0.025, \"box\": {\"max\": [0.6, 1, 0.6]},"
        " \"blocks\": [{\"max\": [0.6, 0.5, 0.6]}]}}";
    rivulet_world_options o = {.size = sizeof o, .json = pool, .bodies = &cube, .bodies_count = 1, .body_host = &functions};
    rivulet_world* world = NULL;
    DONE(rivulet_world_create(context, &o, &world, &why));
    run(world, 330);
    rivulet_body_state at;
    DONE(rivulet_world_bodies(world, &at, 1, &why));
    CHECK(at.pose.position[1] == 0.25F && at.pose.rotation[3] == 1 && at.velocity[1] == 0);
    REFUSED(rivulet_world_bodies(world, &at, 2, &why), "1 bodies");
    REFUSED(rivulet_world_bodies(world, NULL, 1, &why), "states is NULL");
    REFUSED(rivulet_world_bodies(NULL, &at, 1, &why), "world is NULL");
    const double weight = 1000 * 9.81 * pow(side, 3), lift = host.force[1] / host.seconds;
    printf("a cube of 0.2 m held under: lifted by %.2f N, Archimedes %.2f N\n", lift, weight);
    CHECK(fabs(lift - weight) < 0.1 * weight);
    CHECK(fabs(host.force[0] / host.seconds) < 0.05 * weight && fabs(host.force[2] / host.seconds) < 0.05 * weight);
    said = 0;
    host.calls_back = world;
    run(world, 1);
    host.calls_back = NULL;
    CHECK(said > 0 && strstr(last, "not destroyed") != NULL);
    const int before = host.resets;
    DONE(rivulet_world_reset(world, &why));
    CHECK(host.resets == before + 1);
    /* What a host remembers cannot be saved for it. */
    CHECK(rivulet_world_save(world, "never_written", &why) == RIVULET_FAILED && why.message[0] != '\0');
    rivulet_world_destroy(world);

    /* Left to itself it falls in, and floats with half of itself under, as it is half as dense as water. */
    o.body_host = NULL;
    DONE(rivulet_world_create(context, &o, &world, &why));
    run(world, 9);
    rivulet_body_state expected;
    DONE(rivulet_world_expected_bodies(world, &expected, 1, &why));
    DONE(rivulet_world_bodies(world, &at, 1, &why));
    CHECK(fabs(expected.pose.position[1] - at.pose.position[1]) < 0.005); /* it falls freely */
    REFUSED(rivulet_world_expected_bodies(world, &expected, 2, &why), "1 bodies");
    CHECK(fabs(at.velocity[1] + 9.81 * 0.15) < 0.02 && fabs(at.pose.position[1] - (0.75 - 0.5 * 9.81 * 0.0225)) < 0.02);
    run(world, 171);
    DONE(rivulet_world_bodies(world, &at, 1, &why));
    read(world, &a);
    /* What is under, 4 litres, has nowhere to go but up: 1.1 cm. */
    printf("it floats at %.3f m, of water that was 0.5 m deep\n", at.pose.position[1]);
    CHECK(fabs(at.pose.position[1] - 0.511) < 0.03);
    rivulet_world_destroy(world);
    const rivulet_body_host half = {.size = sizeof half, .advance = lower};
    o.body_host = &half;
    REFUSED(rivulet_world_create(context, &o, &world, &why), "both or neither");
    CHECK(world == NULL);
}

/* A box that stands in a pool and a cube that floats in it are wet where the water is, and the box takes its wetness along. */
static void solids_are_wet_where_water_is(rivulet_context* context) {
    float corners[24];
    for (int k = 0; k < 24; ++k) corners[k] = (k % 3 == 0 ? k / 3 & 1 : k % 3 == 1 ? k / 3 >> 1 & 1 : k / 3 >> 2) ? 0.1F : -0.1F;
    const uint32_t sides[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    const rivulet_mesh box = {.size = sizeof box,
                              .positions = corners,
                              .vertices = 8,
                              .indices = sides,
                              .indices_count = 36,
                              .moves = 1,
                              .pose = {{0.25F, 0.2F, 0.25F}, {0, 0, 0, 0}}};
    const float sample[3] = {0, 0, 0};
    const rivulet_body fixed = {.size = sizeof fixed,
                                .samples = sample,
                                .samples_count = 1,
                                .inertia = {1, 1, 1},
                                .volume = 0.001F,
                                .pose = {{0.75F, 0.2F, 0.75F}, {0, 0, 0, 0}},
                                .mesh = &box};
    const char* json =
        "{\"fluid\": {\"spacing\": 0.05, \"wetness\": {\"on\": true, \"runs\": 0},"
        " \"blocks\": [{\"max\": [1, 0.2, 1], \"cut\": true}]}}";
    rivulet_world_options o = {.size = sizeof o, .json = json, .walls = &box, .walls_count = 1, .bodies = &fixed, .bodies_count = 1};
    rivulet_world* world = NULL;
    DONE(rivulet_world_create(context, &o, &world, &why));
    float places[15] = {0.35F, 0.12F, 0.25F, 0.35F, 0.29F, 0.25F, 0.75F, 0.12F, 0.85F, 0.75F, 0.29F, 0.85F, 0.5F, 0.9F, 0.5F};
    float wetness[5];
    DONE(rivulet_world_wetness(world, places, 5, wetness, &why));
    for (int k = 0; k < 5; ++k) CHECK(wetness[k] == 0);
    run(world, 20);
    DONE(rivulet_world_wetness(world, places, 5, wetness, &why));
    CHECK(wetness[0] > 0.99F && wetness[1] < 0.1F && wetness[2] > 0.99F && wetness[3] < 0.1F && wetness[4] == 0);

    rivulet_wet_solid at = {.size = sizeof at}, higher = {.size = sizeof higher};
    DONE(rivulet_world_wet_solid(world, RIVULET_WALL, 0, &at, &why));
    CHECK(at.cells[0] >= 8 && at.cells[1] >= 8 && at.cells[2] >= 8);
    DONE(rivulet_world_wet_solid(world, RIVULET_BODY, 0, &higher, &why));
    CHECK(higher.first_cell >= at.first_cell + (uint32_t)(at.cells[0] * at.cells[1] * at.cells[2]));
    const rivulet_pose lifted = {{0.25F, 0.7F, 0.25F}, {0, 0, 0, 0}};
    const rivulet_inputs in = {.size = sizeof in, .poses = &lifted, .poses_count = 1};
    for (int k = 0; k < 6; ++k) DONE(rivulet_world_step(world, &in, 1.0 / 60, &why));
    places[1] += 0.5F;
    DONE(rivulet_world_wetness(world, places, 1, wetness, &why));
    CHECK(wetness[0] > 0.95F);
    DONE(rivulet_world_wet_solid(world, RIVULET_WALL, 0, &higher, &why));
    /* The same cell, half a metre higher. */
    const float cell = at.from_world[1 + 4 * 3] + at.from_world[1 + 4] * 0.2F;
    CHECK(fabsf(higher.from_world[1 + 4 * 3] + higher.from_world[1 + 4] * 0.7F - cell) < 1e-3F);
    REFUSED(rivulet_world_wet_solid(world, RIVULET_WALL, 1, &at, &why), "no wall 1");
    REFUSED(rivulet_world_wet_solid(world, 7, 0, &at, &why), "RIVULET_WALL or RIVULET_BODY");
    REFUSED(rivulet_world_wetness(world, NULL, 1, wetness, &why), "places or wetness is NULL");
    rivulet_world_destroy(world);

    o.json = "{\"fluid\": {\"spacing\": 0.05, \"blocks\": [{\"max\": [1, 0.2, 1], \"cut\": true}]}}";
    DONE(rivulet_world_create(context, &o, &world, &why));
    run(world, 2);
    DONE(rivulet_world_wetness(world, places, 5, wetness, &why));
    for (int k = 0; k < 5; ++k) CHECK(wetness[k] == 0);
    REFUSED(rivulet_world_wet_solid(world, RIVULET_WALL, 0, &at, &why), "fluid.wetness.on is off");
    rivulet_world_destroy(world);
}

static void values_are_set_and_emitters_pour(rivulet_context* context) {
    rivulet_world* world = make(context,
                                "{\"fluid\": {\"spacing\": 0.05, \"maxParticles\": 4000, \"box\": {\"max\": [1, 1, 1]}},"
                                " \"emitters\": [{\"position\": [0.5, 0.8, 0.5], \"litresPerSecond\": 10, \"radius\": 0.1}]}");
    run(world, 60);
    rivulet_stats s = {.size = sizeof s};
    DONE(rivulet_world_stats(world, &s, &why));
    CHECK(fabs(s.particles * 0.125 - 10) < 1); /* litres; a layer of the jet is half a litre */
    DONE(rivulet_world_set(world, "emitters.0.litresPerSecond=0", &why));
    run(world, 30);
    const uint32_t poured = s.particles;
    DONE(rivulet_world_stats(world, &s, &why));
    CHECK(s.particles <= poured + 8);
    DONE(rivulet_world_set(world, "fluid.viscosity=0.01", &why));
    DONE(rivulet_world_set(world, "look.quality=fast", &why));
    REFUSED(rivulet_world_set(world, "fluid.spacing=0.02", &why), "fixed");
    REFUSED(rivulet_world_set(world, "fluid.viscosty=0.02", &why), "viscosity");
    REFUSED(rivulet_world_set(world, "fluid.viscosity=-1", &why), "fluid.viscosity");
    REFUSED(rivulet_world_set(world, "nonsense", &why), "nonsense");
    REFUSED(rivulet_world_set(world, NULL, &why), "NULL");
    REFUSED(rivulet_world_set(world, "emitters.1.litresPerSecond=2", &why), "emitters");
    rivulet_world_destroy(world);
}

static void drops_run_down_a_skin(rivulet_context* context) {
    /* A plate of 10 cm that stands, its uvs in metres over 0.1. */
    const float at[12] = {0, 0, 0, 0.1F, 0, 0, 0.1F, 0.1F, 0, 0, 0.1F, 0}, uvs[8] = {0, 0, 1, 0, 1, 1, 0, 1};
    const uint32_t triangles[6] = {0, 1, 2, 0, 2, 3};
    const rivulet_mesh plate = {.size = sizeof plate, .positions = at, .vertices = 4, .indices = triangles, .indices_count = 6, .uvs = uvs};
    rivulet_skin_options o = {.size = sizeof o, .mesh = &plate, .map_size = 64};
    rivulet_skin* skin = NULL;
    /* One triangle's uvs on the other's: the skin is made, and the host is told. */
    const float twice[8] = {0, 0, 1, 0, 1, 1, 1, 0};
    const rivulet_mesh folded = {
        .size = sizeof folded, .positions = at, .vertices = 4, .indices = triangles, .indices_count = 6, .uvs = twice};
    o.mesh = &folded;
    said = 0;
    DONE(rivulet_skin_create(context, &o, &skin, &why));
    CHECK(said == 2 && strstr(last, "mesh.uvs: The skin's UVs have 50.0 % of overlap") != NULL);
    rivulet_skin_destroy(skin);
    o.mesh = &plate;
    DONE(rivulet_skin_create(context, &o, &skin, &why));
    CHECK(said == 3 && strstr(last, "uvs") == NULL); /* open edges alone */
    const float place[3] = {0.05F, 0.05F, 0.001F};
    DONE(rivulet_skin_add(skin, place, 20, &why));
    const float wind[3] = {0, 0, 0};
    const float to_world[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const rivulet_skin_inputs in = {.size = sizeof in, .wind = wind, .to_world = to_world, .positions = at};
    rivulet_skin_stats s = {.size = sizeof s};
    DONE(rivulet_skin_step(skin, &in, 1.0 / 60, &why));
    DONE(rivulet_skin_stats_of(skin, &s, &why));
    CHECK(s.drops == 1 && fabs(s.added - 20e-9) < 1e-14);
    rivulet_context_stop(context, 1); /* nothing moves, and nothing is lost */
    CHECK(rivulet_skin_step(skin, NULL, 1.0 / 60, &why) == RIVULET_FAILED && strstr(why.message, "rivulet_context_stop") != NULL);
    rivulet_context_stop(context, 0);
    for (int k = 0; k < 120; ++k) DONE(rivulet_skin_step(skin, NULL, 1.0 / 60, &why));
    DONE(rivulet_skin_stats_of(skin, &s, &why));
    CHECK(fabs(s.added - s.on_skin - s.left - s.evaporated - s.refused) < 1e-14);
    CHECK(s.left > 10e-9); /* 20 microlitres do not stay on an upright pane */
    uint32_t texture = 0;
    REFUSED(rivulet_skin_texture(skin, &texture, &why), "no OpenGL");
    REFUSED(rivulet_skin_texture(skin, NULL, &why), "NULL");
    REFUSED(rivulet_skin_texture(NULL, &texture, &why), "skin is NULL");
    REFUSED(rivulet_skin_add(skin, place, -1, &why), "microlitres");
    REFUSED(rivulet_skin_add(skin, NULL, 1, &why), "NULL");
    REFUSED(rivulet_skin_add(NULL, place, 1, &why), "skin is NULL");
    REFUSED(rivulet_skin_step(NULL, NULL, 1, &why), "skin is NULL");
    REFUSED(rivulet_skin_step(skin, NULL, NAN, &why), "finite");
    const rivulet_skin_inputs of_gl = {.size = sizeof of_gl, .positions_buffer = 1};
    REFUSED(rivulet_skin_step(skin, &of_gl, 1.0 / 60, &why), "inputs.positions_buffer is set, and the context has no OpenGL");
    REFUSED(rivulet_skin_stats_of(skin, NULL, &why), "NULL");
    REFUSED(rivulet_skin_stats_of(NULL, &s, &why), "NULL");
    rivulet_skin_destroy(skin);
    REFUSED(rivulet_skin_create(context, NULL, &skin, &why), "mesh is NULL");
    REFUSED(rivulet_skin_create(NULL, &o, &skin, &why), "context is NULL");
    REFUSED(rivulet_skin_create(context, &o, NULL, &why), "NULL");
    o.json = "{\"advancng\": 60}";
    REFUSED(rivulet_skin_create(context, &o, &skin, &why), "advancing");
    o.json = NULL;
    o.map_size = 100;
    CHECK(rivulet_skin_create(context, &o, &skin, &why) == RIVULET_BAD_INPUT && why.message[0] != '\0');
    rivulet_mesh bare = plate;
    bare.uvs = NULL;
    o.mesh = &bare;
    REFUSED(rivulet_skin_create(context, &o, &skin, &why), "uvs");
    rivulet_skin_destroy(NULL);
}

/* A block of 0.4 m on a floor, as it lies at t = 0: 0.2 to 0.6 m on every side. */
static void a_game_asks_what_the_water_is(rivulet_context* context, const char* folder) {
    rivulet_world* world =
        make(context, "{\"fluid\": {\"spacing\": 0.025, \"blocks\": [{\"min\": [0.2, 0, 0.2], \"max\": [0.6, 0.4, 0.6]}]}}");
    const float places[] = {0.4F, 0.2F, 0.4F, 0.9F, 0.2F, 0.9F, NAN, 0, 0};
    rivulet_sample at[3];
    DONE(rivulet_world_sample(world, places, 3, at, &why));
    CHECK(fabsf(at[0].density - 1) < 0.1F && at[1].density == 0 && at[2].density == 0);
    CHECK(at[0].velocity[1] == 0);
    const rivulet_ray rays[] = {{{0.4F, 1, 0.4F}, {0, -2, 0}, 0}, {{0.4F, 1, 0.4F}, {0, -2, 0}, 0.3F}, {{0.9F, 1, 0.9F}, {0, -1, 0}, 0}};
    rivulet_hit hits[3];
    DONE(rivulet_world_cast(world, rays, 3, hits, &why));
    CHECK(hits[0].hit == 1 && hits[0].inside == 0 && fabsf(hits[0].distance - 0.6F) < 0.0125F && hits[0].normal[1] > 0.9F);
    CHECK(hits[1].hit == 0 && hits[2].hit == 0);
    const float over[] = {0.4F, 0.4F, 0.9F, 0.9F};
    float heights[2];
    DONE(rivulet_world_heights(world, over, 2, heights, &why));
    CHECK(fabsf(heights[0] - 0.4F) < 0.0125F && isnan(heights[1]));

    const rivulet_volume volumes[] = {{7, RIVULET_BOX, {0.4F, 0.2F, 0.4F}, {1, 1, 1}, 0}, {8, RIVULET_SPHERE, {0.9F, 0, 0.9F}, {0}, 0.2F}};
    DONE(rivulet_world_set_volumes(world, volumes, 2, &why));
    run(world, 30);
    rivulet_volume_count counts[32];
    size_t n = 0;
    DONE(rivulet_world_volumes(world, counts, 32, &n, &why));
    CHECK(n == 2 && counts[0].id == 7 && counts[1].id == 8);
    for (size_t k = 0; k < n; ++k) CHECK(counts[k].inside == counts[k].entered - counts[k].left);
    CHECK(counts[1].inside > 0 && fabs(counts[1].volume_inside - (double)counts[1].inside * pow(0.025, 3)) < 1e-9);
    DONE(rivulet_world_volume_events(world, counts, 32, &n, &why));
    CHECK(n == 2 && counts[0].entered > 3000);
    DONE(rivulet_world_volume_events(world, counts, 32, &n, &why));
    CHECK(n == 0);
    REFUSED(rivulet_world_volume_events(world, counts, 3, &n, &why), "32");
    rivulet_load loads[3];
    DONE(rivulet_world_loads(world, loads, 3, &n, &why));
    CHECK(n == 0); /* this world has no probes: see probes() */
    REFUSED(rivulet_world_loads(world, loads, 3, NULL, &why), "count");
    const rivulet_volume twice[] = {volumes[0], volumes[0]};
    REFUSED(rivulet_world_set_volumes(world, twice, 2, &why), "7");
    REFUSED(rivulet_world_sample(world, NULL, 1, at, &why), "NULL");

    const char* files[] = {"water.ply", "water.vtp", "water.csv"};
    char path[1000];
    for (int k = 0; k < 3; ++k) {
        snprintf(path, sizeof path, "%s/%s", folder, files[k]);
        DONE(rivulet_world_export(world, path, &why));
        FILE* file = fopen(path, "rb");
        CHECK(file != NULL && fseek(file, 0, SEEK_END) == 0 && ftell(file) > 4096 * 30);
        if (file) fclose(file);
    }
    snprintf(path, sizeof path, "%s/surface.obj", folder);
    DONE(rivulet_world_export_surface(world, path, &why));
    FILE* file = fopen(path, "r");
    char line[200] = "";
    int vertices = 0;
    while (file && fgets(line, sizeof line, file)) vertices += strncmp(line, "v ", 2) == 0;
    if (file) fclose(file);
    CHECK(vertices > 1000);
    REFUSED(rivulet_world_export(world, "water.stl", &why), ".ply");
    REFUSED(rivulet_world_export_surface(world, "water.vtp", &why), ".obj");
    rivulet_world_destroy(world);
}

/* A program that knew less, and one that knows more than the library: each gets and gives what both know. */
static void other_versions_understand_each_other(rivulet_context* context) {
    rivulet_world* world = make(context, kDrop);
    rivulet_stats s;
    memset(&s, 0x55, sizeof s);
    const rivulet_stats untouched = s;
    s.size = offsetof(rivulet_stats, kinetic);
    DONE(rivulet_world_stats(world, &s, &why));
    CHECK(s.size == offsetof(rivulet_stats, kinetic) && s.time == 0 && s.particles == 512);
    CHECK(memcmp((char*)&s + s.size, (const char*)&untouched + s.size, sizeof s - s.size) == 0);
    const float up[3] = {0, 9.81F, 0};
    const rivulet_inputs in = {.size = offsetof(rivulet_inputs, poses), .gravity = up, .poses = (const rivulet_pose*)&in, .poses_count = 9};
    DONE(rivulet_world_step(world, &in, 0.01, &why)); /* it never heard of poses; up is down */
    struct {
        rivulet_stats known;
        double later;
    } newer = {.known = {.size = sizeof newer}, .later = 7};
    DONE(rivulet_world_stats(world, &newer.known, &why));
    CHECK(newer.known.particles == 512 && newer.known.potential < 0 && newer.later == 7);
    s.size = 0;
    REFUSED(rivulet_world_stats(world, &s, &why), "stats.size is 0: set it to sizeof(rivulet_stats)");
    s.size = (size_t)-1;
    REFUSED(rivulet_world_stats(world, &s, &why), "sizeof(rivulet_stats)");
    rivulet_world_destroy(world);

    /* Two walls, each of a size that a later header might have. */
    struct {
        rivulet_mesh known;
        double later[2];
    } walls[2];
    memset(walls, 0, sizeof walls);
    const uint32_t triangles[6] = {0, 2, 1, 0, 3, 2}, beyond[3] = {0, 1, 9};
    for (int k = 0; k < 2; ++k)
        walls[k].known = (rivulet_mesh){
            .size = sizeof walls[0], .positions = kPlate, .vertices = 4, .indices = triangles, .indices_count = k == 0 ? 6 : 3};
    rivulet_world_options o = {.size = sizeof o, .walls = &walls[0].known, .walls_count = 2};
    DONE(rivulet_world_create(context, &o, &world, &why));
    rivulet_world_destroy(world);
    walls[1].known.indices = beyond;
    REFUSED(rivulet_world_create(context, &o, &world, &why), "walls[1] has an index 9");
}

static void what_makes_no_sense_is_a_sentence(rivulet_context* context) {
    rivulet_world* world = NULL;
    const struct {
        const char *json, *words;
    } bad[] = {{"{\"fluid\": {\"spacng\": 0.1}}", "spacing"},
               {"{\n \"fluid\": {\n  \"spacing\": \"wide\"}}", "json:3"},
               {"{\"fluid\": ", "json:1"},
               {"{\"fluid\": {\"spacing\": -1}}", "fluid.spacing"},
               {"{\"colliders\": []}", "colliders"},
               {"{\"emitters\": [{\"shape\": \"mesh\"}]}", "emitters[0]"},
               {"{\"fluid\": {\"blocks\": [{\"shape\": \"mesh\"}]}}", "fluid.blocks[0]"},
               {"{\"fluid\": {\"method\": \"magic\"}}", "magic"}};
    for (size_t k = 0; k < sizeof bad / sizeof *bad; ++k) {
        const rivulet_world_options o = {.size = sizeof o, .json = bad[k].json};
        REFUSED(rivulet_world_create(context, &o, &world, &why), bad[k].words);
        CHECK(world == NULL);
    }
    rivulet_world_options o = {.size = 0};
    REFUSED(rivulet_world_create(context, &o, &world, &why), "sizeof(rivulet_world_options)");
    REFUSED(rivulet_world_create(NULL, NULL, &world, &why), "context is NULL");
    REFUSED(rivulet_world_create(context, NULL, NULL, &why), "NULL");
    const uint32_t beyond[3] = {0, 1, 9};
    rivulet_mesh wall = {.size = sizeof wall, .positions = kPlate, .vertices = 4, .indices = beyond, .indices_count = 3};
    o = (rivulet_world_options){.size = sizeof o, .walls = &wall, .walls_count = 1};
    REFUSED(rivulet_world_create(context, &o, &world, &why), "walls[0] has an index 9");
    wall.indices_count = 2;
    REFUSED(rivulet_world_create(context, &o, &world, &why), "three");
    wall.positions = NULL;
    REFUSED(rivulet_world_create(context, &o, &world, &why), "no triangles");
    wall.size = 0;
    REFUSED(rivulet_world_create(context, &o, &world, &why), "sizeof(rivulet_mesh)");
    o.walls = NULL;
    REFUSED(rivulet_world_create(context, &o, &world, &why), "walls is NULL");
    const rivulet_body empty = {.size = sizeof empty};
    o = (rivulet_world_options){.size = sizeof o, .bodies = &empty, .bodies_count = 1};
    REFUSED(rivulet_world_create(context, &o, &world, &why), "bodies[0] has no samples");
    const float beside[6] = {0.5f, 0.5f, 0.5f, 0.5f, -1, 0.5f};
    o = (rivulet_world_options){.size = sizeof o, .json = kDrop, .particles = beside, .particles_count = 2};
    REFUSED(rivulet_world_create(context, &o, &world, &why), "particles[1] at (0.5, -1, 0.5) m is outside fluid.box");
    o.particles = NULL;
    REFUSED(rivulet_world_create(context, &o, &world, &why), "particles is NULL");

    world = make(context, kDrop);
    rivulet_stats s = {.size = sizeof s};
    rivulet_buffers buffers = {.size = sizeof buffers};
    rivulet_particles unsized = {.size = 0};
    const float nowhere[3] = {NAN, 0, 0};
    const rivulet_inputs in = {.size = sizeof in, .gravity = nowhere};
    REFUSED(rivulet_world_step(world, NULL, NAN, &why), "finite");
    REFUSED(rivulet_world_step(world, &in, 0.01, &why), "gravity");
    REFUSED(rivulet_world_step(NULL, NULL, 0.01, &why), "world is NULL");
    REFUSED(rivulet_world_reset(NULL, &why), "world is NULL");
    REFUSED(rivulet_world_set(NULL, "fluid.viscosity=0", &why), "world is NULL");
    REFUSED(rivulet_world_stats(NULL, &s, &why), "world is NULL");
    REFUSED(rivulet_world_stats(world, NULL, &why), "stats is NULL");
    REFUSED(rivulet_world_particles(NULL, &unsized, &why), "world is NULL");
    REFUSED(rivulet_world_particles(world, NULL, &why), "particles is NULL");
    REFUSED(rivulet_world_particles(world, &unsized, &why), "sizeof(rivulet_particles)");
    REFUSED(rivulet_world_save(NULL, "f", &why), "world is NULL");
    REFUSED(rivulet_world_save(world, NULL, &why), "path is NULL");
    REFUSED(rivulet_world_restore(NULL, "f", &why), "world is NULL");
    REFUSED(rivulet_world_restore(world, NULL, &why), "path is NULL");
    REFUSED(rivulet_world_draw(NULL, NULL, NULL, &why), "world is NULL");
    REFUSED(rivulet_world_draw(world, NULL, NULL, &why), "no OpenGL");
    REFUSED(rivulet_world_buffers(NULL, &buffers, &why), "world is NULL");
    REFUSED(rivulet_world_buffers(world, &buffers, &why), "no OpenGL");
    CHECK(rivulet_world_step(NULL, NULL, 0.01, NULL) == RIVULET_BAD_INPUT); /* the sentence is not wanted */
    rivulet_world_destroy(world);
    rivulet_world_destroy(NULL);
    rivulet_context_destroy(NULL);
}

int main(int count, char** arguments) {
    const char* folder = count > 1 ? arguments[1] : ".";
    char version[32];
    snprintf(version, sizeof version, "%d.%d.%d", RIVULET_VERSION_MAJOR, RIVULET_VERSION_MINOR, RIVULET_VERSION_PATCH);
    CHECK(strcmp(rivulet_version(), version) == 0);

    rivulet_context* context = NULL;
    rivulet_context_options options = {.size = sizeof options, .backend = "abacus", .log = hear, .log_user = &said};
    REFUSED(rivulet_context_create(&options, &context, &why), "abacus");
    CHECK(context == NULL);
    REFUSED(rivulet_context_create(&options, NULL, &why), "NULL");
    options.size = 0;
    REFUSED(rivulet_context_create(&options, &context, &why), "sizeof(rivulet_context_options)");
    options.size = sizeof options;
    options.backend = "cpu";
    DONE(rivulet_context_create(&options, &context, &why));
    if (context == NULL) return 1;
    CHECK(strncmp(rivulet_context_device(context), "cpu: ", 5) == 0);
    CHECK(rivulet_context_device(NULL)[0] == '\0' && rivulet_context_memory(NULL) == 0);

    it_falls_and_is_all_there(context);
    what_is_saved_goes_on_bit_for_bit(context, folder);
    walls_stop_it_and_lift_it(context);
    walls_report_their_loads(context);
    walls_that_move_begin_where_they_are(context, folder);
    bodies_are_pushed_as_Archimedes_says(context);
    solids_are_wet_where_water_is(context);
    values_are_set_and_emitters_pour(context);
    drops_run_down_a_skin(context);
    a_game_asks_what_the_water_is(context, folder);
    other_versions_understand_each_other(context);
    what_makes_no_sense_is_a_sentence(context);

    /* A context is not taken from under its worlds. */
    const size_t before = rivulet_context_memory(context);
    rivulet_world* world = make(context, kDrop);
    CHECK(rivulet_context_memory(context) > before);
    said = 0;
    rivulet_context_destroy(context);
    CHECK(said == 1 && strstr(last, "1 worlds") != NULL);
    run(world, 2);
    rivulet_stats then = {.size = sizeof then}, now = {.size = sizeof now};
    DONE(rivulet_world_stats(world, &then, &why));
    rivulet_context_stop(NULL, 1);
    rivulet_context_stop(context, 1); /* nothing is stepped, and the world stays as it was */
    CHECK(rivulet_world_step(world, NULL, 1.0 / 60, &why) == RIVULET_FAILED && strstr(why.message, "rivulet_context_stop") != NULL);
    DONE(rivulet_world_stats(world, &now, &why));
    CHECK(now.time == then.time);
    rivulet_sample sample[1];
    const float place[3] = {0, 0, 0};
    CHECK(rivulet_world_sample(world, place, 1, sample, &why) == RIVULET_FAILED && strstr(why.message, "stop") != NULL);
    rivulet_context_stop(context, 0);
    DONE(rivulet_world_sample(world, place, 1, sample, &why));
    run(world, 1);
    DONE(rivulet_world_stats(world, &now, &why));
    CHECK(now.time > then.time);
    rivulet_world_destroy(world);
    CHECK(rivulet_context_memory(context) == before);
    rivulet_context_destroy(context);

    /* As an older header, that knew less, and a newer one, that knows more, would have it. */
    struct {
        rivulet_context_options known;
        char unknown[64];
    } newer = {.known = {.size = sizeof newer, .backend = "cpu"}};
    DONE(rivulet_context_create(&newer.known, &context, &why));
    rivulet_context_destroy(context);
    rivulet_context_options older = {.size = offsetof(rivulet_context_options, log), .backend = "cpu"};
    older.memory_limit = 1; /* it could not know of that */
    DONE(rivulet_context_create(&older, &context, &why));
    rivulet_world_destroy(make(context, kDrop));
    rivulet_context_destroy(context);
    rivulet_pass_time passes[64];
    size_t told = 99;
    DONE(rivulet_context_create(&newer.known, &context, &why));
    DONE(rivulet_context_times(context, NULL, 0, &told, &why));
    CHECK(told == 0);
    CHECK(rivulet_context_times(context, NULL, 1, &told, &why) == RIVULET_BAD_INPUT);
    world = make(context, kDrop);
    DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    DONE(rivulet_context_times(context, passes, 1, &told, &why));
    CHECK(told > 1 && passes[0].calls > 0 && passes[0].ms >= 0 && passes[0].name[0] != '\0');
    DONE(rivulet_context_times(context, passes, 64, &told, &why)); /* what there was no room for is not lost */
    CHECK(told > 1 && told < 64);
    DONE(rivulet_context_times(context, passes, 64, &told, &why));
    CHECK(told == 0);
    rivulet_world_destroy(world);
    rivulet_context_destroy(context);
    options = (rivulet_context_options){.size = sizeof options, .backend = "cpu", .memory_limit = 1 << 14};
    DONE(rivulet_context_create(&options, &context, &why));
    rivulet_world_options drop = {.size = sizeof drop, .json = kDrop};
    CHECK(rivulet_world_create(context, &drop, &world, &why) == RIVULET_FAILED && why.message[0] != '\0' && world == NULL);
    rivulet_context_destroy(context);
    printf("%s\n", failures == 0 ? "all holds" : "something does not hold");
    return failures == 0 ? 0 : 1;
}
