/* A host for any platform: a block of water falls on the cpu, as a stone does until it meets the floor; its state is saved and restored; an
   error is a sentence. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include <rivulet/rivulet.h>

static rivulet_error why;
static int failures;
static void check(int holds, const char* what) {
    if (holds) return;
    ++failures;
    printf("does not hold: %s (%s)\n", what, why.message);
}
static double height(rivulet_world* world) {
    rivulet_stats stats = {.size = sizeof stats};
    check(rivulet_world_stats(world, &stats, &why) == RIVULET_OK, "stats");
    return stats.centre_of_mass[1];
}

int main(void) {
    const rivulet_context_options options = {.size = sizeof options, .backend = "cpu"};
    rivulet_context* context = NULL;
    check(rivulet_context_create(&options, &context, &why) == RIVULET_OK, "a context");
    if (context == NULL) return 1;
    printf("rivulet %s, %s\n", rivulet_version(), rivulet_context_device(context));
    const float low[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t triangle[3] = {0, 1, 2};
    const rivulet_mesh wall = {.size = sizeof wall, .positions = low, .vertices = 3, .indices = triangle, .indices_count = 3};
    const rivulet_world_options scene = {.size = sizeof scene,
                                         .json =
                                             "{\"fluid\": {\"spacing\": 0.03, \"box\": {\"max\": [1, 2, 1]}, \"blocks\": [{\"min\": [0.3, "
                                             "1.2, 0.3], \"max\": [0.7, 1.6, 0.7]}]}}",
                                         .walls = &wall,
                                         .walls_count = 1};
    rivulet_world* world = NULL;
    check(rivulet_world_create(context, &scene, &world, &why) == RIVULET_OK, "a world");
    if (world == NULL) return 1;
    const double start = 1.4; /* the middle of the block */
    for (int frame = 0; frame < 24; ++frame) check(rivulet_world_step(world, NULL, 1.0 / 60, &why) == RIVULET_OK, "a step");
    const double fallen = start - height(world);
    printf("after 0.4 s the water is %.3f m lower; a stone is %.3f m\n", fallen, 0.5 * 9.81 * 0.16);
    check(fabs(fallen - 0.5 * 9.81 * 0.16) < 0.02, "it falls as a stone");
    const char* path = "fall \xC3\xA9t\xC3\xA9.rstate"; /* not ASCII */
    check(rivulet_world_save(world, path, &why) == RIVULET_OK, "saved");
    for (int frame = 0; frame < 60; ++frame) check(rivulet_world_step(world, NULL, 1.0 / 60, &why) == RIVULET_OK, "a step");
    const double later = height(world);
    check(rivulet_world_restore(world, path, &why) == RIVULET_OK, "restored");
    for (int frame = 0; frame < 60; ++frame) check(rivulet_world_step(world, NULL, 1.0 / 60, &why) == RIVULET_OK, "a step");
    check(height(world) == later, "the same from the saved state on");
    check(rivulet_world_save(world, path, &why) == RIVULET_OK, "saved over the older file");
    check(rivulet_world_export(world, "fall.ply", &why) == RIVULET_OK, "exported");
    check(rivulet_world_restore(world, "no such file", &why) == RIVULET_BAD_INPUT && strstr(why.message, "it does not exist") != NULL,
          "a missing file is a sentence");
    check(rivulet_world_set(world, "fluid.viscosity=-1", &why) == RIVULET_BAD_INPUT, "a wrong value is refused");
    remove(path);
    rivulet_world_destroy(world);
    rivulet_context_destroy(context);
    puts(failures == 0 ? "passed" : "failed");
    return failures != 0;
}
