#include "analysis/sine/unresolved_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "analysis/sine/sine_values.hpp"

namespace dyncal::analysis {
namespace {

constexpr double resolved = 1.5; // distance in 1 / T
constexpr int max_multiple = 10;
constexpr std::array mains_hz{50.0, 60.0};
constexpr std::array hum_hz{50.0, 100.0, 150.0, 60.0, 120.0, 180.0};
constexpr double usable_part_of_rate = 0.45;

double folded(double line_hz, double rate_hz) {
  return rate_hz > 0.0 ? std::abs(line_hz - rate_hz * std::round(line_hz / rate_hz)) : line_hz;
}

double leakage(double distance_hz, double duration_s) {
  const double turns = std::abs(distance_hz) * duration_s;
  const double angle = std::numbers::pi * turns;
  if (turns < 1e-6) {
    return 1.0;
  }
  return turns < 0.5 ? std::sin(angle) / angle : 1.0 / angle;
}

} // namespace

std::vector<UnresolvedLine> unresolved_lines(double frequency_hz, double duration_s,
                                             double rate_hz) {
  std::vector<UnresolvedLine> result;
  if (!(frequency_hz > 0.0 && duration_s > 0.0)) {
    return result;
  }
  const auto consider = [&](LineKind kind, double line_hz, int order) {
    const double distance = std::abs(folded(line_hz, rate_hz) - folded(frequency_hz, rate_hz));
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
  const double u = line_amplitude * leakage(line.distance_hz, duration_s) /
                   (std::numbers::sqrt2 * signal_amplitude);
  return {u, u};
}

std::vector<HumLine> resolved_hum(const Frequency& frequency, const SineFit& fit,
                                  std::int64_t phase_origin_ns,
                                  std::span<const std::int64_t> stamps_ns,
                                  std::span<const double> values) {
  std::vector<HumLine> result;
  if (stamps_ns.size() < 2 || values.size() != stamps_ns.size()) {
    return result;
  }
  const double duration_s = static_cast<double>(stamps_ns.back() - stamps_ns.front()) * 1e-9;
  const double rate_hz = static_cast<double>(stamps_ns.size() - 1) / duration_s;
  std::vector<double> sine(values.size()), cosine(values.size()), residuals(values.size());
  fill_sine_cosine(frequency, phase_origin_ns, stamps_ns, sine.data(), cosine.data());
  for (std::size_t i = 0; i < values.size(); ++i) {
    residuals[i] = values[i] - fit.offset - fit.sine * sine[i] - fit.cosine * cosine[i];
  }
  const std::span<const double> channel[] = {residuals};
  for (const double line : hum_hz) {
    const double f = frequency.hz();
    const double distance = std::abs(line - f * std::max(1.0, std::round(line / f)));
    if (line > usable_part_of_rate * rate_hz || distance * duration_s < resolved ||
        line * duration_s < resolved) {
      continue;
    }
    const auto lines = fit_sine(Frequency::from_hz(line), phase_origin_ns, stamps_ns, channel);
    if (lines) {
      result.push_back({line, lines->front().amplitude(), lines->front().u_amplitude()});
    } else if (lines.error().code == ErrorCode::no_excitation) {
      // Not seen: what a fit of pure noise cannot show is four times its uncertainty at most.
      double squares = 0.0;
      for (const double residual : residuals) {
        squares += residual * residual;
      }
      const double n = static_cast<double>(residuals.size());
      result.push_back({line, 0.0, 2.0 * std::sqrt(2.0 * squares) / n});
    }
  }
  return result;
}

} // namespace dyncal::analysis
