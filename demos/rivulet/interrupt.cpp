#include "demos/rivulet/interrupt.h"

#include <signal.h>
#include <unistd.h>

#include "engine/core/new_file.h"

namespace rivulet {

namespace {

// The only global variables of the program: a signal handler takes no user data.
volatile sig_atomic_t inGraceful = 0;
volatile sig_atomic_t onTerminal = 0;  // stderr is one, and may show a progress bar
std::atomic<bool> interruption = false;
std::atomic<int> firstSignal = 0;  // the signal that interrupted
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

constexpr int statusOf(int signal) { return 128 + signal; }

void onSignal(int signal) {
    int none = 0;
    firstSignal.compare_exchange_strong(none, signal);
    const bool again = interruption.exchange(true);
    if (inGraceful != 0 && (!again || signal == SIGHUP)) return;  // a shell repeats the SIGHUP of its terminal
    removeTemporaryFiles();
    constexpr char kErase[] = "\r\033[K";
    if (onTerminal != 0 && write(STDERR_FILENO, kErase, sizeof kErase - 1) < 0) _exit(statusOf(signal));
    _exit(statusOf(signal));
}

}  // namespace

void installSignals() {
    onTerminal = isatty(STDERR_FILENO);
    struct sigaction action = {};
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    action.sa_handler = SIG_IGN;
    for (const int signal : {SIGPIPE, SIGXFSZ}) sigaction(signal, &action, nullptr);
    action.sa_handler = onSignal;
    for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
    struct sigaction hangup = {};
    if (sigaction(SIGHUP, nullptr, &hangup) == 0 && hangup.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // nohup ignores it
}

Graceful::Graceful() { inGraceful = 1; }
Graceful::~Graceful() { inGraceful = 0; }
bool Graceful::interrupted() const { return interruption; }
int Graceful::status() const { return firstSignal == 0 ? 0 : statusOf(firstSignal); }
const std::atomic<bool>* Graceful::flag() const { return &interruption; }

}  // namespace rivulet
