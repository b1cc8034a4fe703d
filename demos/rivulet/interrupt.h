// Ctrl-C (SIGINT) and SIGTERM. Outside a Graceful scope the program exits at once with status 130. Inside one, the first signal only sets
// interrupted(), so that a loop can close its files; a second signal exits at once.
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
