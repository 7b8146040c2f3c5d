#include "analysis/analogue_comparison.hpp"

#include <cmath>
#include <numbers>

#include "analysis/phasor.hpp"
#include "analysis/ratio_scatter.hpp"
#include "analysis/recorded_system.hpp"

namespace dyncal::analysis {
namespace {

Budget systematic_rows(const RecordedSeries& reference, double w, const ComparisonUncertainty& systematic) {
  Budget budget;
  add_signal_rows(budget, "the reference", reference, 0.0, CountsIn::magnitude_and_phase);
  budget.add("delay between the channels", "normal", 0.0, 0.0, w * systematic.channel_delay_s);
  budget.add("offset between the clocks", "normal", 0.0, 0.0, w * systematic.clock_offset_s);
  budget.add("reference", "normal", 0.0, systematic.reference_magnitude_rel, systematic.reference_phase_rad);
  return budget;
}

// White stamp noise of one channel alone: multiplicative, so phase and amplitude take unequal shares.
void add_jitter(Budget& budget, double w, double jitter_s, double samples) {
  const double angle = w * jitter_s;
  budget.add("jitter of the stamps", "normal", 0.0, std::hypot(std::sqrt(0.5 / samples) * angle, 0.5 * angle * angle),
             std::sqrt(1.5 / samples) * angle);
}

} // namespace

Expected<ComparisonResult> evaluate_analogue(const AnalogueInput& input) {
  const auto system = evaluate_system(input.frequency, input.frequency_search_rel, input.stamps_ns, input.reference, input.dut);
  if (!system) return tl::unexpected(system.error());
  const RecordedSeries& reference = system->pilot;
  const double w = reference.result.frequency.angular();
  const std::complex<double> link = std::polar(1.0, w * input.channel_delay_s) / reference.phasor();
  const Budget common = systematic_rows(reference, w, input.systematic);
  ComparisonResult result{reference.result, {}};
  for (const RecordedSeries& dut : system->others) {
    Budget budget;
    add_sensor_rows(budget, dut, 0.0);
    budget.append(common);
    budget.add_excess("structure in the signals",
                      ratio_scatter(reference.result.frequency, input.stamps_ns, dut.values(), reference.values()),
                      budget.u_magnitude_rel(), budget.u_phase_rad());
    result.points.push_back(transfer_point(dut, link, budget));
  }
  return result;
}

Expected<ComparisonResult> evaluate_absolute_time(const AbsoluteTimeInput& input) {
  const auto acs = evaluate_system(input.frequency, input.frequency_search_rel, input.reference_stamps_ns, input.reference, {});
  if (!acs) return tl::unexpected(acs.error());
  const RecordedSeries& reference = acs->pilot;
  const Frequency& frequency = reference.result.frequency;
  ComparisonResult result{reference.result, {}};
  const double w = frequency.angular();
  const Budget common = systematic_rows(reference, w, input.systematic);
  for (const ChannelSamples& channel : input.dut) {
    const auto sensor = evaluate_weak_series(frequency, input.dut_stamps_ns, channel);
    if (!sensor) return tl::unexpected(sensor.error());
    // From the reference's instant to the sensor's, in whole nanoseconds on the common scale.
    const double turns = frequency.reduced_turns(sensor->result.reference_ns - reference.result.reference_ns);
    const std::complex<double> moved = reference.phasor() * std::polar(1.0, 2.0 * std::numbers::pi * turns);
    const std::complex<double> link = std::polar(1.0, w * input.channel_delay_s) / moved;
    Budget budget;
    add_sensor_rows(budget, *sensor, input.systematic.stamp_jitter_s);
    add_jitter(budget, w, input.systematic.stamp_jitter_s, static_cast<double>(sensor->result.fit.samples));
    // The middles of the two records are apart: an error of the frequency turns one against the other.
    const double apart_s = static_cast<double>(sensor->result.reference_ns - reference.result.reference_ns) * 1e-9;
    budget.add("frequency between the records", "normal", reference.result.fit.degrees_of_freedom, 0.0,
               2.0 * std::numbers::pi * reference.result.u_frequency_hz * std::abs(apart_s));
    budget.append(common);
    result.points.push_back(transfer_point(*sensor, link, budget));
  }
  return result;
}

} // namespace dyncal::analysis
