#include "analysis/method/dau_rows.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/method/stamp_rows.hpp"

namespace dyncal::analysis {

double common_jitter_s(const SystematicUncertainty& systematic) {
  return std::max(systematic.dau_jitter_s, systematic.dau_tick_s / std::sqrt(12.0));
}

void add_dau_sync_noise(Budget& budget, const RecordedChannel& sync_dau,
                        const SystematicUncertainty& systematic) {
  add_signal_rows(budget, "the DAU sync", sync_dau,
                  std::hypot(systematic.sync_adc_jitter_s, common_jitter_s(systematic)),
                  CountsIn::phase);
}

void add_dau_adc_rows(Budget& budget, const SampleStampingInput& input,
                      const RecordedChannel& sync_dau) {
  budget.add({.kind = ContributionKind::sync_jitter,
              .u_phase_rad = std::sqrt(1.5 / static_cast<double>(sync_dau.result.fit.samples)) *
                             input.frequency.angular() * input.systematic.sync_adc_jitter_s});
  budget.add({.kind = ContributionKind::adc_phase, .u_phase_rad = input.adc.u_phase_lag_rad});
}

void add_dau_stamp_noise(Budget& budget, const SampleStampingInput& input,
                         const RecordedChannel& dut, const RecordedChannel& sync_dau,
                         const StampBeat& beat) {
  const double tick_s = input.systematic.dau_tick_s / std::sqrt(12.0);
  const double rest_s = std::sqrt(std::max(
      0.0, input.systematic.dau_jitter_s * input.systematic.dau_jitter_s - tick_s * tick_s));
  const double n = static_cast<double>(dut.result.fit.samples);
  const double across =
      std::abs(std::sin(dut.result.fit.phase_rad() - sync_dau.result.fit.phase_rad()));
  const auto add = [&](ContributionKind kind, Distribution distribution, double jitter_s) {
    const double angle = input.frequency.angular() * jitter_s;
    const double shortening = 0.5 * angle * angle;
    budget.add({.kind = kind,
                .subject = "the DAU stamps",
                .distribution = distribution,
                .u_magnitude_rel = std::hypot(std::sqrt(0.5 / n) * angle, shortening),
                .u_phase_rad = std::sqrt(2.0 / n) * across * angle,
                .u_lasting_magnitude_rel = shortening});
  };
  add(ContributionKind::stamp_jitter, Distribution::normal, rest_s);
  add(ContributionKind::stamp_tick, Distribution::rectangular, tick_s);
  add_beat_rows(budget, "the DAU", input.frequency.angular(), beat,
                {.in_step_magnitude = 1.0, .in_step_phase = 2.0 * across, .on_average = 0.0});
}

} // namespace dyncal::analysis
