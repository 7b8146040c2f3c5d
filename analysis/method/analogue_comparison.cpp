#include "analysis/method/analogue_comparison.hpp"

#include <cmath>

#include "analysis/base/phasor.hpp"
#include "analysis/method/blocks_of_clock.hpp"
#include "analysis/method/channels_of_one_clock.hpp"
#include "analysis/method/own_clock_channel.hpp"
#include "analysis/method/stamp_rows.hpp"

namespace dyncal::analysis {
namespace {

Budget noise_of(const RecordedChannel& reference) {
  Budget budget;
  add_signal_rows(budget, "the reference", reference, 0.0, CountsIn::magnitude_and_phase);
  return budget;
}

template <class Input>
Budget systematic_rows(const Input& input, const RecordedChannel& reference) {
  const ComparisonUncertainty& systematic = input.systematic;
  Budget budget;
  budget.add({.kind = ContributionKind::channel_delay,
              .subject = "the channels",
              .u_phase_rad = reference.result.frequency.angular() * systematic.channel_delay_s});
  add_reference_rows(budget, reference, input.frequency, input.reference_response,
                     systematic.reference_magnitude_rel, systematic.reference_phase_rad);
  return budget;
}

// The pilot is sync, with the reference as the first of the others; without sync the reference.
Expected<ChannelsOfOneClock> fit_analogue(const AnalogueInput& input) {
  std::vector<ChannelSamples> others = input.dut;
  if (input.sync) {
    others.insert(others.begin(), input.reference);
  }
  return fit_channels_of_one_clock(input.frequency, input.frequency_search_rel, input.stamps_ns,
                                   input.sync.value_or(input.reference), others);
}

} // namespace

Expected<ComparisonResult> evaluate_analogue(const AnalogueInput& input) {
  DYNCAL_TRY(auto system, fit_analogue(input));
  const BlocksOfClock blocks = learn_from_blocks(system);
  const bool by_sync = input.sync.has_value();
  const RecordedChannel& reference = by_sync ? system.others.front() : system.pilot;
  DYNCAL_TRY(require_excitation(reference));
  const double w = reference.result.frequency.angular();
  const std::complex<double> link = std::polar(1.0, w * input.channel_delay_s) /
                                    reference.excitation() * input.reference_response.phasor();
  const Budget noise = noise_of(reference);
  const Budget systematic = systematic_rows(input, reference);
  ComparisonResult result{
      reference.result, by_sync ? std::optional(system.pilot.result) : std::nullopt, {}, {}};
  add_knock(reference, result.findings);
  const StampBeat beat = stamp_beat(input.frequency, input.stamps_ns);
  const std::optional<BlockSeries>& denominator = by_sync ? blocks.others.front() : blocks.pilot;
  for (std::size_t i = by_sync ? 1 : 0; i < system.others.size(); ++i) {
    const RecordedChannel& dut = system.others[i];
    Budget budget;
    add_sensor_rows(budget, dut, 0.0);
    budget.append(noise);
    const auto ratio = compare(blocks.others[i], denominator, {});
    add_ratio_rows(budget, ratio, budget.u_magnitude_rel(), budget.u_phase_rad());
    add_beat_rows(budget, "the", w, beat,
                  reach_on_ratio(dut.result.fit.phase_rad(), reference.result.fit.phase_rad()));
    budget.append(systematic);
    result.points.push_back(transfer_point(dut, link * factor_of(ratio), budget));
    result.findings.points.push_back(
        findings_of(ratio, dut.noise_unknown || reference.noise_unknown));
    add_knock(dut, result.findings);
  }
  return result;
}

Expected<ComparisonResult> evaluate_absolute_time(const AbsoluteTimeInput& input) {
  DYNCAL_TRY(auto acs, fit_channels_of_one_clock(input.frequency, input.frequency_search_rel,
                                                 input.reference_stamps_ns, input.reference, {}));
  const BlocksOfClock blocks = learn_from_blocks(acs);
  const RecordedChannel& reference = acs.pilot;
  ComparisonResult result{reference.result, std::nullopt, {}, {}};
  add_knock(reference, result.findings);
  const double w = reference.result.frequency.angular();
  const Budget noise = noise_of(reference);
  Budget systematic = systematic_rows(input, reference);
  add_beat_rows(
      systematic, "the reference's", w,
      stamp_beat(input.frequency, input.reference_stamps_ns, input.systematic.reference_tick_s),
      {});
  const std::complex<double> link = std::polar(1.0, w * input.channel_delay_s) /
                                    reference.excitation() * input.reference_response.phasor();
  const OwnClockUncertainty clock{
      .clock_offset_s = input.systematic.clock_offset_s,
      .stamp_jitter_s = input.systematic.stamp_jitter_s,
      .stamp_beat = stamp_beat(input.frequency, input.dut_stamps_ns, input.systematic.dut_tick_s)};
  for (const ChannelSamples& channel : input.dut) {
    DYNCAL_TRY(auto point,
               evaluate_own_clock_channel(reference.result, input.reference_stamps_ns.front(),
                                          {.link = link,
                                           .noise = noise,
                                           .systematic = systematic,
                                           .reference = reference,
                                           .sync = std::nullopt,
                                           .denominator = blocks.pilot,
                                           .alignment = {},
                                           .noise_unknown = reference.noise_unknown},
                                          input.dut_stamps_ns, channel, clock, result.findings));
    result.points.push_back(std::move(point));
  }
  return result;
}

} // namespace dyncal::analysis
