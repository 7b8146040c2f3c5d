#include "analysis/step/phase_line.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::analysis {

PhaseLine fit_phase_line(std::span<const FramePhase> frames) {
  const auto count = static_cast<double>(frames.size());
  PhaseLine line;
  double u2 = 0.0;
  for (const FramePhase& frame : frames) {
    line.x_mean += frame.x / count;
    line.mean_rad += frame.phase_rad / count;
    u2 += frame.u_phase_rad * frame.u_phase_rad / count;
  }
  double xx = 0.0, xy = 0.0;
  for (const FramePhase& frame : frames) {
    xx += (frame.x - line.x_mean) * (frame.x - line.x_mean);
    xy += (frame.x - line.x_mean) * (frame.phase_rad - line.mean_rad);
  }
  line.slope_rad = xy / xx;
  double squares = 0.0;
  for (const FramePhase& frame : frames) {
    const double residual =
        frame.phase_rad - line.mean_rad - line.slope_rad * (frame.x - line.x_mean);
    squares += residual * residual;
  }
  const double scatter2 = frames.size() > 2 ? squares / (count - 2.0) : 0.0;
  const double u_rad = std::sqrt(std::max(u2, scatter2));
  line.u_mean_rad = u_rad / std::sqrt(count);
  line.u_slope_rad = u_rad / std::sqrt(xx);
  return line;
}

} // namespace dyncal::analysis
