// HostState: a host's OpenGL state, kept while we work in its context, and put back.
//
//     {
//         const gpu::HostState keep;   // what we find is saved, and all is as we expect it: OpenGL's defaults
//         world->step(inputs, seconds);  water->draw(...);
//     }                                // every bit is as it was
//
// Needs a current OpenGL 4.5 context, core or compatibility, and its functions loaded (load.h). What it does not keep, since OpenGL cannot
// be asked for it or it is no state: pending errors of glGetError, which we leave alone unless an allocation of ours fails; the host's
// queries, transform feedback and conditional rendering that are under way: end them before; what is bound and was already deleted, here or
// in a context that shares: it is gone when something else is bound. Scopes may nest.
#pragma once

#include <memory>

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
