// An exclusive prefix sum of uints of any length in three dispatches: scan_reduce, scan_blocks, scan_apply, all with LOCAL_SIZE 256.
// A work group processes a block of SCAN_BLOCK elements; one work group sums the blocks in a loop. No group waits for another.
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
#pragma once
#include "shaders/common/lang.h"
namespace rivulet {
#endif
#define SCAN_THREADS 256u
#define SCAN_BLOCK 1024u
STRUCT(ScanParams) {
    uint count;   // elements
    uint blocks;  // ceil(count / SCAN_BLOCK); dispatch blocks * SCAN_THREADS threads, scan_blocks SCAN_THREADS
    uint pad0;
    uint pad1;
};
#if defined(__cplusplus) && !defined(RIVULET_KERNEL_UNIT)
static_assert(sizeof(ScanParams) % 16 == 0);
}  // namespace rivulet
#include "shaders/common/lang_end.h"
#endif
