#include "analysis/clock/clock_polynomial.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::analysis {
double ClockPolynomial::time_error_s(std::int64_t time_ns) const {
  const double u = static_cast<double>(time_ns - origin_ns) * 1e-9 / half_span_s;
  double value = 0.0;
  for (std::size_t k = coefficients_s.size(); k-- > 0;) {
    value = (value + coefficients_s[k]) * u;
  }
  return value;
}

double ClockPolynomial::rate_error(std::int64_t time_ns) const {
  const double u = static_cast<double>(time_ns - origin_ns) * 1e-9 / half_span_s;
  double value = 0.0;
  for (std::size_t k = coefficients_s.size(); k-- > 0;) {
    value = value * u + static_cast<double>(k + 1) * coefficients_s[k];
  }
  return value / half_span_s;
}

Expected<ClockPolynomial> fit_clock_polynomial(std::span<const BlockPhase> blocks, int order,
                                               Loss loss) {
  if (blocks.empty() || order < 1 || order > 12) {
    return fail(ErrorCode::invalid_argument,
                "a clock polynomial has an order from 1 to 12 and needs blocks");
  }
  std::int64_t first = blocks.front().time_ns, last = first;
  std::size_t steps = 0;
  for (const BlockPhase& block : blocks) {
    if (!(block.angular_frequency > 0.0) || !(block.u_phase_rad > 0.0) ||
        !std::isfinite(block.phase_rad)) {
      return fail(ErrorCode::invalid_argument,
                  "every block needs a frequency, a phase and a positive uncertainty");
    }
    first = std::min(first, block.time_ns);
    last = std::max(last, block.time_ns);
    steps = std::max(steps, block.step + 1);
  }
  if (steps > blocks.size()) {
    return fail(ErrorCode::invalid_argument,
                "the steps of the blocks must be numbered from 0 without gaps");
  }
  ClockPolynomial result;
  result.origin_ns = first + (last - first) / 2;
  result.half_span_s = std::max(1e-9, 0.5 * static_cast<double>(last - first) * 1e-9);

  // Coefficients in units of the phase's scale: u_phase / w is a time of nanoseconds, a_s one of
  // radians.
  const auto powers = static_cast<std::size_t>(order);
  double scale_s = 0.0;
  for (const BlockPhase& block : blocks) {
    scale_s = std::max(scale_s, 1.0 / block.angular_frequency);
  }
  LeastSquaresProblem problem;
  problem.residuals = blocks.size();
  problem.start.assign(powers + steps, 0.0);
  for (const BlockPhase& block : blocks) {
    problem.start[powers + block.step] = block.phase_rad;
  }
  problem.loss = loss;
  problem.evaluate = [&](std::span<const double> x, std::span<double> residuals,
                         std::span<double> jacobian) {
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const BlockPhase& block = blocks[i];
      const double u =
          static_cast<double>(block.time_ns - result.origin_ns) * 1e-9 / result.half_span_s;
      double model = x[powers + block.step], power = 1.0;
      for (std::size_t k = 0; k < powers; ++k) {
        power *= u;
        const double slope = block.angular_frequency * scale_s * power;
        model += slope * x[k];
        if (!jacobian.empty()) {
          jacobian[i * x.size() + k] = -slope / block.u_phase_rad;
        }
      }
      for (std::size_t s = 0; s < steps && !jacobian.empty(); ++s) {
        jacobian[i * x.size() + powers + s] = s == block.step ? -1.0 / block.u_phase_rad : 0.0;
      }
      residuals[i] = (block.phase_rad - model) / block.u_phase_rad;
    }
    return true;
  };
  const auto solution = solve_least_squares(problem);
  if (!solution) {
    return fail(solution.error());
  }

  for (std::size_t k = 0; k < powers; ++k) {
    result.coefficients_s.push_back(scale_s * solution->parameters[k]);
    for (std::size_t l = 0; l < powers; ++l) {
      result.covariance.push_back(scale_s * scale_s * solution->covariance_of(k, l));
    }
  }
  result.step_phases_rad.assign(solution->parameters.begin() + order, solution->parameters.end());
  for (const BlockPhase& block : blocks) {
    result.residuals_s.push_back((block.phase_rad - result.step_phases_rad[block.step]) /
                                     block.angular_frequency -
                                 result.time_error_s(block.time_ns));
  }
  result.chi_squared = solution->rss;
  result.degrees_of_freedom = solution->degrees_of_freedom;
  return result;
}

} // namespace dyncal::analysis
