// A control chart as a picture: deviations of a check sensor from the centre of its first results
// over time, with its warning and action limits; magnitude in per cent above, phase or delay below.
// A line for each point or channel, at most six that spread over the range, each over its own
// action limit, so that all have their limits at 1. The CSV holds all.
#pragma once

#include <string>
#include <vector>

#include "services/views/figures/figure.hpp"

namespace dyncal::inline views::figures {

struct ControlPoint {
  std::string run;
  std::string began_utc;
  double days = 0.0; // since the first result
  double deviation = 0.0;
  std::string state;
};

struct ControlTrace {
  std::string label;
  std::string quantity; // "magnitude_rel", "phase_rad", "delay_s"
  double warning = 0.0; // half widths, in the unit of the deviations
  double action = 0.0;
  std::vector<ControlPoint> points;
};

struct ControlData {
  std::string title{};
  std::string subtitle{};
  std::vector<ControlTrace> magnitudes{};
  std::vector<ControlTrace> phases{};
};

[[nodiscard]] Figure control_figure(const ControlData& data, const std::string& name);

} // namespace dyncal::inline views::figures
