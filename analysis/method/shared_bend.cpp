#include "analysis/method/shared_bend.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::analysis {
namespace {

constexpr double shown = 23.0;    // chi-squared of two degrees of freedom: 1e-5
constexpr double excluded = 13.8; // 1e-3

// Of both orders: of the step itself, or against another one.
double chi_squared_against(const StepBend& step, const StepBend* other) {
  double sum = 0.0;
  for (std::size_t k = 0; k < step.bend.turn_rad.size(); ++k) {
    double off_s = step.bend.turn_rad[k] / step.angular_hz;
    double variance_s2 = std::pow(step.bend.u_rad[k] / step.angular_hz, 2);
    if (other) {
      off_s -= other->bend.turn_rad[k] / other->angular_hz;
      variance_s2 += std::pow(other->bend.u_rad[k] / other->angular_hz, 2);
    }
    sum += variance_s2 > 0.0 ? off_s * off_s / variance_s2 : 0.0;
  }
  return sum;
}

} // namespace

std::vector<bool> steps_that_bend(std::span<const StepBend> steps) {
  std::vector<const StepBend*> showing;
  for (const StepBend& step : steps) {
    if (chi_squared_against(step, nullptr) > shown) {
      showing.push_back(&step);
    }
  }
  std::vector<bool> result;
  for (const StepBend& step : steps) {
    result.push_back(std::any_of(showing.begin(), showing.end(), [&](const StepBend* other) {
      return other == &step || chi_squared_against(step, other) <= excluded;
    }));
  }
  return result;
}

} // namespace dyncal::analysis
