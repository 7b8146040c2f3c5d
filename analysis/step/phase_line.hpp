// A straight line through the phases of frames that follow one another: where a sine of steady
// frequency is, and how far its frequency is from the one that the phases were taken against.
//
//   phase_i = mean_rad + slope_rad (x_i - x_mean)
//
// Equal weights. The standard uncertainties come from the scatter about the line, and are not
// below those that the frames have by themselves. REQUIRES: at least two frames whose x differ.
// Plain function, any thread.
#pragma once

#include <span>

namespace dyncal::analysis {

struct FramePhase {
  double x = 0.0; // place of the frame, in frames
  double phase_rad = 0.0;
  double u_phase_rad = 0.0;
};

struct PhaseLine {
  double x_mean = 0.0;
  double mean_rad = 0.0;
  double slope_rad = 0.0; // a frame
  double u_mean_rad = 0.0;
  double u_slope_rad = 0.0;
};

[[nodiscard]] PhaseLine fit_phase_line(std::span<const FramePhase> frames);

} // namespace dyncal::analysis
