// HostState: saves a host's OpenGL state and restores it at the end of the scope.
//
//     {
//         const gpu::HostState keep;   // saves the state and sets OpenGL's defaults, which Rivulet expects
//         world->step(inputs, seconds);  water->draw(keep, ...);
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

// A host's depth convention.
struct HostDepth {
    bool zeroToOne = false, upperLeft = false;  // glClipControl: GL_ZERO_TO_ONE, GL_UPPER_LEFT
    float near = 0, far = 1;                    // glDepthRange
};

class HostState {
  public:
    enum Saves {
        rivulets,    // all state that Rivulet changes: the first two draw buffers, viewport 0, 2D and buffer textures of the units it uses
        everything,  // for passes of the host's own (RendererRow), which may change more: all draw buffers, viewports, images and textures
        // For a host that sets all state it needs itself: no state is asked for but the depth convention. Afterwards state is at OpenGL's
        // defaults, as of a new context, but: what is bound to framebuffers and viewport 0; programs, vertex arrays, and on texture units 0
        // to 11, 16 and 24 to 30, on uniform buffers 0 to 3 and on storage buffers 0 to 7, nothing.
        nothing
    };
    explicit HostState(Saves saves = rivulets);
    ~HostState();
    HostState(const HostState&) = delete;
    HostState& operator=(const HostState&) = delete;

    const HostDepth& depth() const;  // of the host

  private:
    struct Kept;
    std::unique_ptr<Kept> kept_, plain_;  // of the host; as it is within the scope
};

// Saves one texture binding that HostState does not save, and the sampler of its unit, and restores both at the end of the scope.
class BoundUnit {
  public:
    BoundUnit(unsigned unit, unsigned target);  // GL_TEXTURE_2D or GL_TEXTURE_CUBE_MAP
    ~BoundUnit();
    BoundUnit(const BoundUnit&) = delete;
    BoundUnit& operator=(const BoundUnit&) = delete;

  private:
    unsigned unit_, target_;
    int texture_ = 0, sampler_ = 0;
};

// The target of a host's texture, which exists: GL_TEXTURE_2D or GL_TEXTURE_CUBE_MAP; 0: another one. Within a scope of HostState.
unsigned targetOfTexture(unsigned name);

}  // namespace rivulet::gpu
