#include "analysis/uncertainty/law_of_propagation.hpp"

#include <cmath>

#include "analysis/uncertainty/coverage.hpp"

namespace dyncal::analysis {
namespace {

tl::unexpected<Error> invalid(std::string message) {
  return fail(ErrorCode::invalid_argument, std::move(message));
}

} // namespace

Expected<PropagatedUncertainty>
propagate_uncertainty(std::span<const InputQuantity> inputs,
                      std::span<const InputCorrelation> correlations) {
  PropagatedUncertainty result;
  std::vector<UncertaintyPart> parts;
  double variance = 0.0;
  for (const InputQuantity& input : inputs) {
    if (!(input.u >= 0.0) || !std::isfinite(input.u) || !std::isfinite(input.sensitivity)) {
      return invalid(input.name +
                     ": uncertainty and sensitivity must be numbers, the uncertainty not negative");
    }
    if (!(input.degrees_of_freedom > 0.0)) {
      return invalid(input.name + ": degrees of freedom must be positive");
    }
    const double contribution = input.sensitivity * input.u;
    result.contributions.push_back(contribution);
    parts.push_back({std::abs(contribution), input.degrees_of_freedom});
    variance += contribution * contribution;
  }
  for (const InputCorrelation& correlation : correlations) {
    if (correlation.first >= inputs.size() || correlation.second >= inputs.size() ||
        correlation.first == correlation.second) {
      return invalid("a correlation names an input that does not exist, or twice the same");
    }
    if (!(std::abs(correlation.coefficient) <= 1.0)) {
      return invalid(inputs[correlation.first].name + " and " + inputs[correlation.second].name +
                     ": a correlation coefficient lies in [-1, 1]");
    }
    variance += 2.0 * correlation.coefficient * result.contributions[correlation.first] *
                result.contributions[correlation.second];
  }
  double scale = 0.0;
  for (const double contribution : result.contributions) {
    scale += contribution * contribution;
  }
  if (variance < -1e-12 * scale) {
    return invalid("the correlations contradict each other: the variance would be negative");
  }
  result.u = std::sqrt(std::max(0.0, variance));
  // Welch and Satterthwaite with the combined uncertainty, correlations included.
  double weighted = 0.0;
  for (const UncertaintyPart& part : parts) {
    weighted += std::pow(part.u, 4) / part.degrees_of_freedom;
  }
  result.degrees_of_freedom =
      weighted > 0.0 ? std::pow(result.u, 4) / weighted : infinite_degrees_of_freedom;
  result.k = coverage_factor(result.degrees_of_freedom);
  result.expanded = result.k * result.u;
  return result;
}

} // namespace dyncal::analysis
