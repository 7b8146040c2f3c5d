#include "services/views/report/expanded_uncertainty.hpp"

#include <cmath>
#include <vector>

#include <fmt/core.h>

#include "analysis/uncertainty/coverage.hpp"
#include "services/views/language/statement_sentences.hpp"

namespace dyncal::inline views {
namespace {

// Student's factor of four degrees of freedom: five repetitions show their scatter well enough.
constexpr double large_k = 2.87;

template <class UncertaintyOf>
ExpandedUncertainty of_budget(double u, const StepResult& result, UncertaintyOf u_of) {
  std::vector<analysis::UncertaintyPart> parts;
  for (const analysis::Contribution& row : result.budget) {
    parts.push_back({u_of(row), row.degrees_of_freedom});
  }
  const double nu_eff = analysis::effective_degrees_of_freedom(parts);
  const double k = analysis::coverage_factor(nu_eff);
  return {.u = u, .k = k, .nu_eff = nu_eff, .expanded = k * u};
}

// `half` is U / 2: how a mean states its uncertainty.
ExpandedUncertainty of_mean(double half, const analysis::CombinedUncertainty& combined) {
  const double k = std::isfinite(combined.k) && combined.k > 0.0 ? combined.k : 2.0;
  return {
      .u = 2.0 * half / k, .k = k, .nu_eff = combined.degrees_of_freedom, .expanded = 2.0 * half};
}

} // namespace

ExpandedUncertainty magnitude_uncertainty(const StepResult& result) {
  return of_budget(result.u_magnitude, result,
                   [](const analysis::Contribution& row) { return row.u_magnitude_rel; });
}

ExpandedUncertainty phase_uncertainty(const StepResult& result) {
  return of_budget(result.u_phase_rad, result,
                   [](const analysis::Contribution& row) { return row.u_phase_rad; });
}

ExpandedUncertainty magnitude_uncertainty(const analysis::RepetitionMean& mean) {
  return of_mean(mean.u_magnitude, mean.magnitude_rel);
}

ExpandedUncertainty phase_uncertainty(const analysis::RepetitionMean& mean) {
  return of_mean(mean.u_phase_rad, mean.phase);
}

std::string notable_k_text(double k) {
  return k > notable_k ? fmt::format(", k = {:.2f}", k) : "";
}

std::string advice_on_repetitions(double largest_k, Language language) {
  return largest_k > large_k ? sentences::repeat_more(language) : "";
}

} // namespace dyncal::inline views
