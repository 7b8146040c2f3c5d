#include "analysis/sine/unresolved_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr double apart = 1.5; // distance of lines in 1 / T
constexpr int max_multiple = 10;
constexpr std::size_t min_samples = 16;
constexpr double mains_wander_rel = 1e-3; // 50 mHz at 50 Hz

double leakage(double distance_hz, double duration_s) {
  const double turns = std::abs(distance_hz) * duration_s;
  const double angle = std::numbers::pi * turns;
  if (turns < 1e-6) {
    return 1.0;
  }
  return turns < 0.5 ? std::sin(angle) / angle : 1.0 / angle;
}

double wander_of(const UnresolvedLine& line) {
  return line.kind == LineKind::mains ? mains_wander_rel * line.line_hz : 0.0;
}

} // namespace

double folded_hz(double line_hz, double rate_hz) {
  return rate_hz > 0.0 ? std::abs(line_hz - rate_hz * std::round(line_hz / rate_hz)) : line_hz;
}

std::vector<UnresolvedLine> unresolved_lines(double frequency_hz, double duration_s, double rate_hz,
                                             std::span<const double> mains_hz, double resolved) {
  std::vector<UnresolvedLine> result;
  if (!(frequency_hz > 0.0 && duration_s > 0.0)) {
    return result;
  }
  const auto consider = [&](LineKind kind, double line_hz, int order) {
    const double distance =
        std::abs(folded_hz(line_hz, rate_hz) - folded_hz(frequency_hz, rate_hz));
    const bool known = std::any_of(result.begin(), result.end(), [&](const UnresolvedLine& other) {
      return std::abs(other.line_hz - line_hz) * duration_s < resolved;
    });
    if (distance * duration_s < resolved && !known) {
      result.push_back({kind, line_hz, order, distance});
    }
  };
  for (const double mains : mains_hz) {
    for (int k = 1; k <= max_multiple; ++k) {
      consider(LineKind::mains, k * mains, k);
    }
  }
  for (int k = 2; k <= max_multiple; ++k) {
    consider(LineKind::harmonic, k * frequency_hz, k);
  }
  std::sort(result.begin(), result.end(), [](const UnresolvedLine& a, const UnresolvedLine& b) {
    return a.distance_hz < b.distance_hz;
  });
  return result;
}

LineUncertainty line_uncertainty(const UnresolvedLine& line, double line_amplitude,
                                 double signal_amplitude, double duration_s) {
  if (!(signal_amplitude > 0.0)) {
    return {};
  }
  const double distance_hz = std::max(0.0, line.distance_hz - wander_of(line));
  const double u =
      line_amplitude * leakage(distance_hz, duration_s) / (std::numbers::sqrt2 * signal_amplitude);
  return {u, u};
}

double largest_beat_rel(const UnresolvedLine& line, double line_amplitude, double signal_amplitude,
                        double duration_s) {
  if (!(signal_amplitude > 0.0)) {
    return 0.0;
  }
  const double turns = std::min(0.5, (line.distance_hz + wander_of(line)) * duration_s);
  return 2.0 * line_amplitude / signal_amplitude * std::sin(std::numbers::pi * turns);
}

bool is_resolved(double line_hz, int order, double frequency_hz, double duration_s,
                 double rate_hz) {
  const double line = folded_hz(line_hz, rate_hz);
  const double margin_hz = apart / duration_s;
  if (line < margin_hz || 0.5 * rate_hz - line < 0.5 * margin_hz) {
    return false;
  }
  for (int k = 1; k < (order > 0 ? order : max_multiple + 1); ++k) {
    if (std::abs(line - folded_hz(k * frequency_hz, rate_hz)) < margin_hz) {
      return false;
    }
  }
  return true;
}

std::optional<LineAmplitude> measure_line(double line_hz, std::span<const std::int64_t> stamps_ns,
                                          std::span<const double> residuals) {
  if (residuals.size() < min_samples || stamps_ns.size() != residuals.size()) {
    return std::nullopt;
  }
  constexpr std::size_t block = 512;
  std::array<double, block> sine{}, cosine{};
  const Frequency frequency = Frequency::from_hz(line_hz);
  double s = 0.0, c = 0.0, ss = 0.0, sc = 0.0, cc = 0.0, e = 0.0, ee = 0.0, es = 0.0, ec = 0.0;
  for (std::size_t first = 0; first < residuals.size(); first += block) {
    const std::size_t n = std::min(block, residuals.size() - first);
    fill_sine_cosine(frequency, stamps_ns.front(), stamps_ns.subspan(first, n), sine.data(),
                     cosine.data());
    for (std::size_t i = 0; i < n; ++i) {
      const double r = residuals[first + i];
      s += sine[i];
      c += cosine[i];
      ss += sine[i] * sine[i];
      sc += sine[i] * cosine[i];
      cc += cosine[i] * cosine[i];
      e += r;
      ee += r * r;
      es += r * sine[i];
      ec += r * cosine[i];
    }
  }
  const double n = static_cast<double>(residuals.size());
  const double a = ss - s * s / n, b = sc - s * c / n, d = cc - c * c / n;
  const double u = es - s * e / n, v = ec - c * e / n;
  const double determinant = a * d - b * b;
  if (!(determinant > 1e-3 * n * n)) { // n^2 / 4 where nothing is in the way
    return std::nullopt;
  }
  const double in_sine = (d * u - b * v) / determinant;
  const double in_cosine = (a * v - b * u) / determinant;
  const double rest = ee - e * e / n - in_sine * u - in_cosine * v;
  return LineAmplitude{std::hypot(in_sine, in_cosine),
                       std::sqrt(std::max(0.0, rest) / (n - 3.0) * 0.5 * (a + d) / determinant)};
}

std::vector<double> residuals_of(const Frequency& frequency, const SineFit& fit,
                                 std::int64_t phase_origin_ns,
                                 std::span<const std::int64_t> stamps_ns,
                                 std::span<const double> values) {
  std::vector<double> sine(values.size()), cosine(values.size()), residuals(values.size());
  fill_sine_cosine(frequency, phase_origin_ns, stamps_ns, sine.data(), cosine.data());
  for (std::size_t i = 0; i < values.size(); ++i) {
    residuals[i] = values[i] - fit.offset - fit.sine * sine[i] - fit.cosine * cosine[i];
  }
  return residuals;
}

} // namespace dyncal::analysis
