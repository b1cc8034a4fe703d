/* rivulet.h: snapshots: what a draw needs of a world, copied, so that the world can be stepped while the copy is drawn. */
#ifndef RIVULET_SNAPSHOT_H
#define RIVULET_SNAPSHOT_H
/* NOLINTBEGIN(readability-identifier-naming): C's own way with names */

#include "rivulet_draw.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Stepping and drawing at the same time, with backend cpu or cl:
 *
 *     worker:  rivulet_world_step(world, ...);  rivulet_world_snapshot(world, next, ...);  then the host exchanges next and shown
 *     host:    rivulet_snapshot_draw(shown, ...);
 *
 * While one thread is in rivulet_snapshot_draw or rivulet_snapshot_buffers, one other thread may be in a function of the same context that
 * needs no OpenGL: step, reset, set, stats, particles, bodies, save, restore, snapshot, and those of rivulet_query.h, of a world. All other
 * functions of the context, creation and destruction among them, run alone. A snapshot is used by one call at a time: it is filled or
 * drawn. Calls that break these rules return RIVULET_BAD_INPUT where that is noticed. Messages from
 * drawing a snapshot reach the log at the end of the next other call of the context.
 *
 * With backend gl all functions need the OpenGL context of the rivulet_context, which is current on one thread: a step on another thread is
 * refused. There the GPU works while the host's thread goes on; a snapshot is a copy on the GPU, which outlasts the steps after it. To step
 * on a worker thread, create the context with backend cpu. */
typedef struct rivulet_snapshot rivulet_snapshot;

/* An empty snapshot, for worlds of this context. It counts as one of them: destroy it before the context. */
RIVULET_API rivulet_status rivulet_snapshot_create(rivulet_context* context, rivulet_snapshot** snapshot, rivulet_error* why);
RIVULET_API void rivulet_snapshot_destroy(rivulet_snapshot* snapshot);
/* Copies the particles with their attributes, foam, ellipsoids, wetness, dry volumes and drops of skins of the world as they are now, and
   its look, in place of what the snapshot held. With backend cpu and cl no OpenGL is used. The world may be destroyed before the
   snapshot. */
RIVULET_API rivulet_status rivulet_world_snapshot(rivulet_world* world, rivulet_snapshot* snapshot, rivulet_error* why);
/* Records what is drawn of the world into a file: each rivulet_world_step from now on adds its frame, which waits for a GPU. path NULL:
   ends the recording; so does the world's destruction. Until then an older file of the name stays as it is. RIVULET_FAILED, also of a step:
   the file cannot be written; the recording has then ended. The file names the parameters of the world as they are now, the device and the
   library's version. Wetness, drops of skins and attributes of particles are not recorded. */
RIVULET_API rivulet_status rivulet_world_record(rivulet_world* world, const char* path, rivulet_error* why);
/* Puts frame `frame` (from 0) of a recorded file into the snapshot, with the look and liquid of `world`, which is not changed. Frames can
   be read in any order. The file stays open until another is given, or one of the same name that has changed, or the snapshot is destroyed.
   RIVULET_BAD_INPUT: it is no recording, is damaged or has no such frame. */
typedef struct rivulet_recorded {
    size_t size;
    size_t frames; /* out: of the file; at least 1 */
    double time;   /* out: s simulated, of the frame */
} rivulet_recorded;
RIVULET_API rivulet_status rivulet_snapshot_replay(rivulet_snapshot* snapshot, const rivulet_world* world, const char* path, size_t frame,
                                                   rivulet_recorded* recorded, rivulet_error* why);
/* As rivulet_world_draw and rivulet_world_buffers, of the world as it was. RIVULET_BAD_INPUT: the snapshot is empty. The buffers are valid
   until the snapshot is filled, drawn or destroyed. Call rivulet_world_wet_solid when you take the snapshot: after the next step it
   describes the new state. A second draw of the same
   contents, of another eye say, uploads nothing. */
RIVULET_API rivulet_status rivulet_snapshot_draw(rivulet_snapshot* snapshot, const rivulet_view* view, const rivulet_target* target,
                                                 rivulet_error* why);
RIVULET_API rivulet_status rivulet_snapshot_buffers(rivulet_snapshot* snapshot, rivulet_buffers* buffers, rivulet_error* why);

#ifdef __cplusplus
}
#endif
/* NOLINTEND(readability-identifier-naming) */
#endif
