#include "analysis/method/sample_stamping.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "analysis/base/phasor.hpp"
#include "analysis/clock/stamp_beat.hpp"
#include "analysis/method/blocks_of_clock.hpp"
#include "analysis/method/channels_of_one_clock.hpp"
#include "analysis/method/clock_link.hpp"
#include "analysis/method/dau_rows.hpp"
#include "analysis/method/own_clock_channel.hpp"
#include "analysis/method/stamp_rows.hpp"

namespace dyncal::analysis {
namespace {

// Noise of sync in both clocks.
Budget noise_of_sync(const SampleStampingInput& input, const RecordedChannel& sync_acs,
                     const RecordedChannel& sync_dau) {
  Budget budget;
  add_signal_rows(budget, "the ACS sync", sync_acs, 0.0, CountsIn::phase);
  add_dau_sync_noise(budget, sync_dau, input.systematic);
  return budget;
}

// Of the way of sync to the DAU's samples.
Budget sync_corrections(const SampleStampingInput& input, const RecordedChannel& sync_dau) {
  Budget budget;
  add_dau_adc_rows(budget, input, sync_dau);
  return budget;
}

std::optional<ClockLink> clock_link_of(const SampleStampingInput& input,
                                       const RecordedChannel& sync_acs,
                                       const RecordedChannel& sync_dau) {
  if (!input.u_utc_s) {
    return std::nullopt;
  }
  Budget sync = noise_of_sync(input, sync_acs, sync_dau);
  sync.append(sync_corrections(input, sync_dau));
  return link_of_clocks(sync_acs, sync_dau, input.adc.phase_lag_rad, sync, *input.u_utc_s);
}

// Noise of the channels that all channels of the sensor share.
Budget common_noise(const SampleStampingInput& input, const ChannelsOfOneClock& acs,
                    const RecordedChannel& sync_dau, const std::optional<ClockLink>& clocks) {
  Budget budget;
  add_signal_rows(budget, "the reference", acs.others.front(), 0.0, CountsIn::magnitude_and_phase);
  budget.append(as_far_as_sync_counts(noise_of_sync(input, acs.pilot, sync_dau), clocks));
  return budget;
}

// Rows of the corrections, the same for every channel of the sensor.
Budget systematic_rows(const SampleStampingInput& input, const ChannelsOfOneClock& acs,
                       const RecordedChannel& sync_dau, const StampBeat& dau_beat,
                       const std::optional<ClockLink>& clocks) {
  const SystematicUncertainty& systematic = input.systematic;
  const double w = input.frequency.angular();
  Budget budget = as_far_as_sync_counts(sync_corrections(input, sync_dau), clocks);
  if (clocks) {
    budget.add(
        {.kind = ContributionKind::clock_offset, .u_phase_rad = w * clocks->u_by_stamps_s()});
  }
  budget.add({.kind = ContributionKind::channel_delay,
              .subject = "the ACS channels",
              .u_phase_rad = w * systematic.acs_delay_s});
  add_reference_rows(budget, acs.others.front(), input.frequency, input.reference_response,
                     systematic.reference_magnitude_rel, systematic.reference_phase_rad);
  const BeatReach reach =
      reach_on_ratio(acs.others.front().result.fit.phase_rad(), acs.pilot.result.fit.phase_rad());
  add_beat_rows(
      budget, "the ACS", w, stamp_beat(input.frequency, input.acs_stamps_ns),
      {.in_step_magnitude = 1.0, .in_step_phase = reach.in_step_phase, .on_average = 0.0});
  if (!input.dut_stamps_ns.empty()) {
    add_beat_rows(budget, "the DAU", w, dau_beat,
                  {.in_step_magnitude = 0.0, .in_step_phase = 1.0, .on_average = 1.0});
  }
  return budget;
}

// The records of the two clocks begin where the search found their step, in frames of a grid of
// each clock's own (excitation_window.hpp): up to one frame apart. Sync says the rest, modulo a
// period.
BlockAlignment alignment_of(const SampleStampingInput& input, const ChannelsOfOneClock& acs,
                            const RecordedChannel& sync_dau) {
  constexpr double frame_s = 0.1;
  constexpr double frame_periods = 50.0;
  const auto turns_at_begin = [](const RecordedChannel& sync) {
    const ChannelFit& fit = sync.result;
    return fit.fit.phase_rad() / (2.0 * std::numbers::pi) +
           fit.frequency.reduced_turns(sync.stamps_ns.front() - fit.phase_origin_ns);
  };
  const double lag_turns = input.adc.phase_lag_rad / (2.0 * std::numbers::pi);
  const double period_s = 1.0 / sync_dau.result.frequency.hz();
  return {.offset_s = (turns_at_begin(sync_dau) + lag_turns - turns_at_begin(acs.pilot)) * period_s,
          .period_s = period_s,
          .reach_s = std::max(period_s, std::min(frame_s, frame_periods * period_s))};
}

// What all channels of the sensor are compared with.
struct Comparison {
  std::complex<double> link;
  const Budget& noise;
  const Budget& systematic;
  const RecordedChannel& reference;
  std::optional<BlockSeries> blocks;
  BlockAlignment alignment;
  bool noise_unknown = false;
  StampBeat stamp_beat{}; // of the DAU's stamps
};

TransferPoint evaluate_channel(const SampleStampingInput& input, const RecordedChannel& dut,
                               const RecordedChannel& sync_dau,
                               const std::optional<BlockSeries>& blocks, const Comparison& with,
                               StepFindings& findings) {
  Budget budget;
  add_sensor_rows(budget, dut, common_jitter_s(input.systematic));
  add_dau_stamp_noise(budget, input, dut, sync_dau, with.stamp_beat);
  budget.append(with.noise);
  BlockAlignment alignment = with.alignment;
  alignment.seen = seen_offset(dut, with.reference);
  const auto ratio = compare(blocks, with.blocks, alignment);
  add_ratio_rows(budget, ratio, budget.u_magnitude_rel(), budget.u_phase_rad());
  budget.append(with.systematic);
  findings.points.push_back(findings_of(ratio, dut.noise_unknown || with.noise_unknown));
  return transfer_point(dut, with.link * factor_of(ratio), budget);
}

// Eq. (4): H = P_dos / P_ref * U(P_sync_acs) / U(P_sync_dau,true), P_sync_dau,true = P_sync_dau /
// G; all of it but P_dos.
std::complex<double> link_of(const SampleStampingInput& input, const ChannelsOfOneClock& acs,
                             const RecordedChannel& sync_dau,
                             const std::optional<ClockLink>& clocks) {
  const std::complex<double> adc = std::polar(1.0, -input.adc.phase_lag_rad);
  const std::complex<double> late =
      std::polar(1.0, input.frequency.angular() * input.reference_delay_s);
  const std::complex<double> by_sync =
      unit_phasor(acs.pilot.phasor()) / (unit_phasor(sync_dau.phasor()) / adc) /
      (acs.others.front().excitation() * late / input.reference_response.phasor());
  return clocks ? by_sync * clocks->factor(input.frequency.angular()) : by_sync;
}

// Of a sensor with a clock of its own.
Expected<void> add_own_clock_points(const SampleStampingInput& input, const RecordedChannel& pilot,
                                    const BlocksOfClock& dau_blocks, const Comparison& with,
                                    SampleStampingResult& result) {
  const StampBeat dut_beat =
      stamp_beat(input.frequency, input.dut_stamps_ns, input.systematic.dut_tick_s);
  for (const ChannelSamples& dut : input.dut) {
    DYNCAL_TRY(auto point,
               evaluate_own_clock_channel(pilot.result, input.dau_stamps_ns.front(),
                                          {.link = with.link,
                                           .noise = with.noise,
                                           .systematic = with.systematic,
                                           .reference = with.reference,
                                           .sync = dau_blocks.pilot,
                                           .denominator = with.blocks,
                                           .alignment = with.alignment,
                                           .noise_unknown = with.noise_unknown},
                                          input.dut_stamps_ns, dut,
                                          {.clock_offset_s = input.systematic.clock_offset_s,
                                           .stamp_jitter_s = 0.0,
                                           .stamp_beat = dut_beat},
                                          result.findings));
    result.points.push_back(std::move(point));
  }
  return {};
}

} // namespace

Expected<SampleStampingResult> evaluate_sample_stamping(const SampleStampingInput& input) {
  DYNCAL_TRY(auto acs, fit_channels_of_one_clock(input.frequency, input.frequency_search_rel,
                                                 input.acs_stamps_ns, input.sync_acs,
                                                 std::span(&input.reference, 1)));
  const bool own_clock = !input.dut_stamps_ns.empty();
  DYNCAL_TRY(auto dau,
             fit_channels_of_one_clock(input.frequency, input.frequency_search_rel,
                                       input.dau_stamps_ns, input.sync_dau,
                                       own_clock ? std::span<const ChannelSamples>{}
                                                 : std::span<const ChannelSamples>(input.dut)));
  const RecordedChannel& reference = acs.others.front();
  DYNCAL_TRY(require_excitation(reference));

  const BlocksOfClock acs_blocks = learn_from_blocks(acs);
  const BlocksOfClock dau_blocks = learn_from_blocks(dau);

  const std::optional<ClockLink> clocks = clock_link_of(input, acs.pilot, dau.pilot);
  const std::complex<double> link = link_of(input, acs, dau.pilot, clocks);
  const Budget noise = common_noise(input, acs, dau.pilot, clocks);
  const StampBeat dau_beat =
      stamp_beat(input.frequency, input.dau_stamps_ns, input.systematic.dau_tick_s);
  const Budget systematic = systematic_rows(input, acs, dau.pilot, dau_beat, clocks);
  const Comparison with{.link = link,
                        .noise = noise,
                        .systematic = systematic,
                        .reference = reference,
                        .blocks = acs_blocks.beside_pilot(0),
                        .alignment = alignment_of(input, acs, dau.pilot),
                        .noise_unknown = reference.noise_unknown,
                        .stamp_beat = dau_beat};
  SampleStampingResult result{reference.result, acs.pilot.result, dau.pilot.result, {}, {}};
  result.findings.clock_link = clocks;
  add_knock(reference, result.findings);
  for (std::size_t i = 0; i < dau.others.size(); ++i) {
    result.points.push_back(evaluate_channel(input, dau.others[i], dau.pilot,
                                             dau_blocks.beside_pilot(i), with, result.findings));
    add_knock(dau.others[i], result.findings);
  }
  if (own_clock) {
    DYNCAL_TRY(add_own_clock_points(input, dau.pilot, dau_blocks, with, result));
  }
  return result;
}

} // namespace dyncal::analysis
