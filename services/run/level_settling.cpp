#include "services/run/level_settling.hpp"

#include "services/evaluation/record/channel_level.hpp"

namespace dyncal::services {

int level_corrections(int repetition) {
  return repetition > 1 ? 1 : 3;
}

double planned_settling_s(const BenchFile& bench, double frequency_hz, int repetition) {
  const double settling_s = bench.excitation.settling_s;
  if (!bench.generator.level_tolerance_rel) {
    return settling_s;
  }
  const double measurement_s =
      settling_s + level_transport_s + level_window_s(frequency_hz) + level_slack_s;
  return settling_s + (1 + level_corrections(repetition)) * measurement_s;
}

} // namespace dyncal::services
