/* Skins above water, objects that float, answers that come later: rivulet.h from C on the cpu. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdlib.h>

#include "pool.h"

/* A plate across z, from (x0, y0) to (x0 + 0.4, y0 + 0.2) m, of 21 x 11 vertices. */
enum { COLUMNS = 21, ROWS = 11, VERTICES = COLUMNS * ROWS, INDICES = 6 * (COLUMNS - 1) * (ROWS - 1) };
typedef struct plate {
    float positions[3 * VERTICES], uvs[2 * VERTICES];
    uint32_t indices[INDICES];
} plate;
static void place(plate* p, float x0, float y0, float z) {
    uint32_t* index = p->indices;
    for (uint32_t row = 0; row < ROWS; ++row) {
        for (uint32_t column = 0; column < COLUMNS; ++column) {
            const uint32_t k = row * COLUMNS + column;
            const float u = (float)column / (COLUMNS - 1), v = (float)row / (ROWS - 1);
            const float at[3] = {x0 + 0.4F * u, y0 + 0.2F * v, z};
            memcpy(p->positions + 3 * k, at, sizeof at);
            p->uvs[2 * k] = u;
            p->uvs[2 * k + 1] = v;
            if (row + 1 == ROWS || column + 1 == COLUMNS) continue;
            const uint32_t quad[6] = {k, k + 1, k + COLUMNS, k + 1, k + COLUMNS + 1, k + COLUMNS};
            memcpy(index, quad, sizeof quad);
            index += 6;
        }
    }
}
static rivulet_skin* skin_of(rivulet_context* context, const plate* p) {
    const rivulet_mesh mesh = {.size = sizeof mesh,
                               .positions = p->positions,
                               .vertices = VERTICES,
                               .indices = p->indices,
                               .indices_count = INDICES,
                               .uvs = p->uvs};
    /* Nothing holds a drop and no film stays behind: all that is added falls off the lower edge. */
    const rivulet_skin_options options = {.size = sizeof options, .mesh = &mesh, .json = "{\"hold\": 0, \"trail\": 0}", .map_size = 64};
    rivulet_skin* skin = NULL;
    DONE(rivulet_skin_create(context, &options, &skin, &why));
    return skin;
}

static uint32_t particles(rivulet_world* world) {
    rivulet_stats stats = {.size = sizeof stats};
    DONE(rivulet_world_stats(world, &stats, &why));
    return stats.particles;
}

/* Drops run off a plate, fall for as long as a stone does and become particles of the pool, and not a picolitre is lost. */
static void falls_into_water(rivulet_context* context) {
    const char* json =
        "{\"fluid\": {\"spacing\": 0.01, \"box\": {\"min\": [0, 0, 0], \"max\": [0.5, 1, 0.16]},"
        "\"blocks\": [{\"min\": [0, 0, 0], \"max\": [0.5, 0.1, 0.16]}]}}";
    const rivulet_world_options options = {.size = sizeof options, .json = json, .skins_bring = 1e-5};
    rivulet_world* world = NULL;
    DONE(rivulet_world_create(context, &options, &world, &why));
    plate p;
    place(&p, 0.05F, 0.6F, 0.1F);
    rivulet_skin* skin = skin_of(context, &p);
    for (int k = 0; k < 100; ++k) {
        const float at[3] = {0.07F + 0.0036F * (float)k, 0.62F, 0.1F};
        DONE(rivulet_skin_add(skin, at, 25, &why));
    }
    const uint32_t before = particles(world);
    const double step = 1.0 / 60;
    double first = -1, landed = -1;
    rivulet_air air = {.size = sizeof air};
    for (int frame = 0; frame < 45; ++frame) {
        DONE(rivulet_world_step(world, NULL, step, &why));
        DONE(rivulet_world_step_skins(world, &skin, NULL, 1, step, &air, &why));
        size_t count = 0;
        float drops[4 * 4] = {0};
        DONE(rivulet_world_air_drops(world, drops, 4, &count, &why));
        CHECK(count == air.drops && (count == 0 || (drops[3] > 0.0001F && drops[3] < 0.003F)));
        if (first < 0 && air.drops > 0) first = frame * step;
        if (landed < 0 && air.into_water > 0) landed = frame * step;
        rivulet_skin_stats s = {.size = sizeof s};
        DONE(rivulet_skin_stats_of(skin, &s, &why));
        CHECK(fabs(s.added - s.on_skin - s.left - s.evaporated) < 1e-14);
        CHECK(fabs(s.left - air.in_air - air.into_water - air.lost) < 1e-13);
    }
    /* 0.5 m from the edge to the water: 0.32 s; the edge is left at up to 0.4 m/s, and a frame is 0.017 s. */
    CHECK(first > 0 && landed - first > 0.27 && landed - first < 0.34);
    CHECK(air.into_water > 2.4e-6 && air.lost == 0);
    const double born = (particles(world) - before) * 1e-6; /* m^3 */
    CHECK(born <= air.into_water + 1e-12 && born > air.into_water - 0.6e-6);

    rivulet_skin* twice[2] = {skin, skin};
    REFUSED(rivulet_world_step_skins(world, twice, NULL, 2, step, NULL, &why), "skins[1] is there twice");
    REFUSED(rivulet_world_step_skins(world, NULL, NULL, 1, step, NULL, &why), "at least one skin");
    place(&p, 0.05F, 0.8F, 0.1F);
    rivulet_skin* other = skin_of(context, &p);
    /* Skins come and go: what is in the air of one that is gone is lost, and counted. */
    DONE(rivulet_skin_add(skin, (const float[3]){0.2F, 0.61F, 0.1F}, 25, &why));
    for (int frame = 0; frame < 40 && air.in_air == 0; ++frame)
        DONE(rivulet_world_step_skins(world, (rivulet_skin* [2]){skin, other}, NULL, 2, step, &air, &why));
    const double lost = air.lost, flying = air.in_air;
    CHECK(flying > 0);
    DONE(rivulet_world_step_skins(world, &other, NULL, 1, step, &air, &why));
    CHECK(air.drops == 0 && fabs(air.lost - lost - flying) < 1e-15);
    rivulet_air wrong = {.size = sizeof wrong, .floor = NAN};
    REFUSED(rivulet_world_step_skins(world, &skin, NULL, 1, step, &wrong, &why), "air.floor is not finite");
    rivulet_skin_destroy(other);
    rivulet_skin_destroy(skin);
    rivulet_world_destroy(world);
}

/* A drop is added where the skin is now: the plate was moved along x by its vertices, and the drop leaves it below that place. */
static void picks_on_the_bent_mesh(rivulet_context* context) {
    const rivulet_world_options options = {.size = sizeof options, .json = "{\"fluid\": {\"spacing\": 0.05}}"};
    rivulet_world* world = NULL;
    DONE(rivulet_world_create(context, &options, &world, &why));
    plate p, moved;
    place(&p, 0.0F, 0.6F, 0.0F);
    place(&moved, 0.1F, 0.6F, 0.0F);
    rivulet_skin* skin = skin_of(context, &p);
    const rivulet_skin_inputs inputs = {.size = sizeof inputs, .positions = moved.positions};
    rivulet_air air = {.size = sizeof air, .floor = -100};
    DONE(rivulet_world_step_skins(world, &skin, &inputs, 1, 0.01, &air, &why));
    DONE(rivulet_skin_add(skin, (const float[3]){0.45F, 0.62F, 0}, 25, &why));
    size_t count = 0;
    float drop[4] = {0};
    for (int frame = 0; frame < 100 && count == 0; ++frame) {
        DONE(rivulet_world_step_skins(world, &skin, &inputs, 1, 0.01, &air, &why));
        DONE(rivulet_world_air_drops(world, drop, 1, &count, &why));
    }
    CHECK(count == 1 && fabsf(drop[0] - 0.45F) < 0.005F); /* at rest the nearest point was x = 0.4, which now is 0.5 */
    rivulet_skin_destroy(skin);
    rivulet_world_destroy(world);
}

static rivulet_sample kept[3];
static int calls;
static rivulet_status inside;
static void keep(void* user, const rivulet_sample* samples, size_t count) {
    ++calls;
    CHECK(count == 3);
    memcpy(kept, samples, sizeof kept);
    rivulet_error ignored;
    inside = rivulet_world_reset((rivulet_world*)user, &ignored);
}

static void floats_and_later_answers(rivulet_context* context) {
    const char* json =
        "{\"fluid\": {\"spacing\": 0.02, \"box\": {\"min\": [0, 0, 0], \"max\": [0.4, 0.6, 0.4]},"
        "\"blocks\": [{\"min\": [0, 0, 0], \"max\": [0.4, 0.4, 0.4]}]}}";
    const rivulet_world_options options = {.size = sizeof options, .json = json};
    rivulet_world* world = NULL;
    DONE(rivulet_world_create(context, &options, &world, &why));
    const float places[9] = {0.2F, 0.2F, 0.2F, 0.2F, 0.4F, 0.2F, 0.2F, 0.55F, 0.2F};
    rivulet_sample samples[3];
    DONE(rivulet_world_sample(world, places, 3, samples, &why));
    DONE(rivulet_world_sample_later(world, places, 3, keep, world, &why));
    CHECK(calls == 1 && memcmp(kept, samples, sizeof kept) == 0);
    CHECK(inside == RIVULET_BAD_INPUT);
    REFUSED(rivulet_world_sample_later(world, places, 3, NULL, NULL, &why), "then is NULL");

    /* Ten litres under water are lifted by the weight of ten litres, wherever their points are; a point off the centre gives a torque. */
    const float points[6] = {-0.05F, 0, 0, 0.05F, 0, 0}, volumes[2] = {0.004F, 0.006F};
    rivulet_float f[2] = {{.size = sizeof f[0], .points = points, .volumes = volumes, .points_count = 2, .mass = 5}};
    f[0].state.pose.position[0] = f[0].state.pose.position[1] = f[0].state.pose.position[2] = 0.2F;
    f[1] = f[0];
    f[1].state.pose.position[1] = 0.55F;
    rivulet_body_load loads[2];
    DONE(rivulet_world_buoyancy(world, f, 2, NULL, 0.01, loads, &why));
    CHECK(fabs(loads[0].force[1] / (10 * 9.81) - 1) < 0.05 /* the lattice's density is sampled beside its centres */);
    CHECK(fabs(loads[0].torque[2] / (0.05 * 2 * 9.81) - 1) < 0.1);
    CHECK(loads[1].force[1] == 0);
    const double lift = loads[0].force[1];
    f[0].quadratic_drag = 1; /* C rho A u^2 / 2, A = V^(2/3), of which the points have 0.4 and 0.6: 1 m/s upwards */
    f[0].state.velocity[1] = 1;
    DONE(rivulet_world_buoyancy(world, f, 1, NULL, 1e-4, loads, &why));
    CHECK(fabs((lift - loads[0].force[1]) / (0.5 * 1000 * pow(0.01, 2.0 / 3)) - 1) < 0.06);
    f[0].mass = 0;
    REFUSED(rivulet_world_buoyancy(world, f, 1, NULL, 0.01, loads, &why), "floats[0].mass is 0 kg");
    f[0].mass = 5;
    f[0].points = NULL;
    REFUSED(rivulet_world_buoyancy(world, f, 1, NULL, 0.01, loads, &why), "floats[0] has no points");
    rivulet_world_destroy(world);
}

/* Lines of each part, and what they enclose. */
typedef struct drawn {
    int lines[6];
    float low[6][3], high[6][3], most; /* most: of index */
} drawn;
static void draw_line(void* user, int32_t part, size_t index, const float* from, const float* to) {
    drawn* d = user;
    if (d->lines[part]++ == 0)
        for (int a = 0; a < 3; ++a) d->low[part][a] = d->high[part][a] = from[a];
    for (int a = 0; a < 3; ++a) {
        d->low[part][a] = fminf(d->low[part][a], fminf(from[a], to[a]));
        d->high[part][a] = fmaxf(d->high[part][a], fmaxf(from[a], to[a]));
    }
    d->most = fmaxf(d->most, (float)index);
}
static int near(const float* a, float x, float y, float z) {
    return fabsf(a[0] - x) < 1e-4F && fabsf(a[1] - y) < 1e-4F && fabsf(a[2] - z) < 1e-4F;
}
static void parts_as_lines(rivulet_context* context) {
    /* The nozzle's water leaves at 1 l/s through 0.1 m: 0.12732 m/s, 0.012732 m in a tenth of a second. */
    const char* json =
        "{\"fluid\": {\"spacing\": 0.05, \"probes\": [{\"name\": \"low\", \"max\": [1, 0.25, 1]}]},"
        "\"emitters\": [{\"position\": [0.5, 0.8, 0.5], \"radius\": 0.05},"
        "{\"shape\": \"box\", \"position\": [0.5, 0.8, 0.5], \"size\": [0.2, 0.2, 0.2]}],"
        "\"sinks\": [{\"shape\": \"sphere\", \"position\": [0.5, 0.2, 0.5], \"radius\": 0.1}]}";
    const float sample[3] = {0, 0, 0};
    const rivulet_body body = {.size = sizeof body,
                               .samples = sample,
                               .samples_count = 1,
                               .mass = 1,
                               .inertia = {1, 1, 1},
                               .volume = 0.001F,
                               .pose = {{0.3F, 0.4F, 0.5F}, {0, 0, 0, 0}}};
    const rivulet_world_options options = {.size = sizeof options, .json = json, .bodies = &body, .bodies_count = 1};
    rivulet_world* world = NULL;
    DONE(rivulet_world_create(context, &options, &world, &why));
    drawn d = {{0}, {{0}}, {{0}}, 0};
    DONE(rivulet_world_lines(world, draw_line, &d, &why));
    CHECK(d.lines[RIVULET_PART_BOX] == 12 && near(d.low[0], 0, 0, 0) && near(d.high[0], 1, 1, 1));
    CHECK(d.lines[RIVULET_PART_EMITTER] == 24 + 1 + 12 && near(d.low[1], 0.4F, 0.7F, 0.4F) && near(d.high[1], 0.6F, 0.9F, 0.6F));
    CHECK(d.lines[RIVULET_PART_SINK] == 3 * 24 && near(d.low[2], 0.4F, 0.1F, 0.4F) && near(d.high[2], 0.6F, 0.3F, 0.6F));
    CHECK(d.lines[RIVULET_PART_PROBE] == 12 && near(d.low[3], 0, 0, 0) && near(d.high[3], 1, 0.25F, 1));
    CHECK(d.lines[RIVULET_PART_WALL] == 0);
    CHECK(d.lines[RIVULET_PART_BODY] == 3 && near(d.low[5], 0.3F, 0.4F, 0.5F) && near(d.high[5], 0.5F, 0.6F, 0.7F));
    CHECK(d.most == 1);
    REFUSED(rivulet_world_lines(world, NULL, NULL, &why), "line is NULL");
    rivulet_world_destroy(world);
}

static double height(rivulet_world* world, float* lowest) {
    const size_t count = count_of(world);
    double sum = 0;
    *lowest = 1e9F;
    for (size_t k = 0; k < count; ++k) {
        sum += positions[3 * k + 1];
        *lowest = fminf(*lowest, positions[3 * k + 1]);
    }
    return sum / (double)count;
}

/* A floor that deforms carries water: raised by 0.1 m, its middle first, it lifts the water by as much. */
static void a_floor_that_deforms_lifts_water(rivulet_context* context) {
    enum { N = 11 };
    float rest[3 * N * N], now[3 * N * N];
    uint32_t indices[6 * (N - 1) * (N - 1)], *index = indices;
    for (uint32_t row = 0; row < N; ++row)
        for (uint32_t column = 0; column < N; ++column) {
            const uint32_t k = row * N + column;
            const float at[3] = {-0.05F + 0.05F * (float)column, 0.08F, -0.05F + 0.05F * (float)row};
            memcpy(rest + 3 * k, at, sizeof at);
            if (row + 1 == N || column + 1 == N) continue;
            const uint32_t quad[6] = {k, k + N, k + 1, k + 1, k + N, k + N + 1};
            memcpy(index, quad, sizeof quad);
            index += 6;
        }
    const rivulet_mesh floor = {.size = sizeof floor,
                                .positions = rest,
                                .vertices = N * N,
                                .indices = indices,
                                .indices_count = 6 * (N - 1) * (N - 1),
                                .friction = -1,
                                .restitution = -1,
                                .moves = 2,
                                .reach_low = {-0.1F, 0, -0.1F},
                                .reach_high = {0.5F, 0.3F, 0.5F}};
    const char* json =
        "{\"fluid\": {\"spacing\": 0.02, \"box\": {\"min\": [0, 0, 0], \"max\": [0.4, 0.6, 0.4]},"
        "\"blocks\": [{\"min\": [0, 0.1, 0], \"max\": [0.4, 0.26, 0.4]}]}}";
    const rivulet_world_options options = {.size = sizeof options, .json = json, .walls = &floor, .walls_count = 1};
    rivulet_world* world = NULL;
    DONE(rivulet_world_create(context, &options, &world, &why));
    float low = 0;
    const float* shape = rest;
    rivulet_inputs in = {.size = sizeof in, .shapes = &shape, .shapes_count = 1};
    for (int frame = 0; frame < 30; ++frame) DONE(rivulet_world_step(world, &in, 1.0 / 60, &why));
    const double before = height(world, &low);
    CHECK(low > 0.08F);
    for (int frame = 1; frame <= 90; ++frame) {
        memcpy(now, rest, sizeof now);
        for (int k = 0; k < N * N; ++k) {
            const float x = rest[3 * k] - 0.2F, z = rest[3 * k + 2] - 0.2F;
            const float share = fminf(fmaxf((float)frame / 60 - (x * x + z * z), 0), 1);
            now[3 * k + 1] += 0.1F * share;
        }
        shape = now;
        DONE(rivulet_world_step(world, &in, 1.0 / 60, &why));
    }
    const double after = height(world, &low);
    CHECK(fabs(after - before - 0.1) < 0.01 && low > 0.18F);
    shape = NULL; /* stays */
    DONE(rivulet_world_step(world, &in, 1.0 / 60, &why));
    CHECK(fabs(height(world, &low) - after) < 0.005);
    in.shapes_count = 2;
    REFUSED(rivulet_world_step(world, &in, 1.0 / 60, &why), "2 shapes were given for 1 walls that deform");
    in.shapes_count = 1;
    now[1] = 5;
    shape = now;
    CHECK(rivulet_world_step(world, &in, 1.0 / 60, &why) == RIVULET_BAD_INPUT);
    DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    DONE(rivulet_world_reset(world, &why));
    DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
    CHECK(fabs(height(world, &low) - 0.18) < 0.01);
    uint32_t id = 0;
    int32_t state = RIVULET_WALL_BAKES;
    DONE(rivulet_world_add_wall(world, &floor, &id, &why));
    CHECK(id == 1);
    while (state == RIVULET_WALL_BAKES) {
        wait_a_little(world, 0);
        DONE(rivulet_world_wall(world, id, &state, &why));
    }
    CHECK(state == RIVULET_WALL_ACTS);
    DONE(rivulet_world_remove_wall(world, id, &why));
    DONE(rivulet_world_remove_wall(world, 0, &why));
    run(world, 60);
    CHECK(height(world, &low) < 0.13 && low < 0.03F); /* on the box's floor: 0.08 when at rest */
    rivulet_world_destroy(world);
}

int main(void) {
    rivulet_context* context = cpu_context();
    falls_into_water(context);
    picks_on_the_bent_mesh(context);
    floats_and_later_answers(context);
    parts_as_lines(context);
    a_floor_that_deforms_lifts_water(context);
    rivulet_context_destroy(context);
    printf("couple: %d failures\n", failures);
    return failures > 0;
}
