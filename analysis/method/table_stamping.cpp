#include "analysis/method/table_stamping.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include "analysis/base/phasor.hpp"
#include "analysis/method/blocks_of_clock.hpp"
#include "analysis/method/channels_of_one_clock.hpp"
#include "analysis/method/dau_rows.hpp"
#include "analysis/uncertainty/block_drift.hpp"

namespace dyncal::analysis {
namespace {

bool is_uncertainty(double u) {
  return std::isfinite(u) && u >= 0.0;
}

Expected<void> check(const EvaluatedReference& reference) {
  if (!(reference.amplitude > 0.0) || !std::isfinite(reference.amplitude) ||
      !std::isfinite(reference.phase_rad) || !is_uncertainty(reference.u_amplitude) ||
      !is_uncertainty(reference.u_phase_rad)) {
    return fail(ErrorCode::invalid_argument, reference.channel + " has no value");
  }
  return {};
}

ChannelFit fit_of(const Frequency& frequency, const std::string& channel) {
  ChannelFit fit{.channel = channel, .frequency = frequency, .fit = {}};
  fit.fit.degrees_of_freedom = std::numeric_limits<double>::infinity();
  return fit;
}

Budget common_rows(const SampleStampingInput& input, const EvaluatedReference& reference,
                   const RecordedChannel& sync_dau) {
  Budget budget;
  budget.add({.kind = ContributionKind::fit_noise,
              .subject = "the reference's table",
              .repeats = Repeats::common,
              .u_magnitude_rel = reference.u_amplitude / reference.amplitude,
              .u_phase_rad = reference.u_phase_rad});
  add_dau_sync_noise(budget, sync_dau, input.systematic);
  return budget;
}

Budget systematic_rows(const SampleStampingInput& input, const RecordedChannel& sync_dau) {
  Budget budget;
  add_dau_adc_rows(budget, input, sync_dau);
  budget.add({.kind = ContributionKind::channel_delay,
              .subject = "the ACS channels",
              .u_phase_rad = input.frequency.angular() * input.systematic.acs_delay_s});
  budget.add({.kind = ContributionKind::reference,
              .u_magnitude_rel = input.systematic.reference_magnitude_rel,
              .u_phase_rad = input.systematic.reference_phase_rad});
  for (const ReferenceContribution& one : input.reference_response.contributions) {
    budget.add({.kind = ContributionKind::reference,
                .subject = one.name,
                .distribution = one.distribution,
                .degrees_of_freedom = one.degrees_of_freedom,
                .u_magnitude_rel = one.u_magnitude_rel,
                .u_phase_rad = one.u_phase_rad});
  }
  return budget;
}

void add_simultaneity(Budget& budget, const std::optional<BlockSeries>& blocks, bool same_window) {
  if (blocks && !same_window) {
    const BlockDrift drift = drift_of(*blocks);
    budget.add({.kind = ContributionKind::simultaneity,
                .u_magnitude_rel = drift.magnitude_rel,
                .u_phase_rad = drift.phase_rad});
  }
}

// H but for P_dos.
std::complex<double> link_of(const SampleStampingInput& input, const EvaluatedReference& reference,
                             const RecordedChannel& sync_dau) {
  const double phase_rad = reference.phase_rad - input.adc.phase_lag_rad -
                           input.frequency.angular() * input.reference_delay_s;
  return std::polar(1.0, phase_rad) / unit_phasor(sync_dau.phasor()) *
         input.reference_response.phasor() / reference.amplitude;
}

} // namespace

ChannelFit reference_fit(const Frequency& frequency, const EvaluatedReference& reference) {
  ChannelFit fit = fit_of(frequency, reference.channel);
  fit.fit.sine = reference.amplitude;
  fit.fit.covariance[0] = reference.u_amplitude * reference.u_amplitude;
  fit.fit.covariance[3] = std::pow(reference.amplitude * reference.u_phase_rad, 2);
  return fit;
}

ChannelFit reference_sync_fit(const Frequency& frequency, const EvaluatedReference& reference) {
  ChannelFit fit = fit_of(frequency, reference.sync_channel);
  fit.fit.sine = std::cos(reference.phase_rad);
  fit.fit.cosine = std::sin(reference.phase_rad);
  return fit;
}

Expected<SampleStampingResult> evaluate_table_stamping(const SampleStampingInput& input,
                                                       const EvaluatedReference& reference) {
  DYNCAL_TRY(check(reference));
  DYNCAL_TRY(auto dau, fit_channels_of_one_clock(input.frequency, input.frequency_search_rel,
                                                 input.dau_stamps_ns, input.sync_dau, input.dut));
  const BlocksOfClock blocks = learn_from_blocks(dau);
  const std::complex<double> link = link_of(input, reference, dau.pilot);
  const StampBeat beat =
      stamp_beat(input.frequency, input.dau_stamps_ns, input.systematic.dau_tick_s);
  const Budget common = common_rows(input, reference, dau.pilot);
  const Budget systematic = systematic_rows(input, dau.pilot);
  SampleStampingResult result{reference_fit(input.frequency, reference),
                              reference_sync_fit(input.frequency, reference),
                              dau.pilot.result,
                              {},
                              {}};
  for (std::size_t i = 0; i < dau.others.size(); ++i) {
    const RecordedChannel& dut = dau.others[i];
    Budget budget;
    add_sensor_rows(budget, dut, common_jitter_s(input.systematic));
    add_dau_stamp_noise(budget, input, dut, dau.pilot, beat);
    budget.append(common);
    add_simultaneity(budget, blocks.beside_pilot(i), reference.same_window);
    budget.append(systematic);
    result.points.push_back(transfer_point(dut, link, budget));
    result.findings.points.push_back({std::nullopt, dut.noise_unknown});
    add_knock(dut, result.findings);
  }
  return result;
}

} // namespace dyncal::analysis
