/* Worlds, skins and snapshots whose OpenGL context has ended: they are destroyed, their memory is freed, and OpenGL is not called.
 * Exit 77: no OpenGL. */
#include <stdlib.h>

#include "check.h"
#include "host.h"

static int gone, late, said;

/* OpenGL's functions that delete, which report calls after the end of their context. */
#define COUNTED(type, name, parameters, arguments)   \
    static type real_##name;                         \
    static void APIENTRY counted_##name parameters { \
        late += gone;                                \
        if (!gone) real_##name arguments;            \
    }
#define NAMES(type, name) COUNTED(type, name, (GLsizei n, const GLuint* names), (n, names))
NAMES(PFNGLDELETEBUFFERSPROC, glDeleteBuffers)
NAMES(PFNGLDELETETEXTURESPROC, glDeleteTextures)
NAMES(PFNGLDELETEFRAMEBUFFERSPROC, glDeleteFramebuffers)
NAMES(PFNGLDELETEVERTEXARRAYSPROC, glDeleteVertexArrays)
NAMES(PFNGLDELETEQUERIESPROC, glDeleteQueries)
NAMES(PFNGLDELETESAMPLERSPROC, glDeleteSamplers)
COUNTED(PFNGLDELETEPROGRAMPROC, glDeleteProgram, (GLuint name), (name))
COUNTED(PFNGLDELETESHADERPROC, glDeleteShader, (GLuint name), (name))
COUNTED(PFNGLDELETESYNCPROC, glDeleteSync, (GLsync sync), (sync))
COUNTED(PFNGLBINDFRAMEBUFFERPROC, glBindFramebuffer, (GLenum target, GLuint name), (target, name))

static rivulet_function find(const char* name) {
    const rivulet_function real = eglGetProcAddress(name);
#define REPLACED(f)                            \
    if (strcmp(name, #f) == 0) {               \
        memcpy(&real_##f, &real, sizeof real); \
        return (rivulet_function)counted_##f;  \
    }
    REPLACED(glDeleteBuffers)
    REPLACED(glDeleteTextures)
    REPLACED(glDeleteFramebuffers)
    REPLACED(glDeleteVertexArrays)
    REPLACED(glDeleteQueries)
    REPLACED(glDeleteSamplers)
    REPLACED(glDeleteProgram)
    REPLACED(glDeleteShader)
    REPLACED(glDeleteSync)
    REPLACED(glBindFramebuffer)
    return real;
}

static void say(void* user, rivulet_level level, const char* sentence) {
    (void)user;
    if (level >= RIVULET_WARNING) {
        ++said;
        printf("%s\n", sentence);
    }
}

/* The host's memory, which counts what it has given out. */
static size_t held;
static void* take(void* user, size_t bytes, size_t alignment) {
    (void)user;
    held += bytes;
    return aligned_alloc(alignment, bytes);
}
static void give_back(void* user, void* memory, size_t bytes) {
    (void)user;
    held -= bytes;
    free(memory);
}

static void all_goes(const char* backend) {
    gone = 0;
    CHECK(make_current());
    const rivulet_memory memory = {.size = sizeof memory, .allocate = take, .release = give_back};
    const rivulet_context_options o = {.size = sizeof o, .find = find, .backend = backend, .log = say, .memory = &memory};
    rivulet_context* context = NULL;
    DONE(rivulet_context_create(&o, &context, &why));
    const rivulet_world_options scene = {
        .size = sizeof scene,
        .json = "{\"fluid\": {\"spacing\": 0.05, \"blocks\": [{\"max\": [0.5, 0.5, 1]}]}, \"look\": {\"quality\": \"fine\"}}"};
    rivulet_world* world = NULL;
    DONE(rivulet_world_create(context, &scene, &world, &why));
    rivulet_snapshot* snapshot = NULL;
    DONE(rivulet_snapshot_create(context, &snapshot, &why));
    const float places[12] = {0, 0, 0, 0.2F, 0, 0, 0.2F, 0, 0.2F, 0, 0, 0.2F}, uvs[8] = {0, 0, 1, 0, 1, 1, 0, 1};
    const uint32_t corners[6] = {0, 2, 1, 0, 3, 2};
    const rivulet_mesh mesh = {.size = sizeof mesh, .positions = places, .vertices = 4, .indices = corners, .indices_count = 6, .uvs = uvs};
    const rivulet_skin_options wet = {.size = sizeof wet, .mesh = &mesh};
    rivulet_skin* skin = NULL;
    DONE(rivulet_skin_create(context, &wet, &skin, &why));
    const float view[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -0.5F, -0.4F, -2.2F, 1};
    const float projection[16] = {1.8F, 0, 0, 0, 0, 2.4F, 0, 0, 0, 0, -1.0202F, -1, 0, 0, -0.20202F, 0};
    const rivulet_view from = {.size = sizeof from, .view = view, .projection = projection, .near_plane = 0.1F, .far_plane = 10};
    const rivulet_target to = {.size = sizeof to, .framebuffer = make_target(64, 48), .width = 64, .height = 48};
    for (int k = 0; k < 3; ++k) {
        DONE(rivulet_world_step(world, NULL, 1.0 / 60, &why));
        DONE(rivulet_world_snapshot(world, snapshot, &why));
        DONE(rivulet_world_draw(world, &from, &to, &why));
        DONE(rivulet_snapshot_draw(snapshot, &from, &to, &why));
        DONE(rivulet_skin_step(skin, NULL, 1.0 / 60, &why));
    }
    const int cpu = strcmp(backend, "cpu") == 0;
    CHECK(!cpu || held > 0);

    const EGLDisplay display = eglGetCurrentDisplay();
    const EGLContext ended = eglGetCurrentContext();
    eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display, ended);
    gone = 1;
    REFUSED(rivulet_world_draw(world, &from, &to, &why), "not current");
    DONE(rivulet_context_lost(context, &why));
    CHECK(rivulet_world_draw(world, &from, &to, &why) == RIVULET_FAILED && strstr(why.message, "lost") != NULL);
    CHECK(rivulet_snapshot_draw(snapshot, &from, &to, &why) == RIVULET_FAILED && strstr(why.message, "lost") != NULL);
    CHECK(rivulet_skin_step(skin, NULL, 1.0 / 60, &why) == (cpu ? RIVULET_OK : RIVULET_FAILED));
    rivulet_stats before = {.size = sizeof before}, after = {.size = sizeof after};
    DONE(rivulet_world_stats(world, &before, &why));
    CHECK(rivulet_world_step(world, NULL, 1.0 / 60, &why) == (cpu ? RIVULET_OK : RIVULET_FAILED));
    DONE(rivulet_world_stats(world, &after, &why));
    CHECK(cpu ? after.time > before.time : after.time == before.time);
    rivulet_skin_destroy(skin);
    rivulet_snapshot_destroy(snapshot);
    rivulet_world_destroy(world);
    CHECK(held == 0);
    rivulet_context_destroy(context);
    CHECK(said == 0 && late == 0);
    printf("%s: destroyed after the end of its OpenGL context, with %d calls of OpenGL\n", backend, late);
}

int main(void) {
    if (!make_current()) return 77;
    REFUSED(rivulet_context_lost(NULL, &why), "NULL");
    all_goes("cpu");
    all_goes("gl");
    all_goes("cpu"); /* others are created afterwards */
    return failures > 0;
}
