// DebugMessages: passes the driver's debug messages to a Log and counts them.
#pragma once

#include <memory>
#include <string>

#include "engine/core/log.h"

namespace rivulet::gpu {

// Installed on the context that is current at construction, until destruction (it must be current then too). The owner of the context owns
// it; tests require errors() == 0. Errors and undefined behaviour go to log.error, deprecation and portability to log.warning, hints on
// speed to log.info.
class DebugMessages {
  public:
    explicit DebugMessages(Log log);
    DebugMessages(DebugMessages&&) noexcept;
    DebugMessages& operator=(DebugMessages&&) noexcept;
    ~DebugMessages();

    int errors() const;
    int warnings() const;
    const std::string& lastError() const;  // "": none

  private:
    struct State;  // its address is the callback's user pointer
    std::unique_ptr<State> state_;
};

}  // namespace rivulet::gpu
