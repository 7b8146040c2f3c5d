#include "analysis/uncertainty/background_power.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>
#include <vector>

#include "analysis/base/chi_squared_limit.hpp"
#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr double noise_degrees = 12.0; // of u_i^2 (background_spectrum.hpp), in pairs of components
constexpr double significant_sd = 4.0; // of the normal deviate: by chance 3 in 100 000
constexpr double significant_one = 8.4; // u: by chance 4 in 1 000 000 with noise known as badly
constexpr double seen_one = 4.5;        // u: large enough to be compared with others
constexpr std::size_t enough_seen = 3;  // so many tell how it depends on the drive
constexpr double driven_alike = 1.1;    // ratio of excitations
constexpr double driven_unlike = 1.5;
constexpr double much_noisier = 3.0;       // than the usual step
constexpr double few_amplitudes = 3.0;     // see the header
constexpr double clearly_better = 4.0;     // ratio of the variances
constexpr double beyond_accounted = 3.719; // normal quantile, once in 10^4
constexpr double beyond_beside = 2.5;      // ratio of the variances
constexpr double noise_of_hann = 1.5;      // variance, to that of the whole record's coefficient

// Normal deviate of a ratio of variances (Wilson and Hilferty).
double deviate_of_f(double ratio, double degrees, double degrees_of_noise) {
  const double own = 2.0 / (9.0 * degrees), other = 2.0 / (9.0 * degrees_of_noise);
  const double root = std::cbrt(ratio);
  return ((1.0 - other) * root - (1.0 - own)) / std::sqrt(own + other * root * root);
}

double usual_noise(std::span<const MeasuredBackground> measured) {
  std::vector<double> all_u;
  for (const MeasuredBackground& one : measured) {
    all_u.push_back(one.line.u_component);
  }
  return median(std::move(all_u));
}

// Steps that are much noisier than others count by their own noise; among the others it is shared,
// for each knows it badly.
bool is_significant(std::span<const MeasuredBackground> measured) {
  const double usual = usual_noise(measured);
  double shown = 0.0, noise = 0.0;
  bool one = false;
  for (const auto& [line, excitation] : measured) {
    const double scale = line.u_component > much_noisier * usual ? line.u_component : usual;
    shown += 0.5 * std::pow(line.amplitude / scale, 2);
    noise += std::pow(line.u_component / scale, 2);
    one |= line.amplitude > significant_one * line.u_component;
  }
  const double n = static_cast<double>(measured.size());
  return one || !(deviate_of_f(shown / noise, 2.0 * n, noise_degrees * n) < significant_sd);
}

// Noise of a width raises what is beside the frequency too; but u holds what the step itself shows,
// and a record of few pieces may show little.
bool exceeds(std::span<const MeasuredBackground> measured, double accounted) {
  double shown = 0.0, beside = 0.0;
  for (const auto& [line, excitation] : measured) {
    shown += 0.5 * line.amplitude * line.amplitude;
    beside += line.u_component * line.u_component;
  }
  const double n = static_cast<double>(measured.size());
  const double held = noise_of_hann * n * accounted * accounted;
  return held > 0.0 && shown > held * chi_squared_limit(2.0 * n, beyond_accounted) &&
         shown > beyond_beside * beside;
}

double mean_of_larger_half(std::vector<double> squares) {
  const std::size_t half = (squares.size() + 1) / 2;
  std::partial_sort(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(half),
                    squares.end(), std::greater<>());
  return std::accumulate(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(half),
                         0.0) /
         static_cast<double>(half);
}

enum class Growth { none, with_drive, unknown };

Growth growth_of(std::span<const MeasuredBackground> measured, double excitation) {
  std::vector<double> amplitudes, ratios, driven;
  bool alike = true;
  for (const auto& [line, own] : measured) {
    alike &= own < driven_alike * excitation && excitation < driven_alike * own;
    if (line.amplitude > seen_one * line.u_component && own > 0.0) {
      amplitudes.push_back(std::log(line.amplitude));
      ratios.push_back(std::log(line.amplitude / own));
      driven.push_back(own);
    }
  }
  if (alike) {
    return Growth::none;
  }
  if (driven.size() < enough_seen ||
      *std::max_element(driven.begin(), driven.end()) <
          driven_unlike * *std::min_element(driven.begin(), driven.end())) {
    return Growth::unknown;
  }
  const double constant = standard_deviation(amplitudes), growing = standard_deviation(ratios);
  const double better = std::sqrt(clearly_better);
  return growing > better * constant   ? Growth::none
         : constant > better * growing ? Growth::with_drive
                                       : Growth::unknown;
}

std::vector<MeasuredAmplitude> with_shared_noise(std::span<const MeasuredBackground> measured) {
  const double usual = usual_noise(measured);
  std::vector<MeasuredAmplitude> shared;
  for (const auto& [line, excitation] : measured) {
    shared.push_back({line.amplitude, std::max(usual, line.u_component)});
  }
  return shared;
}

} // namespace

double expected_background(std::span<const MeasuredBackground> measured) {
  return measured.empty() ? 0.0 : expected_square(with_shared_noise(measured));
}

std::optional<double> significant_background(std::span<const MeasuredBackground> measured,
                                             double excitation, bool constant, double accounted) {
  if (measured.empty() || (!is_significant(measured) && !exceeds(measured, accounted))) {
    return std::nullopt;
  }
  const Growth growth = constant ? Growth::none : growth_of(measured, excitation);
  std::vector<double> as_seen, grown;
  for (const auto& [line, own] : measured) {
    const double square =
        std::max(0.0, line.amplitude * line.amplitude - 2.0 * line.u_component * line.u_component);
    as_seen.push_back(square);
    grown.push_back(own > 0.0 ? square * std::pow(excitation / own, 2) : square);
  }
  const double n = static_cast<double>(measured.size());
  const double few = 1.0 + few_amplitudes / (n * n);
  const double constant_square = few * mean_of_larger_half(as_seen);
  const double grown_square = few * mean_of_larger_half(grown);
  return growth == Growth::none         ? constant_square
         : growth == Growth::with_drive ? grown_square
                                        : std::max(constant_square, grown_square);
}

} // namespace dyncal::analysis
