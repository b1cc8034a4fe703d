/* Bodies that come and go while a world runs. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>

#include "pool.h"

/* A box of 12 triangles about a centre that is not the origin of its frame. */
static const float kCentre[3] = {0.02F, -0.01F, 0.03F};
static float corners[24];
static rivulet_mesh box_of(float width, float height) {
    for (int k = 0; k < 8; ++k)
        for (int axis = 0; axis < 3; ++axis)
            corners[3 * k + axis] = kCentre[axis] + ((k >> axis & 1) != 0 ? 0.5F : -0.5F) * (axis == 1 ? height : width);
    return (rivulet_mesh){.size = sizeof(rivulet_mesh), .positions = corners, .vertices = 8, .indices = kTriangles, .indices_count = 36};
}
static rivulet_body crate_of(const rivulet_mesh* mesh, float x, float y, float z) {
    return (rivulet_body){.size = sizeof(rivulet_body), .mesh = mesh, .density = 500, .pose = {{x, y, z}, {0, 0, 0, 0}}};
}

static rivulet_world* pool(rivulet_context* context, const char* more, const rivulet_body_host* host) {
    char json[512];
    snprintf(
        json, sizeof json,
        "{\"fluid\": {\"method\": \"pbf\", \"spacing\": 0.025, \"box\": {\"max\": [0.5, 0.8, 0.5]}, \"bodies\": {\"maxSamples\": 1500}%s, "
        "\"blocks\": "
        "[{\"max\": [0.5, 0.2, 0.5]}]}}",
        more);
    rivulet_world* world = NULL;
    const rivulet_world_options o = {.size = sizeof o, .json = json, .body_host = host};
    DONE(rivulet_world_create(context, &o, &world, &why));
    return world;
}
static void wait_for(rivulet_world* world, uint32_t id) {
    int32_t inside = 0;
    for (;;) {
        DONE(rivulet_world_body(world, id, &inside, NULL, NULL, &why));
        if (inside) return;
        wait_a_little(world, 0); /* it arrives, and no time passes */
    }
}

/* A crate, given as a mesh and a density, floats half under water. Its state is that of the mesh's frame, and its load its weight. */
static void a_crate_floats(rivulet_context* context) {
    rivulet_world* world = pool(context, "", NULL);
    run(world, 2);
    const rivulet_mesh mesh = box_of(0.25F, 0.15F);
    rivulet_body crate = crate_of(&mesh, 0.25F - kCentre[0], 0.35F, 0.25F - kCentre[2]);
    crate.velocity[1] = -0.5F;
    uint32_t id = 9;
    DONE(rivulet_world_add_body(world, &crate, &id, &why));
    CHECK(id == 0);
    int32_t inside = 9;
    rivulet_body_state state = {0}, states[2];
    rivulet_body_load load = {0};
    wait_for(world, id);
    DONE(rivulet_world_body(world, id, &inside, &state, NULL, &why));
    CHECK(inside == 1 && fabsf(state.velocity[1] + 0.5F) < 1.0e-6F && fabsf(state.pose.position[1] - 0.35F) < 1.0e-6F);
    CHECK(fabsf(state.pose.position[0] - crate.pose.position[0]) < 1.0e-5F && fabsf(state.pose.rotation[3]) > 0.9999F);
    const size_t before = count_of(world);
    run(world, 90);
    double under = 0, lift = 0;
    for (int k = 0; k < 60; ++k) {
        run(world, 1);
        DONE(rivulet_world_body(world, id, NULL, &state, &load, &why));
        /* (keel + under) * area = water + under * base */
        const double keel = state.pose.position[1] + kCentre[1] - 0.075, base = 0.25 * 0.25, area = 0.5 * 0.5;
        under += ((double)before * 0.025 * 0.025 * 0.025 - area * keel) / (area - base) / 60;
        lift += load.force[1] / 60;
    }
    const double weight = 500 * 9.81 * 0.25 * 0.25 * 0.15;
    CHECK(fabs(under - 0.075) < 0.025); /* a spacing: it sways, and is 6 of them high */
    CHECK(fabs(lift - weight) < 0.05 * weight);
    CHECK(count_of(world) == before);
    size_t count = 0;
    uint32_t ids[2] = {9, 9};
    DONE(rivulet_world_body_ids(world, ids, 2, &count, &why));
    CHECK(count == 1 && ids[0] == 0);
    DONE(rivulet_world_bodies(world, states, 1, &why));
    CHECK(states[0].pose.position[1] == state.pose.position[1]);
    DONE(rivulet_world_reset(world, &why));
    DONE(rivulet_world_body(world, id, NULL, &state, NULL, &why));
    CHECK(fabsf(state.pose.position[1] - 0.35F) < 1.0e-5F);
    DONE(rivulet_world_remove_body(world, id, &why));
    DONE(rivulet_world_body_ids(world, NULL, 0, &count, &why));
    CHECK(count == 0);
    REFUSED(rivulet_world_remove_body(world, id, &why), "no body 0");
    rivulet_world_destroy(world);
}

/* Twenty one after another, some still being made ready when they are removed; ids do not repeat. */
static void many_come_and_go(rivulet_context* context) {
    rivulet_world* world = pool(context, ", \"sleep\": {\"on\": true}", NULL);
    const rivulet_mesh mesh = box_of(0.05F, 0.05F);
    uint32_t id = 0;
    for (uint32_t k = 0; k < 20; ++k) {
        const rivulet_body crate = crate_of(&mesh, 0.08F + 0.08F * (float)(k % 5), 0.4F, 0.08F + 0.1F * (float)(k / 5 % 4));
        DONE(rivulet_world_add_body(world, &crate, &id, &why));
        CHECK(id == k);
        run(world, 1);
        if (k % 4 == 3) DONE(rivulet_world_remove_body(world, k, &why));
    }
    for (uint32_t k = 0; k < 20; ++k)
        if (k % 4 != 3) wait_for(world, k);
    size_t count = 0;
    DONE(rivulet_world_body_ids(world, NULL, 0, &count, &why));
    CHECK(count == 15);
    run(world, 20);
    rivulet_stats stats = {.size = sizeof stats};
    DONE(rivulet_world_stats(world, &stats, &why));
    CHECK(stats.lost == 0 && stats.maximum_speed < 10);
    rivulet_world_destroy(world);
}

/* The water makes room for what appears in it; what the water does not meet falls through it. */
static void water_makes_room(rivulet_context* context) {
    rivulet_world* world = pool(context, ", \"collision\": {\"meets\": 1}", NULL);
    run(world, 10);
    const size_t before = count_of(world);
    const rivulet_mesh mesh = box_of(0.2F, 0.1F);
    rivulet_body crate = crate_of(&mesh, 0.25F, 0.1F, 0.25F);
    uint32_t id = 0, ghost = 0;
    crate.layers = 2;
    DONE(rivulet_world_add_body(world, &crate, &ghost, &why));
    wait_for(world, ghost);
    run(world, 1);
    CHECK(count_of(world) == before);
    rivulet_body_load load = {{1, 1, 1}, {1, 1, 1}};
    rivulet_body_state state = {0};
    DONE(rivulet_world_body(world, ghost, NULL, &state, &load, &why));
    CHECK(load.force[1] == 0 && state.velocity[1] < -0.1F);
    crate.layers = 0;
    DONE(rivulet_world_add_body(world, &crate, &id, &why));
    wait_for(world, id);
    const double gone = (double)(before - count_of(world)) * 0.025 * 0.025 * 0.025, volume = 0.2 * 0.2 * 0.1;
    CHECK(fabs(gone - volume) < 0.25 * volume); /* each face within a quarter of a spacing */
    rivulet_world_destroy(world);
}

/* Without memory for samples. */
static void no_water_meets_it(rivulet_context* context) {
    rivulet_world* world = NULL;
    const rivulet_world_options o = {
        .size = sizeof o,
        .json = "{\"fluid\": {\"spacing\": 0.05, \"box\": {\"max\": [0.5, 0.8, 0.5]}, \"blocks\": [{\"max\": [0.5, 0.2, 0.5]}]}}"};
    DONE(rivulet_world_create(context, &o, &world, &why));
    const rivulet_mesh mesh = box_of(0.1F, 0.1F);
    rivulet_body crate = crate_of(&mesh, 0.25F, 0.5F, 0.25F);
    uint32_t id = 0;
    crate.layers = crate.meets = 2;
    DONE(rivulet_world_add_body(world, &crate, &id, &why));
    wait_for(world, id);
    run(world, 6);
    rivulet_body_state state = {0};
    DONE(rivulet_world_body(world, id, NULL, &state, NULL, &why));
    CHECK(fabsf(state.velocity[1] + 0.981F) < 0.01F);
    rivulet_world_destroy(world);
}

struct engine {
    rivulet_world* world;
    uint32_t added, removed;
    size_t most;
    int refused;
    float y;
};
static void on_advance(void* user, const rivulet_body_load* loads, const float* gravity, double seconds, rivulet_body_state* states,
                       size_t count) {
    struct engine* e = user;
    (void)loads;
    (void)gravity;
    (void)seconds;
    if (count > e->most) e->most = count;
    for (size_t k = 0; k < count; ++k) states[k].pose.position[1] = 0.5F;
    e->refused += rivulet_world_remove_body(e->world, 0, NULL) == RIVULET_BAD_INPUT;
}
static void on_reset(void* user, const rivulet_body_state* states, size_t count) {
    (void)user;
    (void)states;
    (void)count;
}
static void on_added(void* user, uint32_t id, const rivulet_body_state* state) {
    struct engine* e = user;
    e->added += 1 + id;
    e->y = state->pose.position[1];
}
static void on_removed(void* user, uint32_t id) { ((struct engine*)user)->removed += 1 + id; }

/* The host's engine is told of a body when it is in the world, and moves it in the frame of its mesh. */
static void the_host_moves_them(rivulet_context* context) {
    struct engine engine = {0};
    const rivulet_body_host host = {
        .size = sizeof host, .user = &engine, .advance = on_advance, .reset = on_reset, .added = on_added, .removed = on_removed};
    rivulet_world* world = pool(context, "", &host);
    engine.world = world;
    const rivulet_mesh mesh = box_of(0.1F, 0.1F);
    const rivulet_body crate = crate_of(&mesh, 0.25F, 0.4F, 0.25F);
    uint32_t id = 0;
    DONE(rivulet_world_add_body(world, &crate, &id, &why));
    wait_for(world, id);
    run(world, 1);
    CHECK(engine.added == 1 && engine.most == 1 && engine.refused > 0 && fabsf(engine.y - 0.4F) < 1.0e-5F);
    rivulet_body_state state;
    DONE(rivulet_world_body(world, id, NULL, &state, NULL, &why));
    CHECK(fabsf(state.pose.position[1] - 0.5F) < 1.0e-5F);
    DONE(rivulet_world_remove_body(world, id, &why));
    CHECK(engine.removed == 1);
    rivulet_world_destroy(world);
}

/* An engine of balls of one radius, over a floor at the height y, which may move. */
struct balls {
    float radius, y;
    float velocity[3], spin[3], centre[3]; /* of the floor */
    int asked, passed, moved, predicted;
    void (*spoil)(rivulet_body_contact* contact); /* NULL: the contacts are right */
    int none;                                     /* NULL is added instead */
    rivulet_add_contact add;
    void* to;
};
static int32_t touch_floor(void* user, const rivulet_body_state* states, const float* balls, size_t count, double seconds,
                           rivulet_add_contact add, void* to) {
    const struct balls* e = user;
    (void)seconds;
    for (size_t k = 0; k < count; ++k) {
        if (balls[4 * k + 1] - balls[4 * k + 3] > e->y + e->radius) continue; /* it cannot be so low in this frame */
        const rivulet_body_contact floor = {.size = sizeof floor,
                                            .a = (uint32_t)k,
                                            .b = RIVULET_SOLID,
                                            .on_b = {states[k].pose.position[0], e->y, states[k].pose.position[2]},
                                            .radius_a = e->radius,
                                            .normal = {0, 1, 0},
                                            .friction = 0.4F};
        add(to, &floor);
    }
    return 1;
}
/* The same, of a floor that moves, or spoilt. */
static void add_spoilt(void* user, const rivulet_body_contact* contact) {
    const struct balls* e = user;
    rivulet_body_contact spoilt = *contact;
    memcpy(spoilt.velocity_b, e->velocity, sizeof e->velocity);
    memcpy(spoilt.spin_b, e->spin, sizeof e->spin);
    memcpy(spoilt.centre_b, e->centre, sizeof e->centre);
    spoilt.seconds_b = 1.0 / 60;
    if (e->spoil != NULL) e->spoil(&spoilt);
    e->add(e->to, e->none ? NULL : &spoilt);
}
static int32_t touch_moving_floor(void* user, const rivulet_body_state* states, const float* balls, size_t count, double seconds,
                                  rivulet_add_contact add, void* to) {
    struct balls* e = user;
    e->asked += seconds > 0;
    e->add = add;
    e->to = to;
    return touch_floor(user, states, balls, count, seconds, add_spoilt, e);
}
static void count_passed(void* user, double seconds) { ((struct balls*)user)->passed += seconds > 0; }
static void stay_there(void* user, const rivulet_body_load* loads, const float* gravity, double seconds, rivulet_body_state* states,
                       size_t count) {
    (void)loads, (void)gravity, (void)seconds, (void)states, (void)count;
    ++((struct balls*)user)->moved;
}
static void expect_on_floor(void* user, const rivulet_body_load* loads, const float* gravity, double from, double seconds,
                            rivulet_body_state* states, size_t count) {
    struct balls* e = user;
    e->predicted += seconds > 0 && from <= 0.02 && gravity[1] < -9 && loads[0].force[1] > -1;
    for (size_t k = 0; k < count; ++k) {
        float* y = &states[k].pose.position[1];
        *y += states[k].velocity[1] * (float)seconds;
        if (*y > e->y + e->radius) continue;
        *y = e->y + e->radius;
        states[k].velocity[1] = 0;
    }
}
static void forget(void* user, const rivulet_body_state* states, size_t count) { (void)user, (void)states, (void)count; }

static void with_itself(rivulet_body_contact* c) { c->b = c->a; }
static void of_another(rivulet_body_contact* c) { c->a = 5; }
static void with_another(rivulet_body_contact* c) { c->b = 1; }
static void of_solids(rivulet_body_contact* c) { c->a = RIVULET_SOLID; }
static void of_a_solid(rivulet_body_contact* c) { c->a = RIVULET_SOLID, c->b = 0; }
static void short_normal(rivulet_body_contact* c) { c->normal[1] = 0.5F; }
static void no_place(rivulet_body_contact* c) { c->on_b[0] = NAN; }
static void far_centre(rivulet_body_contact* c) { c->centre_b[2] = 1.0e8F; }
static void no_radius(rivulet_body_contact* c) { c->radius_a = -0.1F; }
static void fast(rivulet_body_contact* c) { c->velocity_b[0] = 1.0e8F; }
static void no_spin(rivulet_body_contact* c) { c->spin_b[1] = INFINITY; }
static void before_it(rivulet_body_contact* c) { c->seconds_b = -1; }
static void no_friction(rivulet_body_contact* c) { c->friction = -0.1F; }
static void gains(rivulet_body_contact* c) { c->restitution = 1.1F; }
static void no_size(rivulet_body_contact* c) { c->size = 0; }

/* A contact that cannot be is named by the step; in its frame the ball stays, and the water goes on. */
static void contacts_are_checked(rivulet_world* world, struct balls* engine) {
    static const struct {
        void (*spoil)(rivulet_body_contact* contact);
        const char* words;
    } kinds[] = {{with_itself, "a contact of body 0 with itself"},
                 {of_another, "a contact of body 5, and there are 1"},
                 {with_another, "a contact of body 1, and there are 1"},
                 {of_solids, "a contact of two solids"},
                 {of_a_solid, "a contact whose a is RIVULET_SOLID"},
                 {short_normal, "normal is not a unit vector"},
                 {no_place, "on_a, on_b or centre_b is not finite"},
                 {far_centre, "on_a, on_b or centre_b is not finite, or beyond"},
                 {no_radius, "radius_a or radius_b is not from 0"},
                 {fast, "velocity_b or spin_b is not finite, or more than"},
                 {no_spin, "velocity_b or spin_b is not finite"},
                 {before_it, "seconds_b is not from 0"},
                 {no_friction, "friction is not from 0"},
                 {gains, "restitution is not from 0 to 1"},
                 {no_size, "size is 0: set it to sizeof(rivulet_body_contact)"},
                 {NULL, "a contact that is NULL"}};
    rivulet_stats stats = {.size = sizeof stats};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k) {
        rivulet_body_state before, after;
        DONE(rivulet_world_bodies(world, &before, 1, &why));
        DONE(rivulet_world_stats(world, &stats, &why));
        const double time = stats.time;
        engine->spoil = kinds[k].spoil;
        engine->none = kinds[k].spoil == NULL;
        memset(&why, 0, sizeof why);
        const rivulet_status status = rivulet_world_step(world, NULL, 1.0 / 60, &why);
        if (status != RIVULET_FAILED || strstr(why.message, kinds[k].words) == NULL ||
            strstr(why.message, "; the bodies stay where they are") == NULL) {
            ++failures;
            printf("not refused with '%s': %s\n", kinds[k].words, why.message);
        }
        engine->spoil = NULL;
        engine->none = 0;
        DONE(rivulet_world_bodies(world, &after, 1, &why));
        CHECK(memcmp(&before, &after, sizeof before) == 0);
        DONE(rivulet_world_stats(world, &stats, &why));
        CHECK(fabs(stats.time - time - 1.0 / 60) < 1e-9);
        const int passed = engine->passed;
        run(world, 1);
        CHECK(engine->passed > passed);
    }
}

/* On a GPU the library moves a ball by the contacts that the host names: it sinks, lies on the floor, and is carried by it; first by its
   velocity, then by its spin about a point 2 m beside the ball. advance is never called. */
static void a_gpu_moves_them_by_the_hosts_contacts(void) {
    rivulet_context_options options = {.size = sizeof options, .backend = "cl"};
    rivulet_context* context = NULL;
    if (rivulet_context_create(&options, &context, &why) != RIVULET_OK) {
        printf("no device of OpenCL: %s\n", why.message);
        return;
    }
    struct balls engine = {.radius = 0.08F};
    rivulet_body_host host = {.size = sizeof host, .user = &engine, .contacts = touch_moving_floor, .predict = expect_on_floor};
    enum { N = 160 };
    float samples[3 * N];
    for (int k = 0; k < N; ++k) { /* evenly on a sphere */
        const float y = 1 - (2 * (float)k + 1) / N, r = sqrtf(1 - y * y), turn = 2.3999632F * (float)k, inside = engine.radius - 0.0125F;
        samples[3 * k] = inside * r * cosf(turn);
        samples[3 * k + 1] = inside * y;
        samples[3 * k + 2] = inside * r * sinf(turn);
    }
    const float mass = 5.4F, inertia = 0.4F * mass * engine.radius * engine.radius;
    const rivulet_body ball = {.size = sizeof ball,
                               .samples = samples,
                               .samples_count = N,
                               .mass = mass,
                               .inertia = {inertia, inertia, inertia},
                               .volume = 0.00214F,
                               .pose = {{0.25F, 0.2F, 0.25F}, {0, 0, 0, 0}}};
    const char* json =
        "{\"fluid\": {\"method\": \"pbf\", \"spacing\": 0.025, \"box\": {\"max\": [0.5, 0.8, 0.5]},"
        " \"blocks\": [{\"max\": [0.5, 0.1, 0.5]}]}}";
    const rivulet_world_options o = {.size = sizeof o, .json = json, .bodies = &ball, .bodies_count = 1, .body_host = &host};
    rivulet_world* world = NULL;
    REFUSED(rivulet_world_create(context, &o, &world, &why), "contacts and passed: give both or neither");
    host.passed = count_passed;
    REFUSED(rivulet_world_create(context, &o, &world, &why), "has contacts, passed, predict, and neither advance nor reset");
    host.advance = stay_there;
    host.reset = forget;
    host.contacts = NULL;
    host.passed = NULL;
    REFUSED(rivulet_world_create(context, &o, &world, &why), "has predict, and neither contacts nor passed");
    host.contacts = touch_moving_floor;
    host.passed = count_passed;
    DONE(rivulet_world_create(context, &o, &world, &why));
    run(world, 45);
    rivulet_body_state state;
    DONE(rivulet_world_bodies(world, &state, 1, &why));
    printf("it lies at %.4f m, asked %d times, passed %d, predicted %d\n", state.pose.position[1], engine.asked, engine.passed,
           engine.predicted);
    CHECK(fabsf(state.pose.position[1] - engine.radius) < 0.004F && fabsf(state.velocity[1]) < 0.1F);
    CHECK(engine.asked >= 45 && engine.passed >= 45 && engine.predicted > 0 && engine.moved == 0);
    contacts_are_checked(world, &engine);
    engine.moved = 0;
    const float rises = 0.3F; /* m/s */
    for (int k = 0; k < 24; ++k) {
        const int spins = k >= 12;
        engine.velocity[1] = spins ? 0 : rises;
        engine.spin[2] = spins ? rises / 2 : 0;
        engine.centre[0] = state.pose.position[0] - 2;
        engine.centre[1] = engine.y;
        engine.centre[2] = state.pose.position[2];
        run(world, 1);
        engine.y += rises / 60;
        DONE(rivulet_world_bodies(world, &state, 1, &why));
        if (k == 11 || k == 23) {
            printf("carried to %.4f m over the floor, at %.3f m/s\n", state.pose.position[1] - engine.y, state.velocity[1]);
            CHECK(fabsf(state.pose.position[1] - engine.y - engine.radius) < 0.002F && fabsf(state.velocity[1] - rises) < 0.03F);
        }
    }
    CHECK(engine.moved == 0);
    rivulet_world_destroy(world);
    rivulet_context_destroy(context);
}

static void what_cannot_be_is_refused(rivulet_context* context) {
    rivulet_world* world = pool(context, "", NULL);
    rivulet_mesh mesh = box_of(0.1F, 0.1F);
    const rivulet_body good = crate_of(&mesh, 0.25F, 0.4F, 0.25F);
    rivulet_body wrong = good;
    uint32_t id = 0;
    size_t count = 0;
    REFUSED(rivulet_world_add_body(NULL, &good, &id, &why), "NULL");
    REFUSED(rivulet_world_add_body(world, NULL, &id, &why), "NULL");
    REFUSED(rivulet_world_add_body(world, &good, NULL, &why), "NULL");
    REFUSED(rivulet_world_body(world, 0, NULL, NULL, NULL, &why), "no body 0");
    REFUSED(rivulet_world_body_ids(world, NULL, 0, NULL, &why), "NULL");
    wrong.density = 1.0e-30F;
    REFUSED(rivulet_world_add_body(world, &wrong, &id, &why), "density");
    wrong.density = 0;
    REFUSED(rivulet_world_add_body(world, &wrong, &id, &why), "density");
    wrong = good;
    wrong.mass = 7;
    REFUSED(rivulet_world_add_body(world, &wrong, &id, &why), "computed from the mesh and its density");
    wrong = good;
    wrong.spin[2] = NAN;
    REFUSED(rivulet_world_add_body(world, &wrong, &id, &why), "velocity or spin");
    /* The body is where its mesh is, and not where the mesh's origin is. */
    for (int k = 0; k < 8; ++k) corners[3 * k] += 1;
    REFUSED(rivulet_world_add_body(world, &good, &id, &why), "the centre of its mesh");
    wrong = good;
    wrong.pose.position[0] -= 1;
    DONE(rivulet_world_add_body(world, &wrong, &id, &why));
    wait_for(world, id);
    DONE(rivulet_world_remove_body(world, id, &why));
    mesh = box_of(0.1F, 0.1F);
    wrong = good;
    wrong.mesh = NULL;
    REFUSED(rivulet_world_add_body(world, &wrong, &id, &why), "no samples");
    wrong = good;
    wrong.pose.position[0] = 2;
    REFUSED(rivulet_world_add_body(world, &wrong, &id, &why), "fluid.box");
    wrong = good;
    wrong.layers = 0x10000;
    REFUSED(rivulet_world_add_body(world, &wrong, &id, &why), "16 layers");
    const float sample[3] = {0, 0, 0};
    wrong = (rivulet_body){.size = sizeof wrong, .samples = sample, .samples_count = 1, .mass = 1, .pose = good.pose};
    REFUSED(rivulet_world_add_body(world, &wrong, &id, &why), "inertia");
    /* A mesh that is open is found out while it is made ready. */
    mesh.indices_count = 3;
    DONE(rivulet_world_add_body(world, &good, &id, &why));
    rivulet_status status = RIVULET_OK;
    int32_t inside = 0;
    for (int k = 0; k < 5000 && status == RIVULET_OK; ++k) {
        wait_a_little(world, 0);
        status = rivulet_world_body(world, id, &inside, NULL, NULL, &why);
    }
    CHECK(status == RIVULET_FAILED && strstr(why.message, "volume") != NULL);
    DONE(rivulet_world_remove_body(world, id, &why));
    DONE(rivulet_world_body_ids(world, NULL, 0, &count, &why));
    CHECK(count == 0);
    rivulet_world_destroy(world);
}

int main(void) {
    rivulet_context* context = cpu_context();
    a_crate_floats(context);
    many_come_and_go(context);
    water_makes_room(context);
    no_water_meets_it(context);
    the_host_moves_them(context);
    what_cannot_be_is_refused(context);
    rivulet_context_destroy(context);
    a_gpu_moves_them_by_the_hosts_contacts();
    return failures > 0;
}
