#include "services/programs/command/share_line.hpp"

#include <cmath>
#include <unistd.h>

#include <fmt/core.h>

namespace dyncal::inline programs {
namespace {

constexpr std::chrono::seconds patience{2};
constexpr std::chrono::seconds pace{10};

} // namespace

ShareLine::ShareLine(std::FILE* stream)
    : stream_(stream), terminal_(isatty(fileno(stream)) != 0), next_(began_ + patience) {}

void ShareLine::show(double share) {
  const Clock::time_point now = Clock::now();
  if (terminal_ || now < next_ || share <= 0.0) {
    return;
  }
  next_ = now + pace;
  const double elapsed_s = std::chrono::duration<double>(now - began_).count();
  fmt::print(stream_, "{:.0f} %, {:.0f} s left\n", 100.0 * share,
             std::ceil(elapsed_s * (1.0 - share) / share));
  std::fflush(stream_);
}

} // namespace dyncal::inline programs
