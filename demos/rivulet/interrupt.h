// Ctrl-C (SIGINT), SIGTERM and SIGHUP. Outside a Graceful scope the program exits at once with status 128 + signal. Inside one, the first
// signal only sets interrupted() and flag(), so that a loop can close its files; a second one, other than SIGHUP, exits at once. Work
// without files to close needs no scope. Exiting at once removes temporary files.
#pragma once

#include <atomic>

namespace rivulet {

// Also: SIGPIPE and SIGXFSZ are ignored, so that a write to a closed pipe or beyond the limit of file sizes fails with a message.
void installSignals();

class Graceful {
  public:
    Graceful();
    ~Graceful();
    Graceful(const Graceful&) = delete;
    Graceful& operator=(const Graceful&) = delete;
    bool interrupted() const;
    int status() const;                     // the exit status: 128 + the signal, 0 if there was none
    const std::atomic<bool>* flag() const;  // as interrupted(), for Device::stopOn; it outlives the scope
};

}  // namespace rivulet
