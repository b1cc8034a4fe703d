// Ctrl-C (SIGINT) and SIGTERM. Outside a Graceful scope the program exits at once with status 130. Inside one, the first signal only sets
// interrupted() and flag(), so that a loop can close its files; a second signal exits at once. Work without files to close needs no scope.
#pragma once

#include <atomic>

namespace rivulet {

void installInterrupts();

class Graceful {
  public:
    Graceful();
    ~Graceful();
    Graceful(const Graceful&) = delete;
    Graceful& operator=(const Graceful&) = delete;
    bool interrupted() const;
    const std::atomic<bool>* flag() const;  // as interrupted(), for Device::stopOn; it outlives the scope
};

}  // namespace rivulet
