#include "analysis/method/stamp_rows.hpp"

#include <cmath>

namespace dyncal::analysis {

BeatReach reach_on_ratio(double phase_rad, double other_phase_rad) {
  const double across = 2.0 * std::abs(std::sin(phase_rad - other_phase_rad));
  return {across, across, 0.0};
}

void add_beat_rows(Budget& budget, const std::string& whose, double angular_frequency,
                   const StampBeat& beat, const BeatReach& reach) {
  const double u_of_bound = 1.0 / std::sqrt(3.0);
  if (beat.in_step_rad > 0.0) {
    budget.add({.kind = ContributionKind::stamp_tick,
                .subject = whose + " stamps, in step with the signal",
                .distribution = Distribution::rectangular,
                .u_magnitude_rel = reach.in_step_magnitude * beat.in_step_rad * u_of_bound,
                .u_phase_rad = reach.in_step_phase * beat.in_step_rad * u_of_bound});
  }
  if (reach.on_average * beat.mean_s > 0.0) {
    budget.add({.kind = ContributionKind::stamp_tick,
                .subject = whose + " stamps, on average",
                .distribution = Distribution::rectangular,
                .repeats = Repeats::common_delay,
                .u_phase_rad = reach.on_average * angular_frequency * beat.mean_s * u_of_bound});
  }
}

} // namespace dyncal::analysis
