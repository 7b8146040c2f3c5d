#include "services/run/level_settling.hpp"

#include <algorithm>

#include "services/evaluation/record/channel_level.hpp"

namespace dyncal::inline run {

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

drivers::generator::LevelLimits level_limits(const BenchFile& bench) {
  drivers::generator::LevelLimits limits;
  limits.maximum_voltage_v = bench.generator.maximum_voltage_v.value_or(limits.maximum_voltage_v);
  limits.maximum_level_m_s2 =
      bench.generator.maximum_level_m_s2.value_or(limits.maximum_level_m_s2);
  const auto& levels = bench.excitation.levels_m_s2;
  if (bench.generator.maximum_level_m_s2 || !levels.empty()) {
    limits.plausible_level_m_s2 = drivers::generator::plausible_level_m_s2(
        bench.generator.maximum_level_m_s2 ? *bench.generator.maximum_level_m_s2
                                           : *std::max_element(levels.begin(), levels.end()));
    limits.plausible_voltage_v = limits.plausible_level_m_s2 / bench.generator.level_per_volt;
  }
  return limits;
}

} // namespace dyncal::inline run
