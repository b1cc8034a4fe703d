/* rivulet.h: the version, errors, and contexts: a device that simulates and, with OpenGL, a renderer. */
#ifndef RIVULET_CONTEXT_H
#define RIVULET_CONTEXT_H
/* NOLINTBEGIN(readability-identifier-naming): C's own way with names */

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && defined(rivulet_c_EXPORTS)
#define RIVULET_API __declspec(dllexport)
#elif defined(__GNUC__) && !defined(_WIN32)
#define RIVULET_API __attribute__((visibility("default")))
#else
#define RIVULET_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Semantic versioning: a program that works with a version works with later ones of the same major version. */
#define RIVULET_VERSION_MAJOR 0
#define RIVULET_VERSION_MINOR 1
#define RIVULET_VERSION_PATCH 0
/* The version of the loaded library, "0.1.0". */
RIVULET_API const char* rivulet_version(void);

typedef enum rivulet_status {
    RIVULET_OK = 0,
    RIVULET_FAILED = 1,   /* not possible now: out of memory, no OpenGL 4.5, a file that cannot be written */
    RIVULET_BAD_INPUT = 2 /* an argument or the order of calls is wrong */
} rivulet_status;

typedef struct rivulet_error {
    char message[1024];
} rivulet_error;

/* A device is lost when its driver was restarted, the GPU was removed, or a command of it failed. From then on every call that needs it
   returns RIVULET_FAILED, and files that a save or an export would replace stay. Destroy the worlds, skins and the context, and create
   others. See rivulet_context_lost. */
typedef struct rivulet_context rivulet_context; /* a device that simulates and, with OpenGL, a renderer */
typedef struct rivulet_world rivulet_world;     /* particles in a box, with walls and bodies */
typedef struct rivulet_skin rivulet_skin;       /* drops and films on a mesh, and a map of them */

typedef void (*rivulet_function)(void);
typedef rivulet_function (*rivulet_find_function)(const char* name); /* glfwGetProcAddress, SDL_GL_GetProcAddress, eglGetProcAddress */
typedef enum rivulet_level { RIVULET_INFO = 0, RIVULET_NOTICE = 1, RIVULET_WARNING = 2, RIVULET_ERROR = 3 } rivulet_level;

/* The host's job system. Loops of all calls of the context run on it: the passes of backend cpu, and the baking of walls of all backends.
   Results do not depend on it. */
typedef struct rivulet_jobs {
    size_t size;
    void* user; /* passed to run */
    /* Calls function(argument, k) once for each k from 0 to count - 1, in any order, on any threads, and returns when all calls have
       returned. count is at most workers. The calls do not wait for each other: they may also run one after another. run is called by the
       threads that call this library, never within function; it must not throw, nor call rivulet functions of this context. */
    void (*run)(void* user, void (*function)(void* argument, size_t k), void* argument, size_t count);
    int32_t workers; /* calls that can run at a time, the calling thread's among them; 1 or more */
    /* Runs function(argument) beside the frames, on any thread, and returns at once: a wall that is baked while the world runs. NULL: a
       thread of the library's own. The world waits for it when it is destroyed. */
    void (*start)(void* user, void (*function)(void* argument), void* argument);
} rivulet_jobs;

/* The host's memory for the buffers of backend cpu: particles, neighbour grid and lists, fields of walls, foam and drops, which are most of
   the memory of a world. Small objects, results of queries and files, and a wall while it is baked, use malloc. */
typedef struct rivulet_memory {
    size_t size;
    void* user; /* passed to both functions */
    /* bytes, a multiple of alignment, at an address that is a multiple of alignment, a power of two. NULL: out of memory; the call that
       needs it then returns RIVULET_FAILED. Called by the threads that call this library; it must not throw. */
    void* (*allocate)(void* user, size_t bytes, size_t alignment);
    void (*release)(void* user, void* memory, size_t bytes); /* what allocate returned, with its bytes */
} rivulet_memory;

typedef struct rivulet_context_options {
    size_t size;
    /* Finds OpenGL's functions in the current OpenGL context. NULL: no OpenGL; worlds are simulated and cannot be drawn. */
    rivulet_find_function find;
    const char* backend; /* auto (NULL), cpu, gl or cl. auto: gl if OpenGL runs on a GPU, else cpu */
    const char* device;  /* for backend cl: its number or a part of its name; NULL: the first */
    void (*log)(void* user, rivulet_level level, const char* sentence); /* called at the end of a call; NULL: silent */
    void* log_user;
    /* A limit in bytes, applied to each of: the device's buffers, the renderer's images, what a world of backend cpu or cl copies to
       OpenGL, the voxels of one wall. A call that would exceed it returns RIVULET_FAILED. 0: no limit. */
    size_t memory_limit;
    float sky_horizon[3], sky_zenith[3]; /* reflected by the water, radiance in the target's units; all 0: a grey-blue sky */
    float sky_sun[3];                    /* towards the sun; all 0: the default light direction of rivulet_view */
    float clouds;                        /* share of the sky that they cover, 0 to 1, approximate */
    int32_t threads;                     /* that a loop runs on at most; 0: all cores, or all workers of jobs */
    const rivulet_jobs* jobs;            /* NULL: the library's own threads */
    const rivulet_memory* memory;        /* NULL: malloc */
    /* 0: every call restores the host's OpenGL state. 1: no call asks for it, but for the depth convention, which saves about 130 calls of
       OpenGL; for a host that sets the state it needs. Afterwards state is as in a new context, but that of draw buffers from the third on,
       which stays; nothing is bound to framebuffers, to texture units 0 to 11, 16 and 24 to 30, to uniform buffers 0 to 3 and to storage
       buffers 0 to 7; viewport 0 and its scissor box have any value. */
    uint32_t plain_state;
} rivulet_context_options;

RIVULET_API rivulet_status rivulet_context_create(const rivulet_context_options* options, rivulet_context** context, rivulet_error* why);
/* Destroy its worlds and skins first: a context that still has some stays, and the log says so. */
RIVULET_API void rivulet_context_destroy(rivulet_context* context);
/* The OpenGL context that this was created in is gone or lost: destroyed by the host, reset by its driver (glGetGraphicsResetStatus). From
   now on no function of OpenGL is called for this context; it, its worlds and its skins can be destroyed on any thread, which frees their
   host memory. OpenGL objects of theirs end with the OpenGL context; they stay only where another context shares them. Worlds of backend
   cpu, and of cl without memory shared with OpenGL, can still be created, stepped, queried and saved; what needs OpenGL returns
   RIVULET_FAILED. */
RIVULET_API rivulet_status rivulet_context_lost(rivulet_context* context, rivulet_error* why);
/* The device that simulates, "cpu: AMD EPYC, 2 threads"; valid as long as the context. */
RIVULET_API const char* rivulet_context_device(const rivulet_context* context);
/* stop 1: from now on, a step of a world ends within milliseconds, on a GPU with what it has in its queue; 0: not any more. It may be
   called from any thread and from a signal handler, also while another call of the context is running. While a stop is asked, worlds can
   be neither created nor stepped nor asked about the water, attributes of particles are not set, and skins are not stepped:
   RIVULET_FAILED. See rivulet_world_step. */
RIVULET_API void rivulet_context_stop(rivulet_context* context, uint32_t stop);
/* Bytes in use now by the device's buffers and by images. */
RIVULET_API size_t rivulet_context_memory(const rivulet_context* context);

/* Times of the passes: the simulation's since the last call of rivulet_context_times, the drawing's in the last frame with known times. A
   GPU's times arrive two or three frames late. */
typedef struct rivulet_pass_time {
    char name[64];
    double ms;
    int32_t calls;
} rivulet_pass_time;
/* `count` receives the number of all passes, also where `capacity` is smaller. */
RIVULET_API rivulet_status rivulet_context_times(rivulet_context* context, rivulet_pass_time* times, size_t capacity, size_t* count,
                                                 rivulet_error* why);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */
#endif
