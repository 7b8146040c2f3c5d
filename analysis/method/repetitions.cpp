#include "analysis/method/repetitions.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/base/phasor.hpp"
#include "analysis/uncertainty/coverage.hpp"

namespace dyncal::analysis {
namespace {

bool is_finite(const Repetition& repetition) {
  return std::isfinite(repetition.h.real()) && std::isfinite(repetition.h.imag()) &&
         std::isfinite(repetition.u_random_magnitude_rel) &&
         std::isfinite(repetition.u_random_phase_rad) &&
         std::isfinite(repetition.u_common_magnitude_rel) &&
         std::isfinite(repetition.u_common_phase_rad);
}

struct Scatter {               // of one quantity over the repetitions
  double squares = 0.0;        // sum of squared deviations from the mean
  double random_squares = 0.0; // sum of squared u of single repetitions
  double common = 0.0;         // the largest u that all have in common
};

CombinedUncertainty combine(double u_random_mean, double random_freedom, double u_common) {
  const std::array parts{UncertaintyPart{u_random_mean, random_freedom}, UncertaintyPart{u_common}};
  CombinedUncertainty result;
  result.u = std::hypot(u_random_mean, u_common);
  if (!(result.u > 0.0)) {
    return result;
  }
  result.degrees_of_freedom = effective_degrees_of_freedom(parts);
  const double by_effective_freedom = coverage_factor(result.degrees_of_freedom);
  const double by_parts = std::hypot(coverage_factor(random_freedom) * u_random_mean,
                                     coverage_factor(infinite_degrees_of_freedom) * u_common) /
                          result.u;
  result.k = by_effective_freedom + (by_parts - by_effective_freedom) / 3.0;
  return result;
}

// Observed scatter against what the fits expect: the wider interval counts.
CombinedUncertainty wider(const Scatter& scatter, double n, double u_common) {
  const CombinedUncertainty expected =
      combine(std::sqrt(scatter.random_squares) / n, infinite_degrees_of_freedom, u_common);
  if (n < 2.0) {
    return expected;
  }
  const CombinedUncertainty observed =
      combine(std::sqrt(scatter.squares / (n - 1.0) / n), n - 1.0, u_common);
  return observed.u * observed.k > expected.u * expected.k ? observed : expected;
}

double drawn_magnitude(const Contribution& row) {
  return std::sqrt(std::max(0.0, row.u_magnitude_rel * row.u_magnitude_rel -
                                     row.u_lasting_magnitude_rel * row.u_lasting_magnitude_rel));
}

double half_interval(const CombinedUncertainty& uncertainty) {
  return 0.5 * uncertainty.k * uncertainty.u;
}

} // namespace

Repetition make_repetition(std::complex<double> h, std::span<const Contribution> budget) {
  Repetition result;
  result.h = h;
  for (const Contribution& row : budget) {
    const bool random = row.repeats == Repeats::anew;
    double& magnitude = random ? result.u_random_magnitude_rel : result.u_common_magnitude_rel;
    double& phase = random ? result.u_random_phase_rad : result.u_common_phase_rad;
    magnitude = std::hypot(magnitude, random ? drawn_magnitude(row) : row.u_magnitude_rel);
    phase = std::hypot(phase, row.u_phase_rad);
    if (random) {
      result.u_common_magnitude_rel =
          std::hypot(result.u_common_magnitude_rel, row.u_lasting_magnitude_rel);
    }
  }
  return result;
}

Expected<RepetitionMean> mean_of_repetitions(std::span<const Repetition> repetitions) {
  if (repetitions.empty()) {
    return fail(ErrorCode::invalid_argument, "a mean needs at least one repetition");
  }
  const double n = static_cast<double>(repetitions.size());
  RepetitionMean result;
  result.repetitions = repetitions.size();
  for (const Repetition& repetition : repetitions) {
    if (!is_finite(repetition)) {
      return fail(ErrorCode::not_finite, "a repetition has a value that is not a number");
    }
    result.h += repetition.h / n;
  }
  result.magnitude = std::abs(result.h);
  result.phase_rad = std::arg(result.h);

  // Uncertainties of single repetitions are relative to their own magnitude, those of the mean to
  // the mean's.
  const double unit = result.magnitude > 0.0 ? result.magnitude : 1.0;
  const std::complex<double> direction = unit_phasor(result.h);
  Scatter magnitude, phase;
  for (const Repetition& repetition : repetitions) {
    const std::complex<double> deviation = (repetition.h - result.h) * std::conj(direction) / unit;
    const double size = std::abs(repetition.h) / unit;
    magnitude.squares += deviation.real() * deviation.real();
    phase.squares += deviation.imag() * deviation.imag();
    magnitude.random_squares += std::pow(size * repetition.u_random_magnitude_rel, 2);
    phase.random_squares += std::pow(repetition.u_random_phase_rad, 2);
    magnitude.common = std::max(magnitude.common, size * repetition.u_common_magnitude_rel);
    phase.common = std::max(phase.common, repetition.u_common_phase_rad);
  }
  if (repetitions.size() > 1) {
    result.scatter_magnitude = unit * std::sqrt(magnitude.squares / (n - 1.0));
    result.scatter_phase_rad = std::sqrt(phase.squares / (n - 1.0));
  }
  result.magnitude_rel = wider(magnitude, n, magnitude.common);
  result.phase = wider(phase, n, phase.common);
  result.u_magnitude = unit * half_interval(result.magnitude_rel);
  result.u_phase_rad = half_interval(result.phase);
  result.u_independent_phase_rad = half_interval(wider(phase, n, 0.0));
  if (const double snr = result.u_magnitude > 0.0 ? result.magnitude / result.u_magnitude : 1e12;
      snr < 10.0) {
    const double weak = phase_standard_uncertainty(snr);
    result.u_phase_rad = std::hypot(weak, phase.common);
    result.u_independent_phase_rad = weak;
  }
  return result;
}

} // namespace dyncal::analysis
