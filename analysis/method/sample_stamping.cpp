#include "analysis/method/sample_stamping.hpp"

#include <algorithm>
#include <cmath>

#include "analysis/base/phasor.hpp"
#include "analysis/method/channels_of_one_clock.hpp"
#include "analysis/method/own_clock_channel.hpp"
#include "analysis/uncertainty/ratio_scatter.hpp"

namespace dyncal::analysis {
namespace {

double common_jitter_s(const SystematicUncertainty& systematic) {
  return std::max(systematic.dau_jitter_s, systematic.dau_tick_s / std::sqrt(12.0));
}

// Rows of the reference side and of the corrections, the same for every channel of the sensor.
Budget common_budget(const SampleStampingInput& input, const ChannelsOfOneClock& acs,
                     const RecordedChannel& sync_dau) {
  const SystematicUncertainty& systematic = input.systematic;
  const RecordedChannel& reference = acs.others.front();
  const double w = input.frequency.angular();
  Budget budget;
  add_signal_rows(budget, "the reference", reference, 0.0, CountsIn::magnitude_and_phase);
  add_signal_rows(budget, "the ACS sync", acs.pilot, 0.0, CountsIn::phase);
  budget.add_excess("the reference",
                    ratio_scatter(reference.result.frequency, input.acs_stamps_ns,
                                  reference.values(), acs.pilot.values()),
                    budget.u_magnitude_rel(), budget.u_phase_rad());
  add_signal_rows(budget, "the DAU sync", sync_dau,
                  std::hypot(systematic.sync_adc_jitter_s, common_jitter_s(systematic)),
                  CountsIn::phase);
  budget.add({.kind = ContributionKind::sync_jitter,
              .u_phase_rad = std::sqrt(1.5 / static_cast<double>(sync_dau.result.fit.samples)) * w *
                             systematic.sync_adc_jitter_s});
  budget.add({.kind = ContributionKind::adc_phase, .u_phase_rad = input.adc.u_phase_lag_rad});
  budget.add({.kind = ContributionKind::channel_delay,
              .subject = "the ACS channels",
              .u_phase_rad = w * systematic.acs_delay_s});
  add_reference_rows(budget, input.reference_response, systematic.reference_magnitude_rel,
                     systematic.reference_phase_rad);
  return budget;
}

// Stamp noise common to sync and the sensor: the phase of the ratio sees it only as far as the two
// sines differ in phase.
void add_stamp_noise(Budget& budget, const SampleStampingInput& input, const RecordedChannel& dut,
                     const RecordedChannel& sync_dau) {
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
}

TransferPoint evaluate_channel(const SampleStampingInput& input, const RecordedChannel& dut,
                               const RecordedChannel& sync_dau, std::complex<double> link,
                               const Budget& common) {
  Budget budget;
  add_sensor_rows(budget, dut, common_jitter_s(input.systematic));
  add_stamp_noise(budget, input, dut, sync_dau);
  budget.add_excess(
      "the sensor's signal",
      ratio_scatter(dut.result.frequency, input.dau_stamps_ns, dut.values(), sync_dau.values()),
      budget.u_magnitude_rel(),
      std::hypot(budget.u_phase_rad(), sync_dau.result.fit.u_phase_rad()));
  budget.append(common);
  return transfer_point(dut, link, budget);
}

} // namespace

Expected<SampleStampingResult> evaluate_sample_stamping(const SampleStampingInput& input) {
  const auto acs =
      fit_channels_of_one_clock(input.frequency, input.frequency_search_rel, input.acs_stamps_ns,
                                input.sync_acs, std::span(&input.reference, 1));
  if (!acs) {
    return fail(acs.error());
  }
  const bool own_clock = !input.dut_stamps_ns.empty();
  const auto dau = fit_channels_of_one_clock(
      input.frequency, input.frequency_search_rel, input.dau_stamps_ns, input.sync_dau,
      own_clock ? std::span<const ChannelSamples>{} : std::span<const ChannelSamples>(input.dut));
  if (!dau) {
    return fail(dau.error());
  }
  const RecordedChannel& reference = acs->others.front();
  if (const auto excited = require_excitation(reference); !excited) {
    return fail(excited.error());
  }

  // Eq. (4): H = P_dos / P_ref * U(P_sync_acs) / U(P_sync_dau,true), P_sync_dau,true = P_sync_dau /
  // G.
  const std::complex<double> adc = std::polar(1.0, -input.adc.phase_lag_rad);
  const std::complex<double> late =
      std::polar(1.0, input.frequency.angular() * input.reference_delay_s);
  const std::complex<double> link = unit_phasor(acs->pilot.phasor()) /
                                    (unit_phasor(dau->pilot.phasor()) / adc) /
                                    (reference.phasor() * late / input.reference_response.phasor());

  const Budget common = common_budget(input, *acs, dau->pilot);
  SampleStampingResult result{reference.result, acs->pilot.result, dau->pilot.result, {}};
  for (const RecordedChannel& dut : dau->others) {
    result.points.push_back(evaluate_channel(input, dut, dau->pilot, link, common));
  }
  if (!own_clock) {
    return result;
  }
  for (const ChannelSamples& dut : input.dut) {
    auto point = evaluate_own_clock_channel(
        dau->pilot.result, link, common, input.dut_stamps_ns, dut,
        {.clock_offset_s = input.systematic.clock_offset_s, .stamp_jitter_s = 0.0});
    if (!point) {
      return fail(point.error());
    }
    result.points.push_back(std::move(*point));
  }
  return result;
}

} // namespace dyncal::analysis
