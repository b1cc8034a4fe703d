#include "demos/rivulet/interrupt.h"

#include <signal.h>
#include <unistd.h>

#include "demos/rivulet/cli.h"

namespace rivulet {

namespace {

// The only global variables of the program: a signal handler takes no user data.
volatile sig_atomic_t graceful = 0;
volatile sig_atomic_t interruptions = 0;

void onSignal(int) {
    interruptions = interruptions + 1;
    if (graceful == 0 || interruptions > 1) _exit(kInterrupted);
}

}  // namespace

void installInterrupts() {
    struct sigaction action = {};
    action.sa_handler = onSignal;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

Graceful::Graceful() { graceful = 1; }
Graceful::~Graceful() { graceful = 0; }
bool Graceful::interrupted() const { return interruptions > 0; }

}  // namespace rivulet
