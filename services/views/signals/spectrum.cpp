#include "services/views/signals/spectrum.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>

#include <unsupported/Eigen/FFT>

namespace dyncal::inline views {
namespace {

constexpr std::size_t min_samples = 64;
constexpr std::size_t lobe = 4; // lines on either side that a sine takes
constexpr std::size_t max_harmonic = 10;

double window_at(std::size_t i, std::size_t count) {
  const double turn = 2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
  return 0.35875 - 0.48829 * std::cos(turn) + 0.14128 * std::cos(2.0 * turn) -
         0.01168 * std::cos(3.0 * turn);
}

struct Lines {
  std::vector<double> squares; // |X|^2 of lines 0 to N/2
  double sum = 0.0;            // of the window
  double sum_of_squares = 0.0;
  std::size_t count = 0; // N

  [[nodiscard]] double amplitude(std::size_t line) const {
    return 2.0 * std::sqrt(squares[line]) / sum;
  }
  // Of a sine at this line.
  [[nodiscard]] double power(std::size_t line) const {
    const std::size_t first = line > lobe ? line - lobe : 0;
    const std::size_t end = std::min(line + lobe + 1, squares.size());
    const double all = std::accumulate(squares.begin() + static_cast<std::ptrdiff_t>(first),
                                       squares.begin() + static_cast<std::ptrdiff_t>(end), 0.0);
    return 2.0 * all / (static_cast<double>(count) * sum_of_squares);
  }
};

Lines transform(std::span<const double> values) {
  Lines lines;
  lines.count = values.size();
  const double mean =
      std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  std::vector<double> weighted(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double weight = window_at(i, values.size());
    weighted[i] = (values[i] - mean) * weight;
    lines.sum += weight;
    lines.sum_of_squares += weight * weight;
  }
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> transformed;
  fft.fwd(transformed, weighted);
  lines.squares.resize(values.size() / 2 + 1);
  for (std::size_t line = 0; line < lines.squares.size(); ++line) {
    lines.squares[line] = std::norm(transformed[line]);
  }
  return lines;
}

// Place of the fundamental between the lines, by the centre of its power.
double centre_of(const Lines& lines, std::size_t strongest) {
  double weighted = 0.0;
  double all = 0.0;
  const std::size_t end = std::min(strongest + lobe + 1, lines.squares.size());
  for (std::size_t line = strongest - std::min(strongest, lobe); line < end; ++line) {
    weighted += lines.squares[line] * static_cast<double>(line);
    all += lines.squares[line];
  }
  return all > 0.0 ? weighted / all : static_cast<double>(strongest);
}

void find_tones(const Lines& lines, double line_hz, Spectrum& spectrum) {
  const auto begin = lines.squares.begin() + static_cast<std::ptrdiff_t>(lobe) + 1;
  const auto strongest = static_cast<std::size_t>(std::max_element(begin, lines.squares.end()) -
                                                  lines.squares.begin());
  const double centre = centre_of(lines, strongest);
  const double fundamental = lines.power(strongest);
  std::vector<bool> is_tone(lines.squares.size(), false);
  const auto mark = [&](std::size_t line) {
    const std::size_t end = std::min(line + lobe + 1, is_tone.size());
    std::fill(is_tone.begin() + static_cast<std::ptrdiff_t>(line - std::min(line, lobe)),
              is_tone.begin() + static_cast<std::ptrdiff_t>(end), true);
  };
  mark(0);
  mark(strongest);
  double harmonics = 0.0;
  for (std::size_t order = 2; order <= max_harmonic; ++order) {
    const auto line = static_cast<std::size_t>(std::lround(centre * static_cast<double>(order)));
    if (line + lobe >= lines.squares.size()) {
      break;
    }
    harmonics += lines.power(line);
    mark(line);
  }
  spectrum.fundamental_hz = centre * line_hz;
  spectrum.amplitude = std::sqrt(2.0 * fundamental);
  spectrum.thd = fundamental > 0.0 ? std::sqrt(harmonics / fundamental) : 0.0;
  std::vector<double> noise;
  for (std::size_t line = 0; line < is_tone.size(); ++line) {
    if (!is_tone[line]) {
      noise.push_back(lines.amplitude(line));
    }
  }
  if (!noise.empty()) {
    const auto middle = noise.begin() + static_cast<std::ptrdiff_t>(noise.size() / 2);
    std::nth_element(noise.begin(), middle, noise.end());
    spectrum.noise_floor = *middle;
  }
}

} // namespace

Expected<Spectrum> spectrum_of(std::span<const double> values, double rate_hz,
                               std::size_t max_lines) {
  if (values.size() < min_samples || !(rate_hz > 0.0)) {
    return fail(ErrorCode::no_source, "too few samples for a spectrum yet");
  }
  const std::size_t count = std::min(std::bit_floor(values.size()), max_spectrum_samples);
  const Lines lines = transform(values.last(count));
  const double line_hz = rate_hz / static_cast<double>(count);
  Spectrum spectrum;
  spectrum.resolution_hz =
      line_hz * static_cast<double>(count) * lines.sum_of_squares / (lines.sum * lines.sum);
  find_tones(lines, line_hz, spectrum);
  const std::size_t together = (lines.squares.size() + max_lines - 1) / max_lines;
  for (std::size_t first = 0; first < lines.squares.size(); first += together) {
    std::size_t highest = first;
    for (std::size_t line = first; line < std::min(first + together, lines.squares.size());
         ++line) {
      highest = lines.squares[line] > lines.squares[highest] ? line : highest;
    }
    spectrum.lines.emplace_back(static_cast<double>(highest) * line_hz, lines.amplitude(highest));
  }
  return spectrum;
}

} // namespace dyncal::inline views
