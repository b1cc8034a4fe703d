/* host BACKEND FUNCTION KIND FIRST SECOND ONWARDS FOLDER: calls a function of rivulet.h again and again while the N-th call of a kind
 * fails, N = 1, 2, ... up to FIRST, then in growing steps, until nothing fails. After each failure the function is called once more and
 * must succeed. LD_PRELOAD has librivulet_faults.so. Without FUNCTION: their names.
 *
 * The calls are made in a child; a child that crashes is one input that crashed, and the next child goes on behind it. The last line has
 * four numbers: inputs, crashed, hung, lost. Exit 77: no OpenGL or OpenCL. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "host.h"
#include <rivulet/rivulet.h>

static rivulet_error why;
static rivulet_context* context;
static rivulet_world *world, *made;
static rivulet_skin *skin, *made_skin;
static rivulet_context* made_context;
static const char *backend, *folder;
static int drawn; /* with OpenGL */
static GLuint framebuffer;

/* In memory that the parent reads. */
static struct {
    long number, inputs, lost;
    int ended, absent;
} * shared;

static void hear(void* user, rivulet_level level, const char* sentence) { (void)user, (void)level, (void)sentence; }

static const char* const kScene =
    "{\"fluid\": {\"spacing\": 0.05, \"maxSubsteps\": 2, \"box\": {\"max\": [0.5, 0.5, 0.5]}, \"foam\": {\"most\": 50},"
    " \"probes\": [{\"name\": \"floor\", \"face\": \"-y\"}], \"maxParticles\": 200, \"blocks\": [{\"max\": [0.25, 0.2, 0.2]}]},"
    " \"emitters\": [{\"position\": [0.3, 0.4, 0.3], \"radius\": 0.06, \"litresPerSecond\": 1}],"
    " \"sinks\": [{\"position\": [0.4, 0.05, 0.4], \"size\": [0.1, 0.1, 0.1]}]}";
static const float corners[12] = {0, 0.02F, 0, 0.5F, 0.02F, 0, 0.5F, 0.02F, 0.5F, 0, 0.02F, 0.5F};
static const uint32_t square[6] = {0, 2, 1, 0, 3, 2};
static const float uvs[8] = {0, 0, 1, 0, 1, 1, 0, 1};
static const rivulet_pose above = {{0, 0.02F, 0}, {0, 0, 0, 1}};

static const char* path_of(const char* name) {
    static char path[2][1024];
    static int k;
    k = !k;
    snprintf(path[k], sizeof path[k], "%s/%s", folder, name);
    return path[k];
}

static rivulet_status create_context(void) {
    const rivulet_context_options o = {
        .size = sizeof o, .backend = backend, .log = hear, .find = drawn ? (rivulet_find_function)eglGetProcAddress : NULL};
    return rivulet_context_create(&o, &made_context, &why);
}
static rivulet_status create_world(void) {
    const float samples[6] = {0.02F, 0, 0, -0.02F, 0, 0};
    const rivulet_body body = {.size = sizeof body,
                               .samples = samples,
                               .samples_count = 2,
                               .mass = 0.1F,
                               .inertia = {1e-4F, 1e-4F, 1e-4F},
                               .volume = 1e-4F,
                               .pose = {{0.3F, 0.3F, 0.3F}, {0, 0, 0, 1}}};
    const rivulet_mesh walls[2] = {
        {.size = sizeof *walls, .positions = corners, .vertices = 4, .indices = square, .indices_count = 6, .resolution = 8},
        {.size = sizeof *walls,
         .positions = corners,
         .vertices = 4,
         .indices = square,
         .indices_count = 6,
         .resolution = 8,
         .moves = 1,
         .pose = above}};
    const float particles[6] = {0.4F, 0.3F, 0.1F, 0.4F, 0.36F, 0.1F};
    const rivulet_world_options o = {.size = sizeof o,
                                     .json = kScene,
                                     .walls = walls,
                                     .walls_count = 2,
                                     .bodies = &body,
                                     .bodies_count = 1,
                                     .particles = particles,
                                     .particles_count = 2};
    return rivulet_world_create(context, &o, &made, &why);
}
static rivulet_status create_skin(void) {
    const rivulet_mesh mesh = {.size = sizeof mesh, .positions = corners, .vertices = 4, .indices = square, .indices_count = 6, .uvs = uvs};
    const rivulet_skin_options o = {.size = sizeof o, .mesh = &mesh, .json = "{\"advancing\": 60}", .map_size = 64};
    return rivulet_skin_create(context, &o, &made_skin, &why);
}

static rivulet_status context_create(void) {
    const rivulet_status status = create_context();
    if (status == RIVULET_OK) rivulet_context_destroy(made_context);
    return status;
}
static rivulet_status world_create(void) {
    const rivulet_status status = create_world();
    if (status == RIVULET_OK) rivulet_world_destroy(made);
    return status;
}
static rivulet_status skin_create(void) {
    const rivulet_status status = create_skin();
    if (status == RIVULET_OK) rivulet_skin_destroy(made_skin);
    return status;
}
/* What is destroyed is made before. */
static rivulet_status destroy_context(void) {
    rivulet_context_destroy(made_context);
    return RIVULET_OK;
}
static rivulet_status destroy_world(void) {
    rivulet_world_destroy(made);
    return RIVULET_OK;
}
static rivulet_status destroy_skin(void) {
    rivulet_skin_destroy(made_skin);
    return RIVULET_OK;
}
/* These cannot fail: whatever happens, they return. */
static rivulet_status asks(void) {
    rivulet_context_stop(context, 1);
    rivulet_context_stop(context, 0);
    return rivulet_version() != NULL && rivulet_context_device(context) != NULL && rivulet_context_memory(context) > 0 ? RIVULET_OK
                                                                                                                       : RIVULET_FAILED;
}
/* Refused and logged: it has a world. */
static rivulet_status destroy_early(void) {
    rivulet_context_destroy(context);
    return RIVULET_OK;
}
static rivulet_status times(void) {
    rivulet_pass_time passes[8];
    size_t count = 0;
    return rivulet_context_times(context, passes, 8, &count, &why);
}
static rivulet_status step(void) {
    static int frame;
    const float gravity[3] = {0, -9.81F, 0};
    rivulet_pose pose = above;
    pose.position[1] += 1e-4F * (float)(++frame % 10);
    const rivulet_inputs in = {.size = sizeof in, .gravity = gravity, .poses = &pose, .poses_count = 1};
    return rivulet_world_step(world, &in, 1.0 / 60, &why);
}
static rivulet_status reset(void) { return rivulet_world_reset(world, &why); }
static rivulet_status set(void) {
    static int turn;
    return rivulet_world_set(world, ++turn % 2 ? "fluid.viscosity=0.01" : "fluid.forces.tension=0.07", &why);
}
static rivulet_status refused(void) { /* in a message that takes memory */
    const rivulet_status status = rivulet_world_set(world, "fluid.viscositi=0.01", &why);
    return status == RIVULET_BAD_INPUT ? RIVULET_OK : status;
}
static rivulet_status stats(void) {
    rivulet_stats s = {.size = sizeof s};
    return rivulet_world_stats(world, &s, &why);
}
static rivulet_status particles(void) {
    static float x[3 * 300], v[3 * 300], density[300];
    static uint32_t ids[300];
    rivulet_particles p = {.size = sizeof p, .capacity = 300, .positions = x, .velocities = v, .densities = density, .ids = ids};
    return rivulet_world_particles(world, &p, &why);
}
static rivulet_status bodies(void) {
    rivulet_body_state state;
    return rivulet_world_bodies(world, &state, 1, &why);
}
static rivulet_status save(void) { return rivulet_world_save(world, path_of("state.rstate"), &why); }
static rivulet_status restore(void) { return rivulet_world_restore(world, path_of("kept.rstate"), &why); }
static const float places[6] = {0.1F, 0.1F, 0.1F, 0.3F, 0.3F, 0.3F};
static rivulet_status sample(void) {
    rivulet_sample samples[2];
    return rivulet_world_sample(world, places, 2, samples, &why);
}
static rivulet_status cast(void) {
    const rivulet_ray ray = {{0.1F, 0.45F, 0.1F}, {0, -1, 0}, 0};
    rivulet_hit hit;
    return rivulet_world_cast(world, &ray, 1, &hit, &why);
}
static rivulet_status heights(void) {
    float height[2];
    return rivulet_world_heights(world, places, 2, height, &why);
}
static const rivulet_volume volume = {.id = 3, .position = {0.1F, 0.1F, 0.1F}, .size = {0.2F, 0.2F, 0.2F}};
static rivulet_status set_volumes(void) { return rivulet_world_set_volumes(world, &volume, 1, &why); }
static rivulet_status volumes(void) {
    rivulet_volume_count counts[32];
    size_t count = 0;
    const rivulet_status status = rivulet_world_volumes(world, counts, 32, &count, &why);
    return status == RIVULET_OK ? rivulet_world_volume_events(world, counts, 32, &count, &why) : status;
}
static rivulet_status loads(void) {
    rivulet_load load[2];
    size_t count = 0;
    return rivulet_world_loads(world, load, 2, &count, &why);
}
static rivulet_status export(void) { return rivulet_world_export(world, path_of("particles.vtp"), &why); }
static rivulet_status export_surface(void) { return rivulet_world_export_surface(world, path_of("surface.obj"), &why); }
static rivulet_status skin_add(void) {
    const float place[3] = {0.2F, 0.02F, 0.2F};
    return rivulet_skin_add(skin, place, 1, &why);
}
static rivulet_status skin_step(void) {
    const float wind[3] = {0.1F, 0, 0};
    const rivulet_skin_inputs in = {.size = sizeof in, .wind = wind, .positions = corners};
    return rivulet_skin_step(skin, &in, 1.0 / 60, &why);
}
static rivulet_status skin_stats(void) {
    rivulet_skin_stats s = {.size = sizeof s};
    return rivulet_skin_stats_of(skin, &s, &why);
}
static rivulet_status skin_texture(void) {
    uint32_t texture = 0;
    return rivulet_skin_texture(skin, &texture, &why);
}
static rivulet_status draw(void) {
    const float view[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -0.25F, -0.2F, -2, 1};
    const float projection[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, -1.01F, -1, 0, 0, -0.201F, 0};
    const rivulet_view from = {.size = sizeof from, .view = view, .projection = projection, .near_plane = 0.1F, .far_plane = 20};
    const rivulet_target to = {.size = sizeof to, .framebuffer = framebuffer, .width = 64, .height = 48};
    return rivulet_world_draw(world, &from, &to, &why);
}
static rivulet_status buffers(void) {
    rivulet_buffers b = {.size = sizeof b};
    return rivulet_world_buffers(world, &b, &why);
}

static const struct {
    const char* name;
    rivulet_status (*call)(void);
    int draws;
    const char* file;                /* that it writes */
    rivulet_status (*prepare)(void); /* before each call */
} functions[] = {{"context_create", context_create, 0, NULL, NULL},
                 {"world_create", world_create, 0, NULL, NULL},
                 {"skin_create", skin_create, 0, NULL, NULL},
                 {"destroy_context", destroy_context, 0, NULL, create_context},
                 {"destroy_world", destroy_world, 0, NULL, create_world},
                 {"destroy_skin", destroy_skin, 0, NULL, create_skin},
                 {"asks", asks, 0, NULL, NULL},
                 {"destroy_early", destroy_early, 0, NULL, NULL},
                 {"times", times, 0, NULL, NULL},
                 {"step", step, 0, NULL, NULL},
                 {"reset", reset, 0, NULL, NULL},
                 {"set", set, 0, NULL, NULL},
                 {"refused", refused, 0, NULL, NULL},
                 {"stats", stats, 0, NULL, NULL},
                 {"particles", particles, 0, NULL, NULL},
                 {"bodies", bodies, 0, NULL, NULL},
                 {"save", save, 0, "state.rstate", NULL},
                 {"restore", restore, 0, NULL, NULL},
                 {"sample", sample, 0, NULL, NULL},
                 {"cast", cast, 0, NULL, NULL},
                 {"heights", heights, 0, NULL, NULL},
                 {"set_volumes", set_volumes, 0, NULL, NULL},
                 {"volumes", volumes, 0, NULL, NULL},
                 {"loads", loads, 0, NULL, NULL},
                 {"export", export, 0, "particles.vtp", NULL},
                 {"export_surface", export_surface, 0, "surface.obj", NULL},
                 {"skin_add", skin_add, 0, NULL, NULL},
                 {"skin_step", skin_step, 0, NULL, NULL},
                 {"skin_stats", skin_stats, 0, NULL, NULL},
                 {"skin_texture", skin_texture, 1, NULL, NULL},
                 {"draw", draw, 1, NULL, NULL},
                 {"buffers", buffers, 1, NULL, NULL}};
enum { COUNT = sizeof functions / sizeof *functions };

static void must(rivulet_status status, const char* what) {
    if (status == RIVULET_OK) return;
    printf("without faults, %s: %s\n", what, why.message);
    shared->absent = 1;
    fflush(stdout);
    _exit(3);
}

static void set_up_gl(int function) {
    drawn = functions[function].draws || strcmp(backend, "gl") == 0;
    if (!drawn) return;
    if (!make_current()) {
        shared->absent = 1;
        _exit(77);
    }
    framebuffer = make_target(64, 48);
}

static void tear_down(void) {
    rivulet_skin_destroy(skin);
    rivulet_world_destroy(world);
}

static void set_up(void) {
    if (create_context() != RIVULET_OK) {
        printf("no context: %s\n", why.message);
        shared->absent = 1;
        _exit(77);
    }
    context = made_context;
    must(create_world(), "create_world");
    world = made;
    must(create_skin(), "create_skin");
    skin = made_skin;
    must(set_volumes(), "set_volumes");
    must(step(), "step");
    must(rivulet_world_save(world, path_of("kept.rstate"), &why), "save");
    must(skin_add(), "skin_add");
    must(skin_step(), "skin_step");
}

/* The bytes of a file; -1: there is none. */
static long content(const char* name, char* to, long most) {
    FILE* file = fopen(path_of(name), "rb");
    if (file == NULL) return -1;
    const long got = (long)fread(to, 1, (size_t)most, file);
    fclose(file);
    return got;
}

static void lose(const char* function, const char* kind, long number, const char* what) {
    ++shared->lost;
    printf("%s %s:%ld: %s: %s\n", function, kind, number, what, why.message);
    fflush(stdout);
}

static void child(int function, const char* kind, long first, long second, int onwards) {
    void (*arm)(int, long, int);
    long (*failed)(void);
    int (*kind_of)(const char*);
    *(void**)&arm = dlsym(RTLD_DEFAULT, "faults_arm");
    *(void**)&failed = dlsym(RTLD_DEFAULT, "faults_failed");
    *(void**)&kind_of = dlsym(RTLD_DEFAULT, "faults_kind");
    set_up_gl(function);
    set_up();
    const char* const name = functions[function].name;
    static char old[1 << 20], now[1 << 20];
    rivulet_status (*const call)(void) = functions[function].call;
    rivulet_status (*const prepare)(void) = functions[function].prepare;
    for (int k = 0; k < 2; ++k) {
        if (prepare) must(prepare(), "what it needs");
        must(call(), name);
    }
    size_t held = rivulet_context_memory(context);
    while (1) {
        const long number = ++shared->number;
        long bytes = functions[function].file ? content(functions[function].file, old, sizeof old) : -1;
        if (prepare) must(prepare(), "what it needs");
        memset(&why, 0, sizeof why);
        arm(kind_of(kind), number, onwards);
        const rivulet_status status = call();
        const long failures_now = failed();
        arm(-1, 0, 0);
        if (failures_now == 0) {
            if (status != RIVULET_OK) lose(name, kind, number, "it fails without a fault");
            break;
        }
        ++shared->inputs;
        if (number > first) shared->number += (number - first) / second;
        /* What it writes is the same each time. */
        if (status == RIVULET_OK && bytes >= 0 &&
            (content(functions[function].file, now, sizeof now) != bytes || memcmp(old, now, (size_t)bytes) != 0))
            lose(name, kind, number, "it succeeds, and the file is another");
        if (status == RIVULET_OK) continue;
        const size_t length = strnlen(why.message, sizeof why.message);
        const char* const raw[] = {"bad_alloc", "std::", "terminate", "what()", "unexpected", "basic_string", "\n"};
        for (size_t k = 0; k < sizeof raw / sizeof *raw; ++k)
            if (strstr(why.message, raw[k]) != NULL) {
                lose(name, kind, number, "raw words");
                break;
            }
        if (length == 0 || length > 520) lose(name, kind, number, "no sentence");
        if (bytes >= 0 && (content(functions[function].file, now, sizeof now) != bytes || memcmp(old, now, (size_t)bytes) != 0))
            lose(name, kind, number, "the older file has changed");
        char before[1024];
        snprintf(before, sizeof before, "%s", why.message);
        rivulet_status again = call();
        /* A world that is incomplete says so; a reset makes it whole. */
        if (again != RIVULET_OK && strstr(why.message, "reset or restore") != NULL && reset() == RIVULET_OK) again = call();
        /* After a device is lost, a new context works. */
        if (again != RIVULET_OK && strstr(why.message, "create a context") != NULL) {
            tear_down();
            rivulet_context_destroy(context);
            set_up();
            if (prepare) must(prepare(), "what it needs");
            again = call();
            held = rivulet_context_memory(context);
        }
        if (again != RIVULET_OK) {
            printf("%s %s:%ld: first: %s\n", name, kind, number, before);
            lose(name, kind, number, "the next call fails");
            shared->number = number;
            _exit(4); /* a new world for the next */
        }
    }
    if (rivulet_context_memory(context) > held + (1 << 20)) lose(name, kind, shared->number, "memory of the device has grown");
    tear_down();
    if (rivulet_context_memory(context) != 0 && strcmp(backend, "cpu") == 0 && !drawn)
        lose(name, kind, shared->number, "memory of the device is left");
    rivulet_context_destroy(context);
    shared->ended = 1;
    _exit(0);
}

int main(int count, char** words) {
    if (count < 8) {
        for (int k = 0; k < COUNT; ++k) printf("%s\n", functions[k].name);
        return 0;
    }
    backend = words[1];
    folder = words[7];
    int function = 0;
    while (function < COUNT && strcmp(functions[function].name, words[2]) != 0) ++function;
    if (function == COUNT) return 2;
    shared = mmap(NULL, sizeof *shared, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (shared == MAP_FAILED) return 2;
    long crashed = 0;
    for (int children = 0; !shared->ended && children < 200; ++children) {
        fflush(stdout);
        const pid_t pid = fork();
        if (pid == 0) child(function, words[3], atol(words[4]), atol(words[5]), atoi(words[6]));
        int status = 0;
        if (waitpid(pid, &status, 0) != pid) return 2;
        if (shared->absent) return WEXITSTATUS(status) == 77 ? 77 : 3;
        if (WIFSIGNALED(status) || (WEXITSTATUS(status) != 0 && WEXITSTATUS(status) != 4)) {
            ++crashed;
            ++shared->inputs;
            printf("%s %s:%ld%s: crashed, status %#x\n", words[2], words[3], shared->number, words[6][0] == '1' ? "+" : "",
                   (unsigned)status);
        }
    }
    printf("%ld %ld 0 %ld\n", shared->inputs, crashed, shared->lost);
    return 0;
}
