// What `dyncal triaxial` prints: the response of a sensor's three axes, the ratios to the excited
// axis, and the largest transverse sensitivity over all directions. Plain functions; any thread.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "analysis/response/largest_transverse.hpp"
#include "analysis/response/triaxial.hpp"
#include "services/programs/command/axis_results.hpp"

namespace dyncal::inline programs {

struct ResponsePoint {
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0;
  std::array<std::optional<analysis::Axes>, 3> columns; // by direction
  std::array<std::array<double, 3>, 3> u{};             // [direction][axis], of each real component
  std::array<std::optional<analysis::TransverseSensitivity>, 3> transverse;
  std::array<std::optional<analysis::LargestTransverse>, 3> largest; // by axis of the sensor
};

struct TriaxialText {
  const AxisChannels& channels;
  bool triaxial_reference = false;
  const std::vector<ResponsePoint>& points;
};

void print_json(const TriaxialText& text);
// `transverse_motion_rel`: its bound where the reference has one axis.
void print_table(const TriaxialText& text, double transverse_motion_rel);

} // namespace dyncal::inline programs
