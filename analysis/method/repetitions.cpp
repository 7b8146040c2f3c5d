#include "analysis/method/repetitions.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <utility>

#include "analysis/base/phasor.hpp"
#include "analysis/uncertainty/random_effects.hpp"
#include "analysis/uncertainty/rice.hpp"

namespace dyncal::analysis {
namespace {

constexpr double weak_mean = 10.0;       // u: below, the phase is not normal any more
constexpr double significant_bias = 0.1; // of its uncertainty in the mean
// Phases of two repetitions that are farther apart, each known to `known_phase_rad` (so by more
// than six standard deviations), are of sensors that point in opposite directions.
constexpr double opposite_rad = 0.75 * std::numbers::pi;
constexpr double known_phase_rad = 0.25;

bool is_finite(const Repetition& repetition) {
  return std::isfinite(repetition.h.real()) && std::isfinite(repetition.h.imag()) &&
         std::isfinite(repetition.u_random_magnitude_rel) &&
         std::isfinite(repetition.u_random_phase_rad) &&
         std::isfinite(repetition.u_common_magnitude_rel) &&
         std::isfinite(repetition.u_common_phase_rad);
}

// The mean of one frequency before its uncertainty is known. Deviations and noise of the magnitude
// are relative to the mean's, those of the phase in radians.
struct Centre {
  std::complex<double> h;
  RepeatedQuantity magnitude, phase;
  double common_magnitude = 0.0;
  double common_phase = 0.0;
  double freedom_magnitude = infinite_degrees_of_freedom; // of a single repetition
  double freedom_phase = infinite_degrees_of_freedom;
};

// Are the phasors longer than noise alone makes them, by four standard deviations of their mean?
bool stand_out(double mean_length, double noise, double n) {
  const double scatter = rice_standard_deviation(0.0, noise) / std::sqrt(n);
  return mean_length > rice_mean(0.0, noise) + 4.0 * scatter;
}

// Of one component of the phasors, that and only that.
double phasor_noise(std::span<const Repetition> repetitions) {
  double squares = 0.0;
  for (const Repetition& repetition : repetitions) {
    const double u2 = std::pow(repetition.u_random_magnitude_rel, 2) -
                      std::pow(repetition.u_not_noise_magnitude_rel, 2);
    squares += std::norm(repetition.h) * std::max(0.0, u2);
  }
  return std::sqrt(squares / static_cast<double>(repetitions.size()));
}

double without_lengthening(double length, std::span<const Repetition> repetitions) {
  const double noise = phasor_noise(repetitions);
  const double magnitude = amplitude_of_rice_mean(length, noise);
  const double u_of_mean = noise / std::sqrt(static_cast<double>(repetitions.size()));
  return length - magnitude > significant_bias * u_of_mean ? magnitude : length;
}

Centre mean_of_lengths(std::span<const Repetition> repetitions) {
  const double n = static_cast<double>(repetitions.size());
  double length = 0.0;
  std::complex<double> directions;
  for (const Repetition& repetition : repetitions) {
    length += std::abs(repetition.h) / n;
    directions += unit_phasor(repetition.h) / n;
  }
  const double magnitude = without_lengthening(length, repetitions);
  const std::complex<double> direction = unit_phasor(directions);
  const double closeness = std::max(std::abs(directions), 1e-3); // R
  Centre centre{magnitude * direction, {}, {}};
  for (const Repetition& repetition : repetitions) {
    const std::complex<double> turned = unit_phasor(repetition.h) * std::conj(direction);
    centre.magnitude.deviations.push_back(std::abs(repetition.h) / length - 1.0);
    centre.phase.deviations.push_back(turned.real() < 0.0 ? std::arg(turned)
                                                          : turned.imag() / closeness);
  }
  return centre;
}

Centre mean_of_phasors(std::span<const Repetition> repetitions) {
  Centre centre;
  for (const Repetition& repetition : repetitions) {
    centre.h += repetition.h / static_cast<double>(repetitions.size());
  }
  const double unit = std::abs(centre.h) > 0.0 ? std::abs(centre.h) : 1.0;
  for (const Repetition& repetition : repetitions) {
    const std::complex<double> deviation =
        (repetition.h - centre.h) * std::conj(unit_phasor(centre.h)) / unit;
    centre.magnitude.deviations.push_back(deviation.real());
    centre.phase.deviations.push_back(deviation.imag());
  }
  return centre;
}

// Noise of the phase. A weak phasor by itself states what is known of an angle of which little is
// known; when the mean tells its amplitude, it is the noise of one component over that.
double phase_noise(const Repetition& repetition, double noise_over_mean) {
  constexpr double weak = 10.0;
  const double snr =
      repetition.u_random_magnitude_rel > 0.0 ? 1.0 / repetition.u_random_magnitude_rel : 1e12;
  const double by_itself = phase_standard_uncertainty(snr);
  if (snr >= weak || repetition.u_random_phase_rad < by_itself) {
    return repetition.u_random_phase_rad;
  }
  return std::hypot(std::sqrt(std::pow(repetition.u_random_phase_rad, 2) - by_itself * by_itself),
                    std::min(by_itself, noise_over_mean));
}

Centre centre_of(const RepeatedFrequency& frequency) {
  const std::vector<Repetition>& repetitions = frequency.repetitions;
  double squares = 0.0;
  double length = 0.0;
  for (const Repetition& repetition : repetitions) {
    squares += std::norm(repetition.h) * std::pow(repetition.u_random_magnitude_rel, 2);
    length += std::abs(repetition.h);
  }
  const double n = static_cast<double>(repetitions.size());
  const double noise = std::sqrt(squares / n); // of one component
  const bool clear = n > 1.0 && stand_out(length / n, noise, n);
  Centre centre = clear ? mean_of_lengths(repetitions) : mean_of_phasors(repetitions);
  const double unit = std::abs(centre.h) > 0.0 ? std::abs(centre.h) : 1.0;
  for (const Repetition& repetition : repetitions) {
    const double size = std::abs(repetition.h) / unit;
    centre.magnitude.u.push_back(size * repetition.u_random_magnitude_rel);
    centre.phase.u.push_back(clear ? phase_noise(repetition, noise / unit)
                                   : repetition.u_random_phase_rad);
    centre.common_magnitude =
        std::max(centre.common_magnitude, size * repetition.u_common_magnitude_rel);
    centre.common_phase = std::max(centre.common_phase, repetition.u_common_phase_rad);
  }
  if (repetitions.size() == 1) {
    centre.freedom_magnitude = repetitions.front().freedom_magnitude;
    centre.freedom_phase = repetitions.front().freedom_phase;
  }
  centre.magnitude.frequency_hz = frequency.frequency_hz;
  centre.phase.frequency_hz = frequency.frequency_hz;
  if (std::all_of(repetitions.begin(), repetitions.end(),
                  [](const Repetition& one) { return one.sweep > 0; })) {
    std::transform(repetitions.begin(), repetitions.end(),
                   std::back_inserter(centre.magnitude.repetitions),
                   [](const Repetition& one) { return one.sweep; });
    centre.phase.repetitions = centre.magnitude.repetitions;
  }
  return centre;
}

bool have_opposite_phases(const std::vector<Repetition>& repetitions) {
  const auto opposite = [&](const Repetition& one) {
    const Repetition& first = repetitions.front();
    return one.u_random_phase_rad < known_phase_rad && first.u_random_phase_rad < known_phase_rad &&
           std::abs(std::arg(one.h * std::conj(first.h))) > opposite_rad;
  };
  return std::any_of(repetitions.begin(), repetitions.end(), opposite);
}

double standard_deviation_of(const std::vector<double>& deviations) {
  if (deviations.size() < 2) {
    return 0.0;
  }
  const double squares =
      std::inner_product(deviations.begin(), deviations.end(), deviations.begin(), 0.0);
  return std::sqrt(squares / (static_cast<double>(deviations.size()) - 1.0));
}

double drawn_magnitude(const Contribution& row) {
  return std::sqrt(std::max(0.0, row.u_magnitude_rel * row.u_magnitude_rel -
                                     row.u_lasting_magnitude_rel * row.u_lasting_magnitude_rel));
}

// What is known of the error of a mean and of what all have in common. A mean of known noise alone,
// as that of a single repetition is, has the degrees of freedom of its budget.
CombinedUncertainty combined(const MeanError& error, double u_common, double freedom) {
  CombinedUncertainty result = combine(error, u_common);
  if (error.parts.size() == 1 && std::isfinite(freedom)) {
    result.degrees_of_freedom = freedom;
    result.k = coverage_factor(freedom);
  }
  return result;
}

RepetitionMean mean_from(const Centre& centre, const MeanError& magnitude_error,
                         const MeanError& phase_error) {
  constexpr double any_phase = std::numbers::pi / std::numbers::sqrt3;
  RepetitionMean result;
  result.repetitions = centre.magnitude.deviations.size();
  result.h = centre.h;
  result.magnitude = std::abs(centre.h);
  result.phase_rad = std::arg(centre.h);
  const double unit = result.magnitude > 0.0 ? result.magnitude : 1.0;
  result.scatter_magnitude = unit * standard_deviation_of(centre.magnitude.deviations);
  result.scatter_phase_rad = standard_deviation_of(centre.phase.deviations);
  result.magnitude_rel =
      combined(magnitude_error, centre.common_magnitude, centre.freedom_magnitude);
  result.phase = combined(phase_error, centre.common_phase, centre.freedom_phase);
  result.independent_magnitude_rel = combine(magnitude_error, 0.0);
  result.independent_phase = combine(phase_error, 0.0);
  result.u_magnitude = 0.5 * unit * result.magnitude_rel.expanded();
  result.u_phase_rad = std::min(any_phase, 0.5 * result.phase.expanded());
  result.u_independent_phase_rad = std::min(any_phase, 0.5 * result.independent_phase.expanded());
  if (const double snr = result.u_magnitude > 0.0 ? result.magnitude / result.u_magnitude : 1e12;
      snr < weak_mean) {
    const double weak = phase_standard_uncertainty(snr);
    result.u_phase_rad = std::hypot(weak, centre.common_phase);
    result.u_independent_phase_rad = weak;
  }
  return result;
}

Expected<void> check(const std::vector<Repetition>& repetitions) {
  if (repetitions.empty()) {
    return fail(ErrorCode::invalid_argument, "a mean needs at least one repetition");
  }
  if (!std::all_of(repetitions.begin(), repetitions.end(), is_finite)) {
    return fail(ErrorCode::not_finite, "a repetition has a value that is not a number");
  }
  return {};
}

} // namespace

Repetition make_repetition(std::complex<double> h, std::span<const Contribution> budget) {
  Repetition result;
  result.h = h;
  std::vector<UncertaintyPart> magnitudes, phases;
  for (const Contribution& row : budget) {
    magnitudes.push_back({row.u_magnitude_rel, row.degrees_of_freedom});
    phases.push_back({row.u_phase_rad, row.degrees_of_freedom});
    const bool random = row.repeats == Repeats::anew;
    double& magnitude = random ? result.u_random_magnitude_rel : result.u_common_magnitude_rel;
    double& phase = random ? result.u_random_phase_rad : result.u_common_phase_rad;
    magnitude = std::hypot(magnitude, random ? drawn_magnitude(row) : row.u_magnitude_rel);
    phase = std::hypot(phase, row.u_phase_rad);
    if (random) {
      result.u_common_magnitude_rel =
          std::hypot(result.u_common_magnitude_rel, row.u_lasting_magnitude_rel);
    }
    if (random && row.kind != ContributionKind::fit_noise) {
      result.u_not_noise_magnitude_rel =
          std::hypot(result.u_not_noise_magnitude_rel, drawn_magnitude(row));
    }
  }
  result.freedom_magnitude = effective_degrees_of_freedom(magnitudes);
  result.freedom_phase = effective_degrees_of_freedom(phases);
  return result;
}

std::vector<Expected<RepetitionMean>>
means_of_repetitions(std::span<const RepeatedFrequency> frequencies) {
  std::vector<Centre> centres;
  std::vector<RepeatedQuantity> magnitudes, phases;
  for (const RepeatedFrequency& frequency : frequencies) {
    if (check(frequency.repetitions)) {
      centres.push_back(centre_of(frequency));
      magnitudes.push_back(centres.back().magnitude);
      phases.push_back(centres.back().phase);
    }
  }
  const std::vector<MeanError> magnitude_errors = errors_of_means(magnitudes);
  const std::vector<MeanError> phase_errors = errors_of_means(phases);
  std::vector<Expected<RepetitionMean>> means;
  std::size_t next = 0;
  for (const RepeatedFrequency& frequency : frequencies) {
    if (const auto checked = check(frequency.repetitions); !checked) {
      means.emplace_back(fail(checked.error()));
    } else {
      RepetitionMean mean = mean_from(centres[next], magnitude_errors[next], phase_errors[next]);
      mean.polarity_differs = have_opposite_phases(frequency.repetitions);
      means.emplace_back(std::move(mean));
      ++next;
    }
  }
  return means;
}

Expected<RepetitionMean> mean_of_repetitions(std::span<const Repetition> repetitions) {
  const RepeatedFrequency one{0.0, {repetitions.begin(), repetitions.end()}};
  return means_of_repetitions(std::span(&one, 1)).front();
}

} // namespace dyncal::analysis
