#include "services/command/share_line.hpp"

#include <cmath>
#include <unistd.h>

#include <fmt/core.h>

namespace dyncal::services {
namespace {

constexpr std::chrono::seconds patience{2};
constexpr std::chrono::milliseconds on_terminal{200};
constexpr std::chrono::seconds elsewhere{10};

} // namespace

ShareLine::ShareLine(std::FILE* stream)
    : stream_(stream), terminal_(isatty(fileno(stream)) != 0), next_(began_ + patience) {}

void ShareLine::show(double share) {
  const Clock::time_point now = Clock::now();
  if (now < next_ || share <= 0.0) {
    return;
  }
  next_ = now + (terminal_ ? Clock::duration(on_terminal) : Clock::duration(elsewhere));
  const double elapsed_s = std::chrono::duration<double>(now - began_).count();
  const std::string text = fmt::format("{:.0f} %, {:.0f} s left", 100.0 * share,
                                       std::ceil(elapsed_s * (1.0 - share) / share));
  fmt::print(stream_, "{}{}{}", terminal_ ? "\r\x1b[K" : "", text, terminal_ ? "" : "\n");
  std::fflush(stream_);
  open_ = terminal_;
}

void ShareLine::end() {
  if (open_) {
    fmt::print(stream_, "\n");
    open_ = false;
  }
}

} // namespace dyncal::services
