#include "cli/signals.h"

#include <unistd.h>

#include <csignal>
#include <ctime>

namespace gradwright::cli {
namespace {

// A signal handler can reach nothing but variables of static storage, so this is the one such variable of the
// program.
std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a handler may only touch lock-free atomics");

std::atomic<long> first_at{0};  // [ms]
static_assert(std::atomic<long>::is_always_lock_free, "as above");

extern "C" void on_signal(int) {
    // timeout(1) signals its command and then its command's whole group: that is one request, not two
    constexpr long kOneRequest = 300;  // [ms]
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    const long ms = now.tv_sec * 1000L + now.tv_nsec / 1000000L;
    long earlier = 0;
    if (!first_at.compare_exchange_strong(earlier, ms)) {
        if (ms - earlier > kOneRequest) _exit(130);
        return;
    }
    stop_requested.store(true);
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
