#include "analysis/method/trigger_phase.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "analysis/base/phasor.hpp"
#include "analysis/sine/equidistant_axis.hpp"
#include "analysis/sine/extended_sine_fit.hpp"
#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr double least_periods = 1.0; // from which harmonics are told from the fundamental
constexpr int highest_harmonic = 5;
constexpr double usable_part_of_rate = 0.45;
constexpr std::array worst_orders{2, 3};

ExtendedBasis basis_of(const SyncTrace& trace, double frequency_hz) {
  const auto shown =
      static_cast<int>(usable_part_of_rate / (trace.interval_s * frequency_hz)); // below half
  return {.drift_order = 0,
          .max_harmonic = std::clamp(shown, 1, highest_harmonic),
          .lines = {},
          .drifting_phasor = false};
}

Expected<SineFit> fit_of(const SyncTrace& trace, const Frequency& on_axis, double frequency_hz,
                         std::span<const std::int64_t> stamps_ns) {
  const std::array channels{trace.values};
  if (periods_of(trace, frequency_hz) >= least_periods) {
    if (const auto fits = fit_sine_extended(on_axis, basis_of(trace, frequency_hz), Weighting::none,
                                            0, stamps_ns, channels)) {
      return fits->front().fundamental;
    } // too few samples, perhaps, for that many columns
  }
  return fit_sine(on_axis, 0, stamps_ns, channels).map([](const std::vector<SineFit>& fits) {
    return fits.front();
  });
}

} // namespace

double periods_of(const SyncTrace& trace, double frequency_hz) {
  return static_cast<double>(trace.values.size()) * trace.interval_s * frequency_hz;
}

Expected<TriggerPhase> fit_trigger(const SyncTrace& trace, const Frequency& frequency) {
  const EquidistantAxis axis(trace.interval_s);
  return fit_of(trace, axis.on_axis(frequency.hz()), frequency.hz(),
                axis.stamps_ns(trace.values.size()))
      .map([&](const SineFit& fit) {
        return TriggerPhase{std::complex<double>(fit.sine, fit.cosine) *
                                std::polar(1.0, -frequency.angular() * trace.first_s),
                            fit.u_phase_rad()};
      });
}

double leak_rad(const SyncTrace& trace, const Frequency& frequency) {
  if (periods_of(trace, frequency.hz()) >= least_periods) {
    return 0.0;
  }
  const EquidistantAxis axis(trace.interval_s);
  const std::vector<std::int64_t> stamps_ns = axis.stamps_ns(trace.values.size());
  const Frequency on_axis = axis.on_axis(frequency.hz());
  const auto fundamental = fit_trigger(trace, frequency);
  if (!fundamental) {
    return 0.0;
  }
  const std::complex<double> at_first =
      unit_phasor(fundamental->sync * std::polar(1.0, frequency.angular() * trace.first_s));
  std::vector<double> sine(stamps_ns.size()), cosine(stamps_ns.size()), carrier(stamps_ns.size());
  fill_sine_cosine(on_axis, 0, stamps_ns, carrier.data(), sine.data());
  double worst = 0.0;
  for (const int order : worst_orders) {
    fill_sine_cosine(Frequency::from_hz(order * on_axis.hz()), 0, stamps_ns, sine.data(),
                     cosine.data());
    // The carrier beside them, for a fit that finds no excitation at all fails.
    const std::array<std::span<const double>, 3> channels{sine, cosine, carrier};
    const auto fits = fit_sine(on_axis, 0, stamps_ns, channels);
    if (!fits) {
      continue;
    }
    double square = 0.0;
    for (const SineFit& fit : std::span(*fits).first(2)) {
      const std::complex<double> leaked(fit.sine, fit.cosine);
      square += std::pow((leaked * std::conj(at_first)).imag(), 2);
    }
    worst = std::max(worst, std::sqrt(square));
  }
  return worst;
}

} // namespace dyncal::analysis
