// The owners of OpenGL objects after the end of the OpenGL context that the objects belong to.
#pragma once

#include "engine/core/abi.h"

namespace rivulet::gpu {

// While it lives, owners of OpenGL objects that this thread destroys (Buffer, Texture, Program, Fence, a Device gl, renderers) call no
// function of OpenGL: their objects ended with their context. Objects of a group of contexts that share are not deleted.
class LostContext {
  public:
    LostContext() : before_(here()) { here() = true; }
    ~LostContext() { here() = before_; }
    LostContext(const LostContext&) = delete;
    LostContext& operator=(const LostContext&) = delete;

    static bool& here() {
        thread_local bool lost = false;
        return lost;
    }

  private:
    bool before_;
};

}  // namespace rivulet::gpu
