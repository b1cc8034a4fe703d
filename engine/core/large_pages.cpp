#include "engine/core/large_pages.h"

#if defined(__linux__)
#include <sys/mman.h>

#include <cstdint>
#endif

namespace rivulet {

#if defined(__linux__)
void useLargePages(void* memory, size_t bytes) {
    constexpr uintptr_t kPage = uintptr_t{2} << 20U;  // of x86-64 and of most arm64
    const uintptr_t begin = (reinterpret_cast<uintptr_t>(memory) + kPage - 1) / kPage * kPage;
    const uintptr_t end = (reinterpret_cast<uintptr_t>(memory) + bytes) / kPage * kPage;
    if (bytes < 2 * kPage || begin >= end) return;
    (void)madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);  // refused: pages stay small
}
#else
void useLargePages(void*, size_t) {}
#endif

}  // namespace rivulet
