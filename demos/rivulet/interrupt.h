// Ctrl-C (SIGINT) and SIGTERM. Outside a Graceful scope the program leaves at once with status 130; inside one the first signal is only
// noted, so that a loop can close its files, and a second one leaves at once.
#pragma once

namespace rivulet {

void installInterrupts();

class Graceful {
  public:
    Graceful();
    ~Graceful();
    Graceful(const Graceful&) = delete;
    Graceful& operator=(const Graceful&) = delete;
    bool interrupted() const;
};

}  // namespace rivulet
