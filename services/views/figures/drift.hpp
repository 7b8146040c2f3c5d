// How a sensor's response drifts over its calibrations, as a picture: deviation from the first
// calibration over time with expanded uncertainty, magnitude in per cent above, phase in degrees
// below; a line for every point, at most six that spread over the range. The CSV holds all.
#pragma once

#include <string>
#include <vector>

#include "services/views/figures/figure.hpp"

namespace dyncal::inline views::figures {

struct DriftValue {
  std::string run;
  std::string began_utc;
  double days = 0.0; // since the first calibration
  double magnitude = 0.0;
  double expanded_magnitude = 0.0;
  double deviation_magnitude_rel = 0.0;
  double phase_rad = 0.0;
  double expanded_phase_rad = 0.0;
  double deviation_phase_rad = 0.0;
};

struct DriftLine {
  std::string label;
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0; // 0: not known
  std::string excited_axis;
  std::vector<DriftValue> values;
};

struct DriftData {
  std::string title{};
  std::string subtitle{};
  std::string unit{};             // of the magnitude; may be empty
  std::vector<DriftLine> lines{}; // by frequency, then level
};

[[nodiscard]] Figure drift_figure(const DriftData& data, const std::string& name);

} // namespace dyncal::inline views::figures
