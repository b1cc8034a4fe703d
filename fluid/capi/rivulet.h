/* rivulet.h: water in any engine that can call C.
 *
 *     rivulet_context* context = NULL;
 *     rivulet_context_options options = {.size = sizeof options, .find = (rivulet_find_function)glfwGetProcAddress};
 *     rivulet_context_create(&options, &context, &why);
 *     rivulet_world* world = NULL;
 *     rivulet_world_options scene = {.size = sizeof scene, .json = "{\"fluid\": {\"spacing\": 0.03, \"blocks\": [...]}}"};
 *     rivulet_world_create(context, &scene, &world, &why);
 *     each frame:  rivulet_world_step(world, NULL, 1.0 / 60, &why);
 *                  rivulet_world_draw(world, &view, &target, &why);
 *
 * Units are SI and +Y is up. A matrix is 16 floats, column by column, as in OpenGL; a place or a vector is 3 floats.
 *
 * Versions: a struct that begins with `size` may grow. The caller sets it to sizeof the struct, also where the library fills the rest, so a
 * program that was built against an older header still works. In an array of such structs each one begins its own size after the one
 * before. Structs without `size` (poses, rays, samples, ...) never change: an extension gets a new name. A member that is 0 or NULL has its
 * default.
 *
 * Errors: every function that can fail returns a rivulet_status and writes one sentence into `why`, which may be NULL: what is wrong,
 * where, and the remedy. Nothing is thrown. A NULL handle gives RIVULET_BAD_INPUT; destroying NULL does nothing.
 *
 * Threads: one thread at a time uses a context and everything made from it; with OpenGL, a thread on which the context's OpenGL context is
 * current. Contexts are independent: different threads may use different ones at the same time. Snapshots can be drawn while another thread
 * steps their world: see rivulet_snapshot.h.
 *
 * Callbacks run on the calling thread, before the call returns; log, and those of rivulet_query.h, at the end of the call. A callback that
 * calls back into the same context gets RIVULET_BAD_INPUT. The functions of bodies may throw in C++: the call then goes on and returns
 * RIVULET_FAILED, with the exception's text. So does a draw whose rivulet_renderer throws; what others throw is dropped. A callback may be
 * left by longjmp on the same thread: the next call ends the unfinished one, and a world that was being stepped, reset or created is
 * incomplete (see rivulet_world_step); a little memory is lost. A rivulet_renderer may not be left so; the functions of rivulet_jobs and of
 * rivulet_memory may do neither.
 *
 * Bounds: what is not finite or absurd is RIVULET_BAD_INPUT. Values of a scene have the ranges of docs/parameters.md, and blocks, emitters,
 * bodies and particles lie in the box. Lengths and positions are at most 1e6 m, speeds of walls, bodies and particles at most 1e6 m/s,
 * gravity at most 1,000 m/s^2 along an axis, wind 1,000 m/s, a step 3,600 s, radiances 1e6.
 *
 * OpenGL: functions that need it are all with backend gl, else those that create, destroy and draw. They return RIVULET_BAD_INPUT if the
 * OpenGL context of their rivulet_context is not current. They restore all OpenGL state, with two exceptions: pending errors of glGetError
 * may be cleared, and an object that was deleted while bound is unbound. Transform feedback, counting queries and conditional rendering
 * must not be active. Only rivulet_world_draw and rivulet_snapshot_draw draw. Destroy worlds, skins and contexts before the OpenGL context:
 * if it is not current, destruction is refused and logged. If it has ended, call rivulet_context_lost first.
 */
#ifndef RIVULET_H
#define RIVULET_H

#include "rivulet_context.h"
#include "rivulet_draw.h"
#include "rivulet_query.h"
#include "rivulet_skin.h"
#include "rivulet_snapshot.h"
#include "rivulet_solids.h"
#include "rivulet_world.h"

#endif
