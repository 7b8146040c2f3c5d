// The progress of a run: one line that is overwritten on a terminal, one line per step elsewhere.
// Belongs to one thread.
#pragma once

#include <cstdio>
#include <string>

#include "services/run/run_progress.hpp"

namespace dyncal::inline programs {

// "step 7 of 51, 40 Hz, settling"
[[nodiscard]] std::string step_text(const RunProgress& progress);
// "step 7 of 51, 40 Hz, settling, 38 s left"
[[nodiscard]] std::string describe(const RunProgress& progress);

class ProgressLine {
public:
  explicit ProgressLine(std::FILE* stream);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const RunProgress& progress);
  // Ends the line, so that what follows begins on its own.
  void end();

private:
  std::FILE* stream_;
  bool terminal_;
  bool open_ = false;
  std::size_t last_step_ = 0;
  std::string last_text_;
};

} // namespace dyncal::inline programs
