#include "engine/core/keep_loaded.h"

#if __has_include(<dlfcn.h>)
#include <dlfcn.h>
#endif

namespace rivulet {

#if defined(RTLD_NODELETE) && defined(RTLD_NOLOAD)
void keepLoaded(const void* address) {
    Dl_info found{};
    if (dladdr(address, &found) == 0 || found.dli_fname == nullptr) return;
    if (void* const library = dlopen(found.dli_fname, RTLD_LAZY | RTLD_NOLOAD | RTLD_NODELETE)) dlclose(library);
}
#else
void keepLoaded(const void*) {}
#endif

}  // namespace rivulet
