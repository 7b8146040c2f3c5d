#include "analysis/response/group_delay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <string>

#include "analysis/base/chi_squared_limit.hpp"
#include "analysis/base/phasor.hpp"
#include "analysis/response/delay_branches.hpp"

namespace dyncal::analysis {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double weakest_phase_rad = 0.5; // a point less certain than this does not count
constexpr std::size_t min_to_search = 6;

std::string hertz(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') {
    text.pop_back();
  }
  return text + " Hz";
}

std::optional<Error> problem_with(std::span<const PhasePoint> points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(points[i].phase_rad) || !(points[i].u_phase_rad > 0.0) ||
        !std::isfinite(points[i].u_phase_rad)) {
      return Error{ErrorCode::invalid_argument, "the phase at " + hertz(points[i].frequency_hz) +
                                                    " has no value or no uncertainty"};
    }
    if (!(points[i].frequency_hz > (i == 0 ? 0.0 : points[i - 1].frequency_hz))) {
      return Error{ErrorCode::invalid_argument,
                   "the frequencies of a phase response must be positive and rising"};
    }
  }
  return std::nullopt;
}

std::vector<PhasePoint> points_that_count(std::span<const PhasePoint> points) {
  std::vector<PhasePoint> result;
  std::copy_if(points.begin(), points.end(), std::back_inserter(result),
               [](const PhasePoint& point) { return point.u_phase_rad <= weakest_phase_rad; });
  return result;
}

double agreement(const std::vector<PhasePoint>& points, double delay_s) {
  std::complex<double> sum;
  for (const PhasePoint& point : points) {
    sum += std::polar(1.0, point.phase_rad + 2.0 * pi * point.frequency_hz * delay_s);
  }
  return std::abs(sum) / static_cast<double>(points.size());
}

// The delay for which all phases agree best; empty when chance could do as well (once in a
// thousand).
std::optional<double> search_delay(const std::vector<PhasePoint>& points) {
  if (points.size() < min_to_search) {
    return std::nullopt;
  }
  double spacing = points[1].frequency_hz - points[0].frequency_hz;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    spacing = std::min(spacing, points[i + 1].frequency_hz - points[i].frequency_hz);
  }
  const double range_s = 0.5 / spacing;
  const double span_hz = points.back().frequency_hz - points.front().frequency_hz;
  double step_s = 0.1 / span_hz;
  if (range_s / step_s > 1e5) {
    return std::nullopt;
  }
  double best_delay = 0.0, best = 0.0;
  for (double delay = 0.0; delay <= range_s; delay += step_s) {
    for (const double candidate : {delay, -delay}) {
      if (const double score = agreement(points, candidate);
          score > best * (1.0 + 1e-9)) { // of equals the shortest
        best = score;
        best_delay = candidate;
      }
    }
  }
  for (; step_s * span_hz > 1e-6; step_s *= 0.5) {
    for (const double candidate : {best_delay - step_s, best_delay + step_s}) {
      if (const double score = agreement(points, candidate); score > best) {
        best = score;
        best_delay = candidate;
      }
    }
  }
  const double trials = 2.0 * range_s * span_hz + 1.0;
  const double by_chance = trials * std::exp(-static_cast<double>(points.size()) * best * best);
  return by_chance < 1e-3 ? std::optional(best_delay) : std::nullopt;
}

// From point to point with the slope of the two before; `delay_s` is taken out first where it is
// known.
Expected<std::vector<double>> unwrap_points_that_count(const std::vector<PhasePoint>& points) {
  const std::optional<double> delay_s = search_delay(points);
  const auto turned = [&](const PhasePoint& point) {
    return 2.0 * pi * point.frequency_hz * delay_s.value_or(0.0);
  };
  std::vector<double> unwrapped;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double phase = points[i].phase_rad + turned(points[i]);
    if (i == 0) {
      unwrapped.push_back(wrap_phase(phase));
      continue;
    }
    double predicted = unwrapped[i - 1];
    if (!delay_s && i >= 2) {
      const double slope = (unwrapped[i - 1] - unwrapped[i - 2]) /
                           (points[i - 1].frequency_hz - points[i - 2].frequency_hz);
      predicted += slope * (points[i].frequency_hz - points[i - 1].frequency_hz);
    }
    const double step = wrap_phase(phase - predicted);
    const double u = std::hypot(points[i].u_phase_rad, points[i - 1].u_phase_rad);
    if (std::abs(step) >= pi - 3.0 * u) {
      return fail(ErrorCode::not_converged,
                  "the phase cannot be unwrapped from " + hertz(points[i - 1].frequency_hz) +
                      " to " + hertz(points[i].frequency_hz) + ", measure at closer frequencies");
    }
    unwrapped.push_back(predicted + step);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    unwrapped[i] -= turned(points[i]);
  }
  return unwrapped;
}

// The line that the phases follow from point to point; where it does not fit, the least delay of a
// sensor that does.
struct Choice {
  DelayBranch branch;
  std::vector<double> alternatives_s; // that fit as well
};

Expected<Choice> choose_branch(const std::vector<PhasePoint>& points) {
  auto unwrapped = unwrap_points_that_count(points);
  std::vector<DelayBranch> fitting = delay_branches(points);
  const double freedom = static_cast<double>(points.size()) - 2.0;
  if (!unwrapped && (freedom < 1.0 || fitting.size() != 1)) {
    return fail(unwrapped.error());
  }
  Choice choice;
  if (unwrapped) {
    choice.branch = {fit_delay_line(points, *unwrapped), std::move(*unwrapped)};
  }
  const bool fits =
      unwrapped && (freedom < 1.0 || choice.branch.line.chi_squared <=
                                         freedom * chi_squared_limit(freedom, once_in_a_thousand));
  if (!fits && fitting.empty()) {
    return choice; // no straight line
  }
  if (!fits) {
    choice.branch = fitting.front();
  }
  const double apart_s = 0.1 / (points.back().frequency_hz - points.front().frequency_hz);
  for (const DelayBranch& other : fitting) {
    if (std::abs(other.line.delay_s - choice.branch.line.delay_s) > apart_s) {
      choice.alternatives_s.push_back(other.line.delay_s);
    }
  }
  return choice;
}

std::vector<double> covariance_of(std::span<const PhasePoint> points,
                                  const CommonPhaseUncertainty& common) {
  std::vector<double> covariance;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < points.size(); ++j) {
      const double w_i = 2.0 * pi * points[i].frequency_hz;
      const double w_j = 2.0 * pi * points[j].frequency_hz;
      const double shared =
          common.delay_s * common.delay_s * w_i * w_j + common.phase_rad * common.phase_rad;
      covariance.push_back(shared + (i == j ? points[i].u_phase_rad * points[i].u_phase_rad : 0.0));
    }
  }
  return covariance;
}

// Points that do not count follow the line; all are moved by whole turns so that the line starts
// within (-pi, pi].
std::vector<double> place_on_line(std::span<const PhasePoint> points,
                                  const std::vector<double>& counted, const DelayLine& line,
                                  double shift) {
  std::vector<double> result;
  std::size_t next = 0;
  for (const PhasePoint& point : points) {
    const bool counts = point.u_phase_rad <= weakest_phase_rad;
    const double on_line = line.at(point.frequency_hz);
    result.push_back((counts ? counted[next++] : on_line + wrap_phase(point.phase_rad - on_line)) +
                     shift);
  }
  return result;
}

struct KnownVariance {
  double variance = 0.0;
  double degrees_of_freedom = infinite_degrees_of_freedom;
};

struct LineScatter { // by what differs from point to point, k = 1
  KnownVariance delay, intercept;
};

// Shares of the points in the variance of a linear estimate, whose sum is `variance` for U / 2.
class Shares {
public:
  void add(double square, const KnownTo& known) {
    const double share = square * std::pow(2.0 / known.k, 2);
    half_expanded_ += square;
    shares_ += share;
    over_roots_ += share / std::sqrt(known.degrees_of_freedom);
  }
  [[nodiscard]] KnownVariance of(double variance) const {
    return {variance * (shares_ / half_expanded_),
            over_roots_ > 0.0 ? std::pow(shares_ / over_roots_, 2) : infinite_degrees_of_freedom};
  }

private:
  double half_expanded_ = 0.0, shares_ = 0.0, over_roots_ = 0.0;
};

LineScatter scatter_of_line(const std::vector<PhasePoint>& points, const DelayLine& line) {
  const double mean_w = line.covariance / line.variance_delay;
  double weights = 0.0;
  for (const PhasePoint& point : points) {
    weights += 1.0 / (point.u_phase_rad * point.u_phase_rad);
  }
  Shares delay, intercept;
  for (const PhasePoint& point : points) {
    const double from_mean = 2.0 * pi * point.frequency_hz - mean_w;
    const double of_intercept = 1.0 / weights - mean_w * from_mean * line.variance_delay;
    delay.add(std::pow(from_mean / point.u_phase_rad, 2), point.known);
    intercept.add(std::pow(of_intercept / point.u_phase_rad, 2), point.known);
  }
  return {delay.of(line.variance_delay), intercept.of(line.variance_intercept)};
}

CombinedUncertainty combined(const KnownVariance& scatter, double common, const KnownTo& known) {
  const double u_common = 2.0 / known.k * common;
  const std::array parts{UncertaintyPart{std::sqrt(scatter.variance), scatter.degrees_of_freedom},
                         UncertaintyPart{u_common, known.degrees_of_freedom}};
  CombinedUncertainty result = combine(parts);
  result.u = std::sqrt(scatter.variance + u_common * u_common);
  return result;
}

} // namespace

Expected<GroupDelay> evaluate_group_delay(std::span<const PhasePoint> points,
                                          const CommonPhaseUncertainty& common) {
  if (const auto problem = problem_with(points)) {
    return fail(*problem);
  }
  const std::vector<PhasePoint> counted = points_that_count(points);
  if (counted.size() < 2) {
    return fail(
        ErrorCode::too_few_samples,
        "a group delay needs the phase at two frequencies with an uncertainty below 0.5 rad");
  }
  DYNCAL_TRY(const auto choice, choose_branch(counted));
  const DelayLine& line = choice.branch.line;
  GroupDelay result;
  result.alternatives_s = choice.alternatives_s;
  result.delay_s = line.delay_s;
  result.intercept_rad = wrap_phase(line.intercept_rad);
  result.polarity_inverted = std::abs(result.intercept_rad) > 0.5 * pi;
  result.chi_squared = line.chi_squared;
  result.degrees_of_freedom = static_cast<double>(counted.size()) - 2.0;
  const double ratio =
      result.degrees_of_freedom > 0.0 ? result.chi_squared / result.degrees_of_freedom : 0.0;
  const double birge =
      ratio > chi_squared_limit(std::max(1.0, result.degrees_of_freedom), once_in_a_thousand)
          ? ratio
          : 1.0;
  LineScatter scatter = scatter_of_line(counted, line);
  if (birge > 1.0) {
    scatter = {{birge * line.variance_delay, result.degrees_of_freedom},
               {birge * line.variance_intercept, result.degrees_of_freedom}};
  }
  result.of_delay = combined(scatter.delay, common.delay_s, common.delay_known);
  result.of_intercept = combined(scatter.intercept, common.phase_rad, KnownTo{});
  result.cov_delay_intercept = birge * line.covariance;
  result.unwrapped_rad = place_on_line(points, choice.branch.unwrapped_rad, line,
                                       result.intercept_rad - line.intercept_rad);
  result.phase_covariance = covariance_of(points, common);
  return result;
}

} // namespace dyncal::analysis
