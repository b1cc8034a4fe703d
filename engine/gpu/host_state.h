// HostState: saves a host's OpenGL state and restores it at the end of the scope.
//
//     {
//         const gpu::HostState keep;   // saves the state and sets OpenGL's defaults, which Rivulet expects
//         world->step(inputs, seconds);  water->draw(...);
//     }                                // the state is restored exactly
//
// Needs a current OpenGL 4.5 context, core or compatibility, with its functions loaded (load.h). Scopes may nest. Not saved, because OpenGL
// cannot query it or because it is no state: pending errors of glGetError, which are read only after a failed allocation; active queries,
// transform feedback and conditional rendering of the host, which must be ended before; bound objects that were already deleted, here or in
// a context that shares objects: they cease to exist when another object is bound.
#pragma once

#include <memory>

#include "engine/core/abi.h"

namespace rivulet::gpu {

class HostState {
  public:
    HostState();
    ~HostState();
    HostState(const HostState&) = delete;
    HostState& operator=(const HostState&) = delete;

  private:
    struct Kept;
    std::unique_ptr<Kept> kept_;
};

}  // namespace rivulet::gpu
