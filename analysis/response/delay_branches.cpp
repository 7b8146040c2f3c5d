#include "analysis/response/delay_branches.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/base/chi_squared_limit.hpp"
#include "analysis/base/phasor.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double longest_delay_s = 0.05;
constexpr double most_intercept_rad = 0.5; // from 0 or pi
constexpr double step_turns = 0.1;         // of the search: turns over the span of the frequencies
constexpr double max_steps = 1e5;
constexpr double least_agreement = 0.7; // of phases of 0.5 rad, half a step beside their delay

double span_hz(std::span<const PhasePoint> points) {
  return points.back().frequency_hz - points.front().frequency_hz;
}

std::complex<double> sum_turned_back(std::span<const PhasePoint> points, double delay_s) {
  std::complex<double> sum;
  for (const PhasePoint& point : points) {
    sum += std::polar(1.0, point.phase_rad + 2.0 * pi * point.frequency_hz * delay_s);
  }
  return sum / static_cast<double>(points.size());
}

std::vector<double> unwrap_along(std::span<const PhasePoint> points, double delay_s,
                                 double intercept_rad) {
  std::vector<double> result;
  for (const PhasePoint& point : points) {
    const double on_line = intercept_rad - 2.0 * pi * point.frequency_hz * delay_s;
    result.push_back(on_line + wrap_phase(point.phase_rad - on_line));
  }
  return result;
}

bool is_of_a_sensor(const DelayLine& line) {
  const double from_zero = std::abs(wrap_phase(line.intercept_rad));
  const double away = std::min(from_zero, pi - from_zero);
  const double slack_s = 3.0 * std::sqrt(line.variance_delay);
  return line.delay_s >= -slack_s && line.delay_s <= longest_delay_s + slack_s &&
         away <= most_intercept_rad + 3.0 * std::sqrt(line.variance_intercept);
}

} // namespace

double DelayLine::at(double frequency_hz) const {
  return intercept_rad - 2.0 * pi * frequency_hz * delay_s;
}

DelayLine fit_delay_line(std::span<const PhasePoint> points,
                         const std::vector<double>& unwrapped_rad) {
  double weight_sum = 0.0, mean_w = 0.0, mean_phase = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double weight = 1.0 / (points[i].u_phase_rad * points[i].u_phase_rad);
    weight_sum += weight;
    mean_w += weight * 2.0 * pi * points[i].frequency_hz;
    mean_phase += weight * unwrapped_rad[i];
  }
  mean_w /= weight_sum;
  mean_phase /= weight_sum;
  double ww = 0.0, wp = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double weight = 1.0 / (points[i].u_phase_rad * points[i].u_phase_rad);
    const double w = 2.0 * pi * points[i].frequency_hz - mean_w;
    ww += weight * w * w;
    wp += weight * w * (unwrapped_rad[i] - mean_phase);
  }
  DelayLine line;
  line.delay_s = -wp / ww;
  line.intercept_rad = mean_phase + mean_w * line.delay_s;
  line.variance_delay = 1.0 / ww;
  line.variance_intercept = 1.0 / weight_sum + mean_w * mean_w / ww;
  line.covariance = mean_w / ww;
  for (std::size_t i = 0; i < points.size(); ++i) {
    line.chi_squared +=
        std::pow((unwrapped_rad[i] - line.at(points[i].frequency_hz)) / points[i].u_phase_rad, 2);
  }
  return line;
}

std::vector<DelayBranch> delay_branches(std::span<const PhasePoint> points) {
  std::vector<DelayBranch> result;
  const double step_s = step_turns / span_hz(points);
  const double freedom = std::max(1.0, static_cast<double>(points.size()) - 2.0);
  const double most = freedom * chi_squared_limit(freedom, once_in_a_thousand);
  const double last = std::min(max_steps, longest_delay_s / step_s + 1.0);
  for (double number = -1.0; number <= last; number += 1.0) {
    const double delay_s = number * step_s;
    const std::complex<double> sum = sum_turned_back(points, delay_s);
    if (std::abs(sum) < least_agreement) {
      continue;
    }
    DelayBranch branch{{}, unwrap_along(points, delay_s, std::arg(sum))};
    branch.line = fit_delay_line(points, branch.unwrapped_rad);
    const bool known =
        !result.empty() && std::abs(branch.line.delay_s - result.back().line.delay_s) < step_s;
    if (!known && branch.line.chi_squared <= most && is_of_a_sensor(branch.line)) {
      result.push_back(std::move(branch));
    }
  }
  return result;
}

} // namespace dyncal::analysis
