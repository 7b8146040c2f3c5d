#include "services/programs/command/progress_line.hpp"

#include <unistd.h>

#include <cmath>

#include <fmt/core.h>

#include "services/base/printable_text.hpp"

namespace dyncal::inline programs {

std::string step_text(const RunProgress& progress) {
  return fmt::format("step {} of {}, {} Hz, {}{}", progress.step, progress.steps,
                     progress.frequency_hz, progress.phase,
                     progress.attempt > 1 ? fmt::format(", attempt {}", progress.attempt) : "");
}

std::string describe(const RunProgress& progress) {
  if (progress.step == 0) {
    return fmt::format("{} steps planned, {}, {} results", progress.steps, progress.phase,
                       progress.results);
  }
  std::string text = step_text(progress);
  if (progress.seconds_left) {
    text += fmt::format(", {:.0f} s left", std::ceil(*progress.seconds_left));
  }
  return text;
}

ProgressLine::ProgressLine(std::FILE* stream)
    : stream_(stream), terminal_(isatty(fileno(stream)) != 0) {}

ProgressLine::~ProgressLine() {
  end();
}

void ProgressLine::show(const RunProgress& progress) {
  for (const std::string& line : {progress.request, progress.notice}) {
    if (!line.empty()) {
      end();
      fmt::print(stream_, "{}\n", one_line(line));
      std::fflush(stream_);
      return;
    }
  }
  const std::string text = one_line(describe(progress));
  if (text == last_text_) {
    return;
  }
  last_text_ = text;
  if (terminal_) {
    fmt::print(stream_, "\r\x1b[K{}", text);
    open_ = true;
  } else if (progress.step != last_step_) {
    fmt::print(stream_, "{}\n", text);
    last_step_ = progress.step;
  }
  std::fflush(stream_);
}

void ProgressLine::end() {
  if (open_) {
    fmt::print(stream_, "\n");
    open_ = false;
  }
}

} // namespace dyncal::inline programs
