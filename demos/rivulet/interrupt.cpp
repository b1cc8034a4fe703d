#include "demos/rivulet/interrupt.h"

#include <signal.h>
#include <unistd.h>

#include "demos/rivulet/cli.h"

namespace rivulet {

namespace {

// The only global variables of the program: a signal handler takes no user data.
volatile sig_atomic_t graceful = 0;
volatile sig_atomic_t terminal = 0;  // stderr is one, and may show a progress bar
std::atomic<bool> interruption = false;
static_assert(std::atomic<bool>::is_always_lock_free);

void onSignal(int) {
    if (interruption.exchange(true) || graceful == 0) {
        constexpr char kErase[] = "\r\033[K";
        if (terminal != 0 && write(STDERR_FILENO, kErase, sizeof kErase - 1) < 0) _exit(kInterrupted);
        _exit(kInterrupted);
    }
}

}  // namespace

void installInterrupts() {
    terminal = isatty(STDERR_FILENO);
    struct sigaction action = {};
    action.sa_handler = onSignal;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

Graceful::Graceful() { graceful = 1; }
Graceful::~Graceful() { graceful = 0; }
bool Graceful::interrupted() const { return interruption; }
const std::atomic<bool>* Graceful::flag() const { return &interruption; }

}  // namespace rivulet
