// SIGINT and SIGTERM: the first asks the run to end after its time step, the second ends the program at once.
#pragma once
#include <atomic>

namespace gradwright::cli {

/// Installs the handlers and returns the flag that they set; it lives as long as the program.
const std::atomic<bool>* watch_signals();

}  // namespace gradwright::cli
