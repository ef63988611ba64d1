// How far a run is, on stderr: one line with a measured time to go on a terminal, otherwise a line every 30
// s.
#pragma once
#include <chrono>
#include <cstdio>
#include <string>

namespace gradwright::cli {

/// Time left of a stage from what it has taken so far [s]; negative while nothing can be said.
///   left = elapsed (1 - fraction) / (fraction - first_fraction)
double time_left(double elapsed_seconds, double first_fraction, double fraction);

class ProgressLine {
  public:
    enum class Mode { silent, lines, bar };
    /// `quiet`: nothing at all. A bar when stderr is a terminal that can rewrite a line (TERM is not "dumb").
    explicit ProgressLine(bool quiet);
    ProgressLine(Mode mode, std::FILE* stream) : mode_(mode), stream_(stream) {}
    ~ProgressLine() { finish(); }
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    /// `fraction` of `stage`, 0..1; a new stage name starts its clock anew.
    void update(const std::string& stage, double fraction);
    /// Takes the bar off the screen, so that what follows starts on a clean line.
    void finish();

  private:
    using Clock = std::chrono::steady_clock;
    std::string text(double now_seconds) const;

    Mode mode_;
    std::FILE* stream_;
    std::string stage_;
    double fraction_ = 0, first_fraction_ = 0;
    Clock::time_point stage_start_{}, last_print_{};
    bool shown_ = false;
};

}  // namespace gradwright::cli
