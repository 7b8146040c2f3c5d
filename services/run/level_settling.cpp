#include "services/run/level_settling.hpp"

#include <algorithm>

namespace dyncal::services {
namespace {

constexpr double min_window_s = 0.2;
constexpr double window_periods = 4.0;
constexpr double slack_s = 0.5; // to look, to set, and for samples that come late

} // namespace

double level_window_s(double frequency_hz) {
  return std::max(min_window_s, window_periods / frequency_hz);
}

int level_corrections(int repetition) {
  return repetition > 1 ? 1 : 3;
}

double planned_settling_s(const BenchFile& bench, double frequency_hz, int repetition) {
  const double settling_s = bench.excitation.settling_s;
  if (!bench.generator.level_tolerance_rel) {
    return settling_s;
  }
  const double measurement_s =
      settling_s + level_transport_s + level_window_s(frequency_hz) + slack_s;
  return settling_s + (1 + level_corrections(repetition)) * measurement_s;
}

} // namespace dyncal::services
