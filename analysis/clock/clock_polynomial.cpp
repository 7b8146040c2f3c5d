#include "analysis/clock/clock_polynomial.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace dyncal::analysis {
namespace {

constexpr int max_order = 12;

std::optional<Error> problem_with(std::span<const BlockPhase> blocks, int order) {
  if (blocks.empty() || order < 1 || order > max_order) {
    return Error{ErrorCode::invalid_argument,
                 "a clock polynomial has an order from 1 to 12 and needs blocks"};
  }
  std::size_t steps = 0;
  for (const BlockPhase& block : blocks) {
    if (!(block.angular_frequency > 0.0) || !(block.u_phase_rad > 0.0) ||
        !std::isfinite(block.phase_rad)) {
      return Error{ErrorCode::invalid_argument,
                   "every block needs a frequency, a phase and a positive uncertainty"};
    }
    steps = std::max(steps, block.step + 1);
  }
  if (steps > blocks.size()) {
    return Error{ErrorCode::invalid_argument,
                 "the steps of the blocks must be numbered from 0 without gaps"};
  }
  return std::nullopt;
}

// Parameters: the coefficients in units of `scale_s`, then a_s of every step. So scaled, all have
// the size of a phase: u_phase / w is a time of nanoseconds, a_s one of radians.
class Residuals {
public:
  Residuals(std::span<const BlockPhase> blocks, int order)
      : blocks_(blocks), powers_(static_cast<std::size_t>(order)) {
    std::int64_t first = blocks.front().time_ns, last = first;
    for (const BlockPhase& block : blocks) {
      first = std::min(first, block.time_ns);
      last = std::max(last, block.time_ns);
      steps_ = std::max(steps_, block.step + 1);
      scale_s_ = std::max(scale_s_, 1.0 / block.angular_frequency);
    }
    origin_ns_ = first + (last - first) / 2;
    half_span_s_ = std::max(1e-9, 0.5 * static_cast<double>(last - first) * 1e-9);
  }

  [[nodiscard]] std::int64_t origin_ns() const { return origin_ns_; }
  [[nodiscard]] double half_span_s() const { return half_span_s_; }
  [[nodiscard]] double scale_s() const { return scale_s_; }

  [[nodiscard]] std::vector<double> start() const {
    std::vector<double> parameters(powers_ + steps_, 0.0);
    for (const BlockPhase& block : blocks_) {
      parameters[powers_ + block.step] = block.phase_rad;
    }
    return parameters;
  }

  void evaluate(std::span<const double> x, std::span<double> residuals,
                std::span<double> jacobian) const {
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const auto row = jacobian.empty() ? jacobian : jacobian.subspan(i * x.size(), x.size());
      residuals[i] = evaluate_block(blocks_[i], x, row);
    }
  }

private:
  double evaluate_block(const BlockPhase& block, std::span<const double> x,
                        std::span<double> jacobian) const {
    const double u = static_cast<double>(block.time_ns - origin_ns_) * 1e-9 / half_span_s_;
    double model = x[powers_ + block.step], power = 1.0;
    for (std::size_t k = 0; k < powers_; ++k) {
      power *= u;
      const double slope = block.angular_frequency * scale_s_ * power;
      model += slope * x[k];
      if (!jacobian.empty()) {
        jacobian[k] = -slope / block.u_phase_rad;
      }
    }
    for (std::size_t s = 0; s < steps_ && !jacobian.empty(); ++s) {
      jacobian[powers_ + s] = s == block.step ? -1.0 / block.u_phase_rad : 0.0;
    }
    return (block.phase_rad - model) / block.u_phase_rad;
  }

  std::span<const BlockPhase> blocks_;
  std::size_t powers_;
  std::size_t steps_ = 0;
  std::int64_t origin_ns_ = 0;
  double half_span_s_ = 1.0;
  double scale_s_ = 0.0;
};

} // namespace

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
  if (const auto problem = problem_with(blocks, order)) {
    return fail(*problem);
  }
  const Residuals model(blocks, order);
  LeastSquaresProblem problem;
  problem.residuals = blocks.size();
  problem.start = model.start();
  problem.loss = loss;
  problem.evaluate = [&](std::span<const double> x, std::span<double> residuals,
                         std::span<double> jacobian) {
    model.evaluate(x, residuals, jacobian);
    return true;
  };
  const auto solution = solve_least_squares(problem);
  if (!solution) {
    return fail(solution.error());
  }

  ClockPolynomial result;
  result.origin_ns = model.origin_ns();
  result.half_span_s = model.half_span_s();
  const double scale_s = model.scale_s();
  const auto powers = static_cast<std::size_t>(order);
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
