#include "cli/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "cli/common.h"

namespace gradwright::cli {
namespace {

constexpr double kBarPeriod = 0.2;    // [s]: fast enough to look alive, slow enough to cost nothing
constexpr double kLinePeriod = 30.0;  // [s]

ProgressLine::Mode mode_of(bool quiet) {
    if (quiet) return ProgressLine::Mode::silent;
    const char* term = std::getenv("TERM");
    const bool rewrites = term && std::strcmp(term, "dumb") != 0;
    return isatty(STDERR_FILENO) && rewrites ? ProgressLine::Mode::bar : ProgressLine::Mode::lines;
}

}  // namespace

double time_left(double elapsed_seconds, double first_fraction, double fraction) {
    const double done = fraction - first_fraction;
    if (done <= 0 || elapsed_seconds <= 0) return -1;
    return elapsed_seconds * (1 - fraction) / done;
}

ProgressLine::ProgressLine(bool quiet) : mode_(mode_of(quiet)), stream_(stderr) {}

std::string ProgressLine::text(double elapsed) const {
    const double left = time_left(elapsed, first_fraction_, fraction_);
    // The first seconds say little about the rest: a number that jumps is worse than none.
    const std::string to_go =
        left >= 0 && elapsed >= 2 ? fmt::format("{} to go", duration_text(left)) : std::string();
    if (mode_ == Mode::lines)
        return fmt::format("{}: {:.0f} % after {}{}{}", stage_, 100 * fraction_, duration_text(elapsed),
                           to_go.empty() ? "" : ", ", to_go);
    constexpr int kWidth = 24;
    const int full = static_cast<int>(kWidth * fraction_);
    return fmt::format("{:<28} [{}{}] {:3.0f} %  {}", stage_, std::string(full, '='),
                       std::string(kWidth - full, ' '), 100 * fraction_, to_go);
}

void ProgressLine::update(const std::string& stage, double fraction) {
    if (mode_ == Mode::silent) return;
    const auto now = Clock::now();
    fraction = std::clamp(fraction, 0.0, 1.0);
    const bool new_stage = stage != stage_ || fraction < fraction_;
    if (new_stage) {
        stage_ = stage;
        first_fraction_ = fraction;
        stage_start_ = now;
        if (mode_ == Mode::lines && last_print_ == Clock::time_point{}) last_print_ = now;
    }
    fraction_ = fraction;
    const double since = std::chrono::duration<double>(now - last_print_).count();
    const bool due = since >= (mode_ == Mode::bar ? kBarPeriod : kLinePeriod);
    if (!due && !(mode_ == Mode::bar && new_stage)) return;
    last_print_ = now;
    const std::string line = text(std::chrono::duration<double>(now - stage_start_).count());
    if (mode_ == Mode::bar) {
        // \r to the line's start, ESC[K clears what a longer line left behind
        fmt::print(stream_, "\r{}\033[K", line);
        shown_ = true;
    } else {
        fmt::print(stream_, "{}\n", line);
    }
    std::fflush(stream_);
}

void ProgressLine::finish() {
    if (!shown_) return;
    fmt::print(stream_, "\r\033[K");
    std::fflush(stream_);
    shown_ = false;
}

}  // namespace gradwright::cli
