#include "analysis/method/own_clock_channel.hpp"

#include <cmath>
#include <numbers>

#include "analysis/method/channels_of_one_clock.hpp"

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

} // namespace

Expected<TransferPoint> evaluate_own_clock_channel(const ChannelFit& pilot,
                                                   std::complex<double> link, const Budget& common,
                                                   std::span<const std::int64_t> dut_stamps_ns,
                                                   const ChannelSamples& dut,
                                                   const OwnClockUncertainty& clock) {
  const auto sensor = fit_weak_channel(pilot.frequency, dut_stamps_ns, dut);
  if (!sensor) {
    return fail(sensor.error());
  }
  const double turns =
      pilot.frequency.reduced_turns(sensor->result.phase_origin_ns - pilot.phase_origin_ns);
  Budget budget;
  add_sensor_rows(budget, *sensor, clock.stamp_jitter_s);
  add_jitter(budget, pilot.frequency.angular(), clock.stamp_jitter_s,
             static_cast<double>(sensor->result.fit.samples));
  // The middles of the two records are apart: an error of the frequency turns one against the
  // other.
  const double distance_s =
      static_cast<double>(sensor->result.phase_origin_ns - pilot.phase_origin_ns) * 1e-9;
  budget.add({.kind = ContributionKind::record_frequency,
              .degrees_of_freedom = pilot.fit.degrees_of_freedom,
              .u_phase_rad = 2.0 * std::numbers::pi * pilot.u_frequency_hz * std::abs(distance_s)});
  budget.add({.kind = ContributionKind::clock_offset,
              .u_phase_rad = pilot.frequency.angular() * clock.clock_offset_s});
  budget.append(common);
  return transfer_point(*sensor, link * std::polar(1.0, -2.0 * std::numbers::pi * turns), budget);
}

} // namespace dyncal::analysis
