#include "analysis/sample_stamping.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "analysis/disturbances.hpp"
#include "analysis/phasor.hpp"
#include "analysis/quantisation.hpp"
#include "analysis/ratio_scatter.hpp"

namespace dyncal::analysis {
namespace {

constexpr double weakest_snr = 8.0; // of sync and reference: what a search finds in pure noise stays below

std::complex<double> phasor(const SineFit& fit) {
  return {fit.sine, fit.cosine};
}

tl::unexpected<Error> of_series(const std::string& series, Error error) {
  error.message = series + ": " + error.message;
  return tl::unexpected(std::move(error));
}

bool is_excited(const SineFit& fit) {
  return fit.amplitude() > weakest_snr * fit.u_amplitude();
}

struct Series {
  SeriesFit result;
  std::vector<double> cleaned; // the samples without disturbances, where some were found
  std::span<const double> measured;

  [[nodiscard]] std::span<const double> values() const { return cleaned.empty() ? measured : std::span<const double>(cleaned); }
};

struct System { // one clock: sync and what was recorded with it, at the frequency that sync has in this clock
  Series sync;
  std::vector<Series> others;
};

Expected<System> evaluate_system(const SampleStampingInput& input, std::span<const std::int64_t> stamps_ns, const ChannelSamples& sync,
                                 std::span<const ChannelSamples> others) {
  for (const ChannelSamples& channel : others)
    if (channel.values.size() != stamps_ns.size())
      return of_series(channel.name, {ErrorCode::invalid_argument, "the numbers of stamps and values differ"});
  if (sync.values.size() != stamps_ns.size())
    return of_series(sync.name, {ErrorCode::invalid_argument, "the numbers of stamps and values differ"});
  if (stamps_ns.empty()) return of_series(sync.name, {ErrorCode::too_few_samples, "there are no samples in the window"});
  const std::int64_t reference_ns = stamps_ns.front() + (stamps_ns.back() - stamps_ns.front()) / 2;

  Frequency frequency = input.frequency;
  double u_frequency_hz = 0.0;
  if (input.frequency_search_rel > 0.0) {
    const std::array channels{sync.values};
    const auto refined = fit_sine_and_frequency(frequency, input.frequency_search_rel, reference_ns, stamps_ns, channels);
    if (!refined) return of_series(sync.name, refined.error());
    frequency = refined->frequency;
    u_frequency_hz = refined->u_frequency_hz;
  }

  std::vector<std::span<const double>> channels{sync.values};
  for (const ChannelSamples& channel : others)
    channels.push_back(channel.values);
  auto fits = fit_sine_beside_disturbances(frequency, reference_ns, stamps_ns, channels);
  if (!fits) return of_series(sync.name + " and the channels recorded with it", fits.error());
  if (!is_excited(fits->front().fit))
    return of_series(sync.name, {ErrorCode::no_excitation, "no sine of the excitation's frequency stands out of the noise"});

  const auto series = [&](const ChannelSamples& channel, UndisturbedFit& fit) {
    return Series{{channel.name, frequency, u_frequency_hz, reference_ns, fit.fit}, std::move(fit.values), channel.values};
  };
  System system{series(sync, fits->front()), {}};
  for (std::size_t i = 0; i < others.size(); ++i)
    system.others.push_back(series(others[i], (*fits)[i + 1]));
  return system;
}

// Noise of one fit without the share that white stamp noise of `jitter_s` has in its residuals, w^2 A^2 s_t^2 / 2 of s^2: that
// share has rows of its own.
struct FitNoise {
  double u_amplitude = 0.0;
  double u_phase_rad = 0.0;
};

FitNoise fit_noise(const SeriesFit& series, double jitter_s) {
  const double variance = series.fit.residual_sd() * series.fit.residual_sd();
  const double by_jitter = 0.5 * std::pow(series.frequency.angular() * series.fit.amplitude() * jitter_s, 2);
  const double kept = variance > 0.0 ? std::sqrt(std::max(0.0, 1.0 - by_jitter / variance)) : 1.0;
  // A series that is exactly constant has no direction to project the covariance on.
  const double u_component = std::sqrt(std::max(series.fit.covariance[0], series.fit.covariance[3]));
  const double u_amplitude = series.fit.amplitude() > 0.0 ? series.fit.u_amplitude() : u_component;
  const double u_phase = series.fit.amplitude() > 0.0 ? series.fit.u_phase_rad() : 0.0;
  return {u_amplitude * kept, u_phase * kept};
}

QuantisationUncertainty quantisation(const SeriesFit& series, const ChannelSamples& samples, std::span<const std::int64_t> stamps_ns) {
  const double periods = series.frequency.hz() * static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
  return quantisation_uncertainty(series.fit.amplitude(), series.fit.residual_sd(), samples.resolution,
                                  static_cast<double>(series.fit.samples) / std::max(1.0, periods));
}

class Budget {
public:
  void add(std::string name, std::string distribution, double degrees_of_freedom, double u_magnitude_rel, double u_phase_rad) {
    if (u_magnitude_rel > 0.0 || u_phase_rad > 0.0)
      rows_.push_back({std::move(name), std::move(distribution), degrees_of_freedom, u_magnitude_rel, u_phase_rad});
  }
  // A row measured by scatter, kept when it says more than the rows of the same channels so far.
  void add_excess(const std::string& name, const std::optional<RatioScatter>& scatter, double expected_magnitude_rel,
                  double expected_phase_rad) {
    if (!scatter) return;
    add(name, "normal", scatter->degrees_of_freedom,
        significant_excess(scatter->u_magnitude_rel, expected_magnitude_rel, scatter->degrees_of_freedom),
        significant_excess(scatter->u_phase_rad, expected_phase_rad, scatter->degrees_of_freedom));
  }
  void append(const Budget& other) { rows_.insert(rows_.end(), other.rows_.begin(), other.rows_.end()); }
  [[nodiscard]] double u_magnitude_rel() const { return root_of_squares(&Contribution::u_magnitude_rel); }
  [[nodiscard]] double u_phase_rad() const { return root_of_squares(&Contribution::u_phase_rad); }
  [[nodiscard]] const std::vector<Contribution>& rows() const { return rows_; }

private:
  [[nodiscard]] double root_of_squares(double Contribution::*member) const {
    double sum = 0.0;
    for (const Contribution& row : rows_)
      sum += row.*member * (row.*member);
    return std::sqrt(sum);
  }
  std::vector<Contribution> rows_;
};

// Rows of the reference side and of the corrections, the same for every channel of the sensor.
Budget common_budget(const SampleStampingInput& input, const System& acs, const SeriesFit& sync_dau) {
  const SeriesFit& reference = acs.others.front().result;
  const SeriesFit& sync_acs = acs.sync.result;
  Budget budget;
  const double w = input.frequency.angular();
  const double amplitude = reference.fit.amplitude();
  const QuantisationUncertainty steps = quantisation(reference, input.reference, input.acs_stamps_ns);
  budget.add("noise of the reference", "normal", reference.fit.degrees_of_freedom, reference.fit.u_amplitude() / amplitude,
             reference.fit.u_phase_rad());
  budget.add("quantisation of the reference", "rectangular", 0.0, steps.u_amplitude / amplitude, steps.u_phase_rad);
  budget.add("noise of the ACS sync", "normal", sync_acs.fit.degrees_of_freedom, 0.0, sync_acs.fit.u_phase_rad());
  budget.add("quantisation of the ACS sync", "rectangular", 0.0, 0.0,
             quantisation(sync_acs, input.sync_acs, input.acs_stamps_ns).u_phase_rad);
  budget.add_excess("structure in the reference",
                    ratio_scatter(reference.frequency, input.acs_stamps_ns, acs.others.front().values(), acs.sync.values()),
                    budget.u_magnitude_rel(), budget.u_phase_rad());

  const double jitter_s = input.systematic.sync_adc_jitter_s;
  const double common_jitter_s = std::max(input.systematic.dau_jitter_s, input.systematic.dau_tick_s / std::sqrt(12.0));
  const FitNoise noise = fit_noise(sync_dau, std::hypot(jitter_s, common_jitter_s));
  budget.add("noise of the DAU sync", "normal", sync_dau.fit.degrees_of_freedom, 0.0, noise.u_phase_rad);
  budget.add("jitter of the DAU sync alone", "normal", 0.0, 0.0, std::sqrt(1.5 / static_cast<double>(sync_dau.fit.samples)) * w * jitter_s);
  budget.add("quantisation of the DAU sync", "rectangular", 0.0, 0.0,
             quantisation(sync_dau, input.sync_dau, input.dau_stamps_ns).u_phase_rad);

  budget.add("phase of the DAU sync ADC", "normal", 0.0, 0.0, input.adc.u_phase_lag_rad);
  budget.add("delay between the ACS channels", "normal", 0.0, 0.0, w * input.systematic.acs_delay_s);
  budget.add("reference", "normal", 0.0, input.systematic.reference_magnitude_rel, input.systematic.reference_phase_rad);
  return budget;
}

// Stamp noise common to sync and the sensor: the phase of the ratio sees it only as far as the two sines differ in phase.
void add_stamp_noise(Budget& budget, const SampleStampingInput& input, const SeriesFit& dut, const SeriesFit& sync_dau) {
  const double tick_s = input.systematic.dau_tick_s / std::sqrt(12.0);
  const double rest_s = std::sqrt(std::max(0.0, input.systematic.dau_jitter_s * input.systematic.dau_jitter_s - tick_s * tick_s));
  const double n = static_cast<double>(dut.fit.samples);
  const double across = std::abs(std::sin(dut.fit.phase_rad() - sync_dau.fit.phase_rad()));
  const auto add = [&](const char* name, const char* distribution, double jitter_s) {
    const double angle = input.frequency.angular() * jitter_s;
    budget.add(name, distribution, 0.0, std::hypot(std::sqrt(0.5 / n) * angle, 0.5 * angle * angle), std::sqrt(2.0 / n) * across * angle);
  };
  add("jitter of the DAU stamps", "normal", rest_s);
  add("tick of the DAU stamps", "rectangular", tick_s);
}

TransferPoint evaluate_channel(const SampleStampingInput& input, const ChannelSamples& samples, const Series& series, const System& dau,
                               std::complex<double> link, double reference_amplitude, const Budget& common) {
  const SeriesFit& dut = series.result;
  const double jitter_s = std::max(input.systematic.dau_jitter_s, input.systematic.dau_tick_s / std::sqrt(12.0));
  const FitNoise noise = fit_noise(dut, jitter_s);
  const QuantisationUncertainty steps = quantisation(dut, samples, input.dau_stamps_ns);
  const double u_amplitude = std::hypot(noise.u_amplitude, steps.u_amplitude);
  // A channel that is not excited: nothing is divided by its amplitude, and its phase is honestly unknown.
  const double amplitude = std::max(dut.fit.amplitude(), 1e-6 * u_amplitude);
  const double relative = amplitude > 0.0 ? 1.0 / amplitude : 0.0;
  const double snr = u_amplitude > 0.0 ? amplitude / u_amplitude : (amplitude > 0.0 ? 1e12 : 0.0);
  const bool weak = snr < 10.0;

  Budget budget;
  budget.add("noise of the sensor", "normal", dut.fit.degrees_of_freedom, noise.u_amplitude * relative,
             weak ? phase_standard_uncertainty(snr) : noise.u_phase_rad);
  budget.add("quantisation of the sensor", "rectangular", 0.0, steps.u_amplitude * relative, weak ? 0.0 : steps.u_phase_rad);
  if (weak) budget.add("magnitude of noise (Rice)", "normal", 0.0, 0.5 * std::pow(u_amplitude * relative, 2), 0.0);
  add_stamp_noise(budget, input, dut, dau.sync.result);
  const double sync_phase = dau.sync.result.fit.u_phase_rad();
  budget.add_excess("structure in the sensor's signal",
                    ratio_scatter(dut.frequency, input.dau_stamps_ns, series.values(), dau.sync.values()), budget.u_magnitude_rel(),
                    std::hypot(budget.u_phase_rad(), sync_phase));
  budget.append(common);

  const std::complex<double> h = phasor(dut.fit) * link;
  return {.channel = samples.name,
          .h = h,
          .magnitude = std::abs(h),
          .u_magnitude = amplitude / reference_amplitude * budget.u_magnitude_rel(),
          .phase_rad = std::arg(h),
          .u_phase_rad = budget.u_phase_rad(),
          .budget = budget.rows(),
          .dut = dut};
}

} // namespace

Expected<SampleStampingResult> evaluate_sample_stamping(const SampleStampingInput& input) {
  auto acs = evaluate_system(input, input.acs_stamps_ns, input.sync_acs, std::span(&input.reference, 1));
  if (!acs) return tl::unexpected(acs.error());
  auto dau = evaluate_system(input, input.dau_stamps_ns, input.sync_dau, input.dut);
  if (!dau) return tl::unexpected(dau.error());
  const SeriesFit& reference = acs->others.front().result;
  if (!is_excited(reference.fit))
    return of_series(reference.series, {ErrorCode::no_excitation, "no sine of the excitation's frequency stands out of the noise"});

  // Eq. (4): H = P_dos / P_ref * U(P_sync_acs) / U(P_sync_dau,true), P_sync_dau,true = P_sync_dau / G.
  const std::complex<double> adc = std::polar(1.0, -input.adc.phase_lag_rad);
  const std::complex<double> link =
      unit_phasor(phasor(acs->sync.result.fit)) / (unit_phasor(phasor(dau->sync.result.fit)) / adc) / phasor(reference.fit);

  const Budget common = common_budget(input, *acs, dau->sync.result);
  SampleStampingResult result{reference, acs->sync.result, dau->sync.result, {}};
  for (std::size_t i = 0; i < input.dut.size(); ++i)
    result.points.push_back(evaluate_channel(input, input.dut[i], dau->others[i], *dau, link, reference.fit.amplitude(), common));
  return result;
}

} // namespace dyncal::analysis
