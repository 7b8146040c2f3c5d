#include "analysis/method/own_clock_channel.hpp"

#include <cmath>
#include <numbers>

#include "analysis/method/blocks_of_clock.hpp"
#include "analysis/method/channels_of_one_clock.hpp"
#include "analysis/method/stamp_rows.hpp"

namespace dyncal::analysis {
namespace {

// White stamp noise of one channel alone: multiplicative, so phase and amplitude take unequal
// shares.
void add_jitter(Budget& budget, double w, double jitter_s, double samples) {
  const double angle = w * jitter_s;
  const double shortening = 0.5 * angle * angle;
  budget.add({.kind = ContributionKind::stamp_jitter,
              .subject = "the stamps",
              .u_magnitude_rel = std::hypot(std::sqrt(0.5 / samples) * angle, shortening),
              .u_phase_rad = std::sqrt(1.5 / samples) * angle,
              .u_lasting_magnitude_rel = shortening});
}

// In blocks on the pilot's time scale, `distance_s` of the first samples apart.
std::optional<RatioInBlocks> ratio_in_blocks(RecordedChannel& sensor, const OwnClockLink& link,
                                             double distance_s) {
  std::optional<BlockSeries> blocks = learn_from_blocks(sensor);
  if (!blocks) {
    return std::nullopt;
  }
  for (double& time_s : blocks->time_s) {
    time_s += distance_s;
  }
  if (link.sync) {
    refer_phase(*blocks, *link.sync, 0.0);
  }
  BlockAlignment alignment = link.alignment;
  if (alignment.reach_s > 0.0) {
    alignment.seen = seen_offset(sensor, link.reference, distance_s);
  }
  return compare(blocks, link.denominator, alignment);
}

} // namespace

Expected<TransferPoint>
evaluate_own_clock_channel(const ChannelFit& pilot, std::int64_t pilot_first_ns,
                           const OwnClockLink& link, std::span<const std::int64_t> dut_stamps_ns,
                           const ChannelSamples& dut, const OwnClockUncertainty& clock,
                           StepFindings& findings) {
  DYNCAL_TRY(auto sensor, fit_weak_channel(pilot.frequency, dut_stamps_ns, dut));
  const std::optional<RatioInBlocks> ratio = ratio_in_blocks(
      sensor, link, static_cast<double>(dut_stamps_ns.front() - pilot_first_ns) * 1e-9);
  const double turns =
      pilot.frequency.reduced_turns(sensor.result.phase_origin_ns - pilot.phase_origin_ns);
  Budget budget;
  add_sensor_rows(budget, sensor, clock.stamp_jitter_s);
  add_jitter(budget, pilot.frequency.angular(), clock.stamp_jitter_s,
             static_cast<double>(sensor.result.fit.samples));
  budget.append(link.noise);
  add_ratio_rows(budget, ratio, budget.u_magnitude_rel(), budget.u_phase_rad());
  // The middles of the two records are apart: an error of the frequency turns one against the
  // other.
  const double distance_s =
      static_cast<double>(sensor.result.phase_origin_ns - pilot.phase_origin_ns) * 1e-9;
  budget.add({.kind = ContributionKind::record_frequency,
              .degrees_of_freedom = pilot.fit.degrees_of_freedom,
              .u_phase_rad = 2.0 * std::numbers::pi * pilot.u_frequency_hz * std::abs(distance_s)});
  budget.add({.kind = ContributionKind::clock_offset,
              .u_phase_rad = pilot.frequency.angular() * clock.clock_offset_s});
  add_beat_rows(budget, "the sensor's", pilot.frequency.angular(), clock.stamp_beat, {});
  budget.append(link.systematic);
  findings.points.push_back(findings_of(ratio, link.noise_unknown || sensor.noise_unknown));
  add_knock(sensor, findings);
  return transfer_point(
      sensor, link.link * factor_of(ratio) * std::polar(1.0, -2.0 * std::numbers::pi * turns),
      budget);
}

} // namespace dyncal::analysis
