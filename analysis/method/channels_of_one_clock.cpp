#include "analysis/method/channels_of_one_clock.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "analysis/base/phasor.hpp"
#include "analysis/method/motion_channel.hpp"
#include "analysis/sine/disturbances.hpp"
#include "analysis/sine/sine_solve.hpp"
#include "analysis/uncertainty/found_resolution.hpp"
#include "analysis/uncertainty/quantisation.hpp"

namespace dyncal::analysis {
namespace {

constexpr double weakest_signal = 8.0;   // u: what a search finds in pure noise stays below
constexpr double weak_phasor = 10.0;     // u: below, magnitude and phase are not normal any more
constexpr double worth_correcting = 0.1; // u of the amplitude

tl::unexpected<Error> of_channel(const std::string& channel, Error error) {
  error.message = channel + ": " + error.message;
  return fail(std::move(error));
}

struct FitNoise {
  double u_amplitude = 0.0;
  double u_phase_rad = 0.0;
};

FitNoise fit_noise(const RecordedChannel& recorded, double jitter_s) {
  const ChannelFit& channel = recorded.result;
  const double variance = channel.fit.residual_sd() * channel.fit.residual_sd();
  const double by_jitter =
      0.5 * std::pow(channel.frequency.angular() * channel.fit.amplitude() * jitter_s, 2);
  const double kept = variance > 0.0 ? std::sqrt(std::max(0.0, 1.0 - by_jitter / variance)) : 1.0;
  // A channel that is exactly constant has no direction to project the covariance on.
  const double u_component =
      std::sqrt(std::max(channel.fit.covariance[0], channel.fit.covariance[3]));
  const double u_amplitude =
      channel.fit.amplitude() > 0.0 ? channel.fit.u_amplitude() : u_component;
  const double u_phase = channel.fit.amplitude() > 0.0 ? channel.fit.u_phase_rad() : 0.0;
  return {u_amplitude * kept * recorded.noise_factor, u_phase * kept * recorded.noise_factor};
}

QuantisationUncertainty quantisation(const RecordedChannel& recorded) {
  const SineFit& fit = recorded.result.fit;
  return quantisation_uncertainty(fit.amplitude(), fit.residual_sd(), recorded.samples.resolution,
                                  recorded.result.frequency, recorded.stamps_ns);
}

struct SensorNoise {
  FitNoise noise;
  QuantisationUncertainty steps;
  double u_amplitude = 0.0;
  double amplitude = 0.0; // never so small that a quotient would be meaningless

  SensorNoise(const RecordedChannel& recorded, double jitter_s)
      : noise(fit_noise(recorded, jitter_s)), steps(quantisation(recorded)),
        u_amplitude(std::hypot(noise.u_amplitude, steps.u_amplitude)),
        amplitude(std::max(recorded.amplitude(), 1e-6 * u_amplitude)) {}

  [[nodiscard]] double snr() const {
    if (u_amplitude > 0.0) {
      return amplitude / u_amplitude;
    }
    return amplitude > 0.0 ? 1e12 : 0.0;
  }
};

std::int64_t middle_ns(std::span<const std::int64_t> stamps_ns) {
  return stamps_ns.front() + (stamps_ns.back() - stamps_ns.front()) / 2;
}

std::string names_of(std::span<const ChannelSamples> all) {
  return all.size() > 1 ? all.front().name + " and the channels recorded with it"
                        : all.front().name;
}

Expected<std::vector<std::span<const double>>> values_of(std::span<const ChannelSamples> all,
                                                         std::span<const std::int64_t> stamps_ns) {
  std::vector<std::span<const double>> channels;
  for (const ChannelSamples& channel : all) {
    if (channel.values.size() != stamps_ns.size()) {
      return of_channel(channel.name,
                        {ErrorCode::invalid_argument, "the numbers of stamps and values differ"});
    }
    channels.push_back(channel.values);
  }
  if (stamps_ns.empty()) {
    return of_channel(names_of(all),
                      {ErrorCode::too_few_samples, "there are no samples in the window"});
  }
  return channels;
}

// Puts back what the scatter of the stamps took off the amplitude, where that is worth it.
void correct_shortening(double step, RecordedChannel& recorded) {
  ChannelFit& result = recorded.result;
  StampScatter& scatter = result.scatter;
  const bool moves = is_differentiated(recorded.samples);
  const CentredSamples centred =
      moves ? centred_samples(result.frequency.hz(), recorded.stamps_ns, recorded.values())
            : CentredSamples{};
  if (moves && centred.values.empty()) {
    return;
  }
  scatter = measure_stamp_scatter(
      result.frequency, result.fit, result.phase_origin_ns,
      moves ? std::span<const std::int64_t>(centred.stamps_ns) : recorded.stamps_ns,
      moves ? std::span<const double>(centred.values) : recorded.values(), step,
      SlowScatter::corrected_in_blocks);
  const double shortening = scatter.correction_rel();
  if (shortening * result.fit.amplitude() > worth_correcting * result.fit.u_amplitude()) {
    recorded.lengthening = 1.0 / (1.0 - shortening);
  }
}

void add_scatter_row(Budget& budget, const std::string& what, const RecordedChannel& recorded) {
  if (recorded.lengthening > 1.0) {
    const double u = recorded.result.scatter.u_correction_rel();
    budget.add({.kind = ContributionKind::stamp_jitter,
                .subject = "the stamps of " + what + ", as corrected",
                .u_magnitude_rel = u,
                .u_lasting_magnitude_rel = u});
  }
}

RecordedChannel recorded_channel(const Frequency& frequency, double u_frequency_hz,
                                 std::span<const std::int64_t> stamps_ns,
                                 const ChannelSamples& samples, CleanedFit fit) {
  RecordedChannel recorded{
      {samples.name, frequency, u_frequency_hz, middle_ns(stamps_ns), fit.fit, {}, {}},
      std::move(fit.values),
      samples,
      stamps_ns};
  recorded.drift_order = fit.drift_order;
  SignalExpectation expected = samples.expected;
  double& resolution = recorded.samples.resolution;
  if (!(resolution > 0.0) || !(expected.resolution > 0.0)) {
    const double found = found_resolution(samples.values);
    resolution = resolution > 0.0 ? resolution : found;
    expected.resolution = expected.resolution > 0.0 ? expected.resolution : found;
  }
  if (kernel::is_significant(fit.plain.fit)) {
    recorded.result.integrity =
        measure_integrity(frequency, fit.plain, stamps_ns, samples.values, expected);
    correct_shortening(expected.resolution, recorded);
  }
  return recorded;
}

std::vector<RecordedChannel> recorded_channels(const Frequency& frequency, double u_frequency_hz,
                                               std::span<const std::int64_t> stamps_ns,
                                               std::span<const ChannelSamples> all,
                                               std::vector<CleanedFit> fits) {
  std::vector<RecordedChannel> recorded;
  for (std::size_t i = 0; i < all.size(); ++i) {
    recorded.push_back(
        recorded_channel(frequency, u_frequency_hz, stamps_ns, all[i], std::move(fits[i])));
  }
  return recorded;
}

// All channels with the same stamps at one frequency, about its middle.
Expected<std::vector<RecordedChannel>> fit_channels(const Frequency& frequency,
                                                    double u_frequency_hz,
                                                    std::span<const std::int64_t> stamps_ns,
                                                    std::span<const ChannelSamples> all) {
  DYNCAL_TRY(const auto channels, values_of(all, stamps_ns));
  auto fits = fit_sine_beside_disturbances(frequency, middle_ns(stamps_ns), stamps_ns, channels,
                                           all.front().mains_hz);
  if (!fits) {
    return of_channel(names_of(all), fits.error());
  }
  return recorded_channels(frequency, u_frequency_hz, stamps_ns, all, std::move(*fits));
}

// The same at the frequency that the first of them, the pilot, has.
Expected<std::vector<RecordedChannel>>
fit_channels_of_pilot(const Frequency& nominal, double frequency_search_rel,
                      std::span<const std::int64_t> stamps_ns,
                      std::span<const ChannelSamples> all) {
  DYNCAL_TRY(const auto channels, values_of(all, stamps_ns));
  auto pilot = fit_pilot_beside_disturbances(nominal, frequency_search_rel, middle_ns(stamps_ns),
                                             stamps_ns, channels, all.front().mains_hz);
  if (!pilot) {
    return of_channel(all.front().name, pilot.error());
  }
  return pilot->channels.empty()
             ? fit_channels(pilot->frequency, pilot->u_frequency_hz, stamps_ns, all)
             : recorded_channels(pilot->frequency, pilot->u_frequency_hz, stamps_ns, all,
                                 std::move(pilot->channels));
}

// A pilot that is itself a displacement or velocity shows its frequency without the slow motion.
Expected<std::vector<RecordedChannel>> fit_samples(const Frequency& nominal,
                                                   double frequency_search_rel,
                                                   std::span<const std::int64_t> stamps_ns,
                                                   std::span<const ChannelSamples> all,
                                                   const ChannelSamples& pilot) {
  if (!(frequency_search_rel > 0.0)) {
    return fit_channels(nominal, 0.0, stamps_ns, all);
  }
  if (!is_differentiated(pilot)) {
    return fit_channels_of_pilot(nominal, frequency_search_rel, stamps_ns, all);
  }
  DYNCAL_TRY(const MotionFrequency found,
             frequency_of_motion(nominal, frequency_search_rel, stamps_ns, pilot));
  return fit_channels(found.frequency, found.u_frequency_hz, stamps_ns, all);
}

} // namespace

SineFit RecordedChannel::fit_of_values() const {
  SineFit fit = result.fit;
  if (!motion_stamps_ns.empty()) {
    fit.offset = 0.0;
  }
  return fit;
}

std::complex<double> RecordedChannel::excitation() const {
  return samples.motion ? phasor() * motion_factor(samples.motion->measured, samples.motion->per,
                                                   result.frequency.angular())
                        : phasor();
}

Expected<ChannelsOfOneClock> fit_channels_of_one_clock(const Frequency& nominal,
                                                       double frequency_search_rel,
                                                       std::span<const std::int64_t> stamps_ns,
                                                       const ChannelSamples& pilot,
                                                       std::span<const ChannelSamples> others) {
  std::vector<ChannelSamples> all{pilot};
  all.insert(all.end(), others.begin(), others.end());
  DYNCAL_TRY(values_of(all, stamps_ns));
  std::vector<std::vector<double>> periodic(all.size());
  std::vector<ChannelSamples> looked_at = all;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (is_differentiated(all[i])) {
      periodic[i] = without_slow_motion(nominal.hz(), stamps_ns, all[i].values);
      looked_at[i].values = periodic[i];
    }
  }
  DYNCAL_TRY(auto recorded,
             fit_samples(nominal, frequency_search_rel, stamps_ns, looked_at, pilot));
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (is_differentiated(all[i])) {
      DYNCAL_TRY(take_motion(all[i].values, recorded[i]));
    }
  }
  DYNCAL_TRY(require_excitation(recorded.front()));
  ChannelsOfOneClock system{std::move(recorded.front()), {}};
  system.others.assign(std::make_move_iterator(recorded.begin() + 1),
                       std::make_move_iterator(recorded.end()));
  return system;
}

Expected<RecordedChannel> fit_weak_channel(const Frequency& frequency,
                                           std::span<const std::int64_t> stamps_ns,
                                           const ChannelSamples& channel) {
  DYNCAL_TRY(auto recorded, fit_channels(frequency, 0.0, stamps_ns, std::span(&channel, 1)));
  return std::move(recorded.front());
}

Expected<void> require_excitation(const RecordedChannel& recorded) {
  if (recorded.amplitude() > weakest_signal * recorded.result.fit.u_amplitude()) {
    return {};
  }
  return of_channel(
      recorded.result.channel,
      {ErrorCode::no_excitation, "no sine of the excitation's frequency stands out of the noise"});
}

void add_signal_rows(Budget& budget, const std::string& what, const RecordedChannel& recorded,
                     double jitter_s, CountsIn counts_in) {
  const FitNoise noise = fit_noise(recorded, jitter_s);
  const QuantisationUncertainty steps = quantisation(recorded);
  const double relative = counts_in == CountsIn::phase ? 0.0 : 1.0 / recorded.amplitude();
  budget.add({.kind = ContributionKind::fit_noise,
              .subject = what,
              .degrees_of_freedom = recorded.noise_freedom(),
              .u_magnitude_rel = noise.u_amplitude * relative,
              .u_phase_rad = noise.u_phase_rad});
  budget.add({.kind = ContributionKind::quantisation,
              .subject = what,
              .distribution = Distribution::rectangular,
              .u_magnitude_rel = steps.u_amplitude * relative,
              .u_phase_rad = steps.u_phase_rad});
  if (counts_in == CountsIn::magnitude_and_phase) {
    add_scatter_row(budget, what, recorded);
  }
}

void add_sensor_rows(Budget& budget, const RecordedChannel& recorded, double jitter_s) {
  const SensorNoise sensor(recorded, jitter_s);
  const bool weak = sensor.snr() < weak_phasor;
  const double relative = sensor.amplitude > 0.0 ? 1.0 / sensor.amplitude : 0.0;
  budget.add(
      {.kind = ContributionKind::fit_noise,
       .subject = "the sensor",
       .degrees_of_freedom = recorded.noise_freedom(),
       .u_magnitude_rel = sensor.noise.u_amplitude * relative,
       .u_phase_rad = weak ? phase_standard_uncertainty(sensor.snr()) : sensor.noise.u_phase_rad});
  budget.add({.kind = ContributionKind::quantisation,
              .subject = "the sensor",
              .distribution = Distribution::rectangular,
              .u_magnitude_rel = sensor.steps.u_amplitude * relative,
              .u_phase_rad = weak ? 0.0 : sensor.steps.u_phase_rad});
  add_scatter_row(budget, "the sensor", recorded);
  if (weak) {
    budget.add({.kind = ContributionKind::rice,
                .u_magnitude_rel = 0.5 * std::pow(sensor.u_amplitude * relative, 2)});
  }
}

void add_reference_rows(Budget& budget, const RecordedChannel& reference, const Frequency& nominal,
                        const ReferenceResponse& response, double magnitude_rel, double phase_rad) {
  if (const auto& motion = reference.samples.motion) {
    const int powers = static_cast<int>(motion->measured) - static_cast<int>(motion->per);
    budget.add({.kind = ContributionKind::motion_frequency,
                .distribution = Distribution::rectangular,
                .u_magnitude_rel =
                    std::abs(powers * (reference.result.frequency.hz() / nominal.hz() - 1.0)) /
                    std::sqrt(3.0)});
    if (motion->interferometer) {
      const double seconds =
          static_cast<double>(reference.stamps_ns.back() - reference.stamps_ns.front()) * 1e-9;
      const double f = reference.result.frequency.hz();
      for (const Contribution& row :
           interferometer_rows({f, reference.amplitude(), f * seconds}, *motion->interferometer)) {
        budget.add(row);
      }
    }
  }
  budget.add({.kind = ContributionKind::reference,
              .u_magnitude_rel = magnitude_rel,
              .u_phase_rad = phase_rad});
  for (const ReferenceContribution& one : response.contributions) {
    budget.add({.kind = ContributionKind::reference,
                .subject = one.name,
                .distribution = one.distribution,
                .degrees_of_freedom = one.degrees_of_freedom,
                .u_magnitude_rel = one.u_magnitude_rel,
                .u_phase_rad = one.u_phase_rad});
  }
}

TransferPoint transfer_point(const RecordedChannel& dut, std::complex<double> link,
                             const Budget& budget) {
  const std::complex<double> h = dut.phasor() * link;
  return {.channel = dut.result.channel,
          .h = h,
          .magnitude = std::abs(h),
          .u_magnitude =
              SensorNoise(dut, 0.0).amplitude * std::abs(link) * budget.u_magnitude_rel(),
          .phase_rad = std::arg(h),
          .u_phase_rad = budget.u_phase_rad(),
          .budget = budget.rows(),
          .dut = dut.result};
}

} // namespace dyncal::analysis
