// DebugMessages: what the driver says about our use of OpenGL, handed to a Log and counted.
#pragma once

#include <memory>
#include <string>

#include "engine/core/log.h"

namespace rivulet::gpu {

// Installed on the current context until destroyed (it must be current then too). Owned by whoever owns the context; tests ask errors() ==
// 0. Errors and undefined behaviour go to log.error, deprecation and portability to log.warning, hints on speed to log.info.
class DebugMessages {
  public:
    explicit DebugMessages(Log log);
    DebugMessages(DebugMessages&&) noexcept;
    DebugMessages& operator=(DebugMessages&&) noexcept;
    ~DebugMessages();

    int errors() const;
    int warnings() const;
    const std::string& lastError() const;  // "" if there was none

  private:
    struct State;  // its address is the callback's user pointer
    std::unique_ptr<State> state_;
};

}  // namespace rivulet::gpu
