#include "cli/signals.h"

#include <unistd.h>

#include <csignal>

namespace gradwright::cli {
namespace {

// A signal handler can reach nothing but variables of static storage, so this is the one such variable of the
// program.
std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a handler may only touch lock-free atomics");

extern "C" void on_signal(int) {
    if (stop_requested.exchange(true)) _exit(130);
    // Only async-signal-safe calls are allowed here: write(2) is, printf is not.
    constexpr char text[] = "\ngradwright: ending after this step; once more ends at once\n";
    if (write(STDERR_FILENO, text, sizeof text - 1) < 0) return;
}

}  // namespace

const std::atomic<bool>* watch_signals() {
    struct sigaction action {};
    action.sa_handler = on_signal;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    return &stop_requested;
}

}  // namespace gradwright::cli
