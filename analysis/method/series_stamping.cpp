#include "analysis/method/series_stamping.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "analysis/base/phasor.hpp"
#include "analysis/method/blocks_of_clock.hpp"
#include "analysis/method/channels_of_one_clock.hpp"
#include "analysis/method/trigger_phase.hpp"
#include "analysis/sine/disturbances.hpp"
#include "analysis/sine/equidistant_axis.hpp"
#include "analysis/uncertainty/found_resolution.hpp"
#include "analysis/uncertainty/quantisation.hpp"

namespace dyncal::analysis {
namespace {

Error of_shot(std::size_t shot, const std::string& what, Error error) {
  error.message = "shot " + std::to_string(shot + 1) + ", " + what + ": " + error.message;
  return error;
}

std::optional<Error> problem_with(const SeriesStampingInput& input) {
  if (input.shots.empty() || input.channels.empty()) {
    return Error{ErrorCode::invalid_argument,
                 "series time stamping needs at least one shot and one channel"};
  }
  if (!(input.nominal_rate_hz > 0.0)) {
    return Error{ErrorCode::invalid_argument, "the nominal rate of the series must be positive"};
  }
  for (std::size_t j = 0; j < input.shots.size(); ++j) {
    const SeriesShot& shot = input.shots[j];
    if (!(shot.dso_interval_s > 0.0)) {
      return of_shot(j, "oscilloscope",
                     {ErrorCode::invalid_argument, "its sample interval must be positive"});
    }
    if (shot.series.size() != input.channels.size()) {
      return of_shot(j, "series", {ErrorCode::invalid_argument, "a channel is missing"});
    }
    for (const auto& samples : shot.series) {
      if (samples.size() != input.shots.front().series.front().size()) {
        return of_shot(
            j, "series",
            {ErrorCode::invalid_argument, "all series of a step must have the same length"});
      }
    }
  }
  return std::nullopt;
}

SyncTrace trace_of(const SeriesShot& shot) {
  return {shot.dso_first_s, shot.dso_interval_s, shot.dso_sync};
}

std::vector<std::span<const double>> shots_of_channel(const SeriesStampingInput& input,
                                                      std::size_t channel) {
  std::vector<std::span<const double>> result;
  for (const SeriesShot& shot : input.shots) {
    result.push_back(shot.series[channel]);
  }
  return result;
}

Error of_channel(const std::string& channel, Error error) {
  error.message = channel + ": " + error.message;
  return error;
}

// One shot's H with what is random in it and what all shots share.
Repetition shot_result(const SineFit& series, const TriggerPhase& trigger, bool correct_trigger,
                       std::complex<double> link, double u_phase_start, const Budget& common) {
  const double u_amplitude = series.u_amplitude();
  const double snr = u_amplitude > 0.0 ? series.amplitude() / u_amplitude : 1e12;
  Repetition result;
  result.h = std::complex<double>(series.sine, series.cosine) * link;
  if (correct_trigger) {
    result.h /= unit_phasor(trigger.sync);
  }
  result.u_random_magnitude_rel = 1.0 / std::max(snr, 1e-6);
  const double u_series = snr < 10.0 ? phase_standard_uncertainty(snr) : series.u_phase_rad();
  result.u_random_phase_rad = std::hypot(std::hypot(u_series, trigger.u_rad), u_phase_start);
  result.u_common_magnitude_rel = common.u_magnitude_rel();
  result.u_common_phase_rad = common.u_phase_rad();
  return result;
}

// Steps of the sensor's converter that its noise does not hide, at their largest over the shots:
// they err alike in all of them.
Contribution quantisation_row(const SeriesStampingInput& input, std::size_t channel,
                              const std::vector<CleanedFit>& fits, const Frequency& apparent,
                              std::span<const std::int64_t> stamps_ns) {
  Contribution row{.kind = ContributionKind::quantisation,
                   .subject = "the sensor",
                   .distribution = Distribution::rectangular};
  for (std::size_t j = 0; j < fits.size(); ++j) {
    const SineFit& fit = fits[j].fit;
    const QuantisationUncertainty steps = quantisation_uncertainty(
        fit.amplitude(), fit.residual_sd(), found_resolution(input.shots[j].series[channel]),
        apparent, stamps_ns);
    if (fit.amplitude() > 0.0) {
      row.u_magnitude_rel = std::max(row.u_magnitude_rel, steps.u_amplitude / fit.amplitude());
      row.u_phase_rad = std::max(row.u_phase_rad, steps.u_phase_rad);
    }
  }
  return row;
}

// By how much an error of the oscilloscope's clock turns sync between the middle of a trace and its
// trigger point, where it was fitted.
double u_trace_clock_rad(const SeriesStampingInput& input, double w) {
  if (!input.correct_trigger_phase) {
    return 0.0;
  }
  double longest_s = 0.0;
  for (const SeriesShot& shot : input.shots) {
    const double half_s = 0.5 * static_cast<double>(shot.dso_sync.size()) * shot.dso_interval_s;
    longest_s = std::max(longest_s, std::abs(shot.dso_first_s + half_s));
  }
  return w * longest_s * input.u_dso_rate_rel;
}

// What harmonics of sync, as the ACS saw them, do to a trace too short to show them: their phase
// against the fundamental is any.
double u_distorted_trace_rad(const SeriesStampingInput& input, const ChannelFit& sync_acs) {
  if (!input.correct_trigger_phase || !sync_acs.integrity) {
    return 0.0;
  }
  const double harmonics = std::hypot(sync_acs.integrity->thd, sync_acs.integrity->u_thd);
  return leak_rad(trace_of(input.shots.front()), sync_acs.frequency) * harmonics /
         std::numbers::sqrt2;
}

Budget common_budget(const SeriesStampingInput& input, const ChannelsOfOneClock& acs, double w,
                     double u_phase_apparent) {
  Budget budget;
  add_signal_rows(budget, "the reference", acs.others.front(), 0.0, CountsIn::magnitude_and_phase);
  add_signal_rows(budget, "the ACS sync", acs.pilot, 0.0, CountsIn::phase);
  budget.add({.kind = ContributionKind::apparent_frequency, .u_phase_rad = u_phase_apparent});
  budget.add({.kind = ContributionKind::trigger_delay, .u_phase_rad = w * input.u_dso_delay_s});
  budget.add({.kind = ContributionKind::trace_clock,
              .distribution = Distribution::rectangular,
              .u_phase_rad = u_trace_clock_rad(input, w)});
  budget.add({.kind = ContributionKind::structure,
              .subject = "the oscilloscope's trace",
              .distribution = Distribution::arcsine,
              .repeats = Repeats::common,
              .u_phase_rad = u_distorted_trace_rad(input, acs.pilot.result)});
  budget.add({.kind = ContributionKind::series_start, .u_phase_rad = w * input.u_start_latency_s});
  budget.add({.kind = ContributionKind::channel_delay,
              .subject = "the ACS channels",
              .u_phase_rad = w * input.acs_delay_s});
  add_reference_rows(budget, acs.others.front(), input.frequency, input.reference_response,
                     input.reference_magnitude_rel, input.reference_phase_rad);
  return budget;
}

Expected<std::vector<TriggerPhase>> fit_triggers(const SeriesStampingInput& input,
                                                 const Frequency& frequency) {
  std::vector<TriggerPhase> triggers;
  for (std::size_t j = 0; j < input.shots.size(); ++j) {
    const auto trigger = fit_trigger(trace_of(input.shots[j]), frequency);
    if (!trigger) {
      return fail(of_shot(j, "oscilloscope", trigger.error()));
    }
    triggers.push_back(*trigger);
  }
  return triggers;
}

// What every channel of the sensor is evaluated with.
struct ShotEvaluation {
  const SeriesStampingInput& input;
  const Frequency& apparent_frequency;
  const std::vector<std::int64_t>& stamps;
  const std::vector<TriggerPhase>& triggers;
  std::complex<double> link; // the reference's phasor against sync, and the way to sample 0
  double u_start_rad = 0.0;
  const Budget& common;
};

// What its samples are without what was fitted beside the signal.
std::optional<SeriesAgreement> compare_shots(const ShotEvaluation& shots, std::size_t channel,
                                             const std::vector<CleanedFit>& fits) {
  std::vector<std::span<const double>> values = shots_of_channel(shots.input, channel);
  std::vector<SineFit> of_signal;
  for (std::size_t j = 0; j < fits.size(); ++j) {
    if (!fits[j].values.empty()) {
      values[j] = fits[j].values;
    }
    of_signal.push_back(fits[j].fit);
  }
  return compare_series(shots.apparent_frequency, shots.stamps, values, of_signal);
}

// Where the rates of the shots differ, each begins where its own rate says.
void turn_to_own_rate(const SeriesAgreement& agreement, std::vector<Repetition>& shots) {
  for (std::size_t j = 0; j < agreement.turn_rad.size(); ++j) {
    shots[j].h *= std::polar(1.0, agreement.turn_rad[j]);
    shots[j].u_random_phase_rad = std::hypot(shots[j].u_random_phase_rad, agreement.u_turn_rad);
  }
}

Expected<SeriesChannelResult> evaluate_channel(const ShotEvaluation& shots, std::size_t c) {
  const auto fits = fit_sine_beside_disturbances(shots.apparent_frequency, 0, shots.stamps,
                                                 shots_of_channel(shots.input, c),
                                                 shots.input.reference.mains_hz);
  if (!fits) {
    return fail(of_channel(shots.input.channels[c], fits.error()));
  }
  const auto agreement = compare_shots(shots, c, *fits);
  Budget budget;
  budget.add(quantisation_row(shots.input, c, *fits, shots.apparent_frequency, shots.stamps));
  if (agreement) {
    budget.add({.kind = ContributionKind::structure,
                .subject = "the series",
                .repeats = Repeats::common,
                .u_phase_rad = agreement->u_phase_rad});
  }
  budget.append(shots.common);
  SeriesChannelResult channel{shots.input.channels[c], {}, {}, budget.rows(), agreement};
  for (std::size_t j = 0; j < fits->size(); ++j) {
    channel.shots.push_back(shot_result((*fits)[j].fit, shots.triggers[j],
                                        shots.input.correct_trigger_phase, shots.link,
                                        shots.u_start_rad, budget));
  }
  if (agreement) {
    turn_to_own_rate(*agreement, channel.shots);
  }
  DYNCAL_TRY(channel.mean, mean_of_repetitions(channel.shots));
  return channel;
}

// Shots of different rates tell their mean as well as that scatters.
void widen_rate(const std::optional<SeriesAgreement>& agreement, std::size_t shots,
                NominalFrequency& rate) {
  if (agreement) {
    const double u = agreement->rate_scatter_rel / std::sqrt(static_cast<double>(shots));
    rate.u_lambda = std::hypot(rate.u_lambda, u * rate.lambda);
    rate.u_real_rate_hz = std::hypot(rate.u_real_rate_hz, u * rate.real_rate_hz);
  }
}

void add_trigger_phases(const std::vector<TriggerPhase>& triggers, SeriesStampingResult& result) {
  for (const TriggerPhase& trigger : triggers) {
    result.trigger_phase_rad.push_back(std::arg(trigger.sync));
    result.u_trigger_phase_rad.push_back(trigger.u_rad);
  }
}

} // namespace

Expected<SeriesStampingResult> evaluate_series_stamping(const SeriesStampingInput& input) {
  if (const auto problem = problem_with(input)) {
    return fail(*problem);
  }
  DYNCAL_TRY(auto acs, fit_channels_of_one_clock(input.frequency, input.frequency_search_rel,
                                                 input.acs_stamps_ns, input.sync_acs,
                                                 std::span(&input.reference, 1)));
  learn_frequency_noise(acs);
  const RecordedChannel& reference = acs.others.front();
  DYNCAL_TRY(require_excitation(reference));
  const ChannelFit& sync = acs.pilot.result;
  const double w = sync.frequency.angular();

  DYNCAL_TRY(const auto triggers, fit_triggers(input, sync.frequency));
  const EquidistantAxis axis(1.0 / input.nominal_rate_hz);
  const std::vector<std::int64_t> stamps =
      axis.stamps_ns(input.shots.front().series.front().size());
  // The apparent frequency, shared by all shots.
  const auto pilot = fit_frequency_beside_disturbances(
      axis.on_axis(sync.frequency.hz()), input.rate_tolerance_rel, 0, stamps,
      shots_of_channel(input, 0), input.reference.mains_hz);
  if (!pilot) {
    return fail(of_channel(input.channels.front(), pilot.error()));
  }
  DYNCAL_TRY(const auto rate, real_rate_from_apparent_frequency(
                                  input.nominal_rate_hz, sync.frequency.hz(), sync.u_frequency_hz,
                                  axis.hz(pilot->frequency.hz()), axis.hz(pilot->u_frequency_hz)));

  // Everything that is the same for all shots: the reference's phasor against sync, and the way
  // from trigger point to sample 0.
  const std::complex<double> link =
      unit_phasor(acs.pilot.phasor()) / reference.excitation() * input.reference_response.phasor() *
      std::polar(1.0, -w * (input.dso_delay_s + input.start_latency_s + input.reference_delay_s));
  const Budget common = common_budget(input, acs, w,
                                      std::numbers::pi * 1e-9 * static_cast<double>(stamps.back()) *
                                          pilot->u_frequency_hz);
  SeriesStampingResult result{reference.result, sync, {}, {}, rate, {}};
  add_trigger_phases(triggers, result);
  const ShotEvaluation shots{input, pilot->frequency,          stamps, triggers,
                             link,  w * input.start_scatter_s, common};
  for (std::size_t c = 0; c < input.channels.size(); ++c) {
    DYNCAL_TRY(auto channel, evaluate_channel(shots, c));
    result.channels.push_back(std::move(channel));
  }
  widen_rate(result.channels.front().agreement, input.shots.size(), result.rate);
  return result;
}

Expected<void> apply_start(const StartLatency& start, double sample_s, double angular_hz,
                           SeriesStampingResult& result) {
  const double scatter_s = start.kind == StartKind::uniform ? sample_s / std::sqrt(12.0) : 0.0;
  Budget row;
  row.add({.kind = ContributionKind::series_start, .u_phase_rad = angular_hz * start.u_latency_s});
  for (SeriesChannelResult& channel : result.channels) {
    for (Repetition& shot : channel.shots) {
      shot.h *= std::polar(1.0, -angular_hz * start.latency_s);
      shot.u_random_phase_rad = std::hypot(shot.u_random_phase_rad, angular_hz * scatter_s);
      shot.u_common_phase_rad = std::hypot(shot.u_common_phase_rad, row.u_phase_rad());
    }
    channel.common_budget.insert(channel.common_budget.end(), row.rows().begin(), row.rows().end());
    DYNCAL_TRY(channel.mean, mean_of_repetitions(channel.shots));
  }
  return {};
}

} // namespace dyncal::analysis
