#include "services/evaluation/method/series_clock.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/base/chi_squared_limit.hpp"
#include "analysis/uncertainty/coverage.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double once_in_twenty = 1.645; // normal quantile

} // namespace

ClockReport series_clock_report(const std::string& sensor, double u_acs_rate_rel,
                                std::span<const analysis::NominalFrequency> rates) {
  double weights = 0.0;
  double sum = 0.0;
  const auto weight_of = [](const analysis::NominalFrequency& rate) {
    return 1.0 / (rate.u_real_rate_hz * rate.u_real_rate_hz);
  };
  for (const analysis::NominalFrequency& rate : rates) {
    weights += weight_of(rate);
    sum += weight_of(rate) * rate.real_rate_hz;
  }
  const double mean_hz = sum / weights;
  double chi_square = 0.0;
  for (const analysis::NominalFrequency& rate : rates) {
    chi_square += weight_of(rate) * std::pow(rate.real_rate_hz - mean_hz, 2);
  }
  const double freedom = static_cast<double>(rates.size()) - 1.0;
  const double birge = rates.size() > 1 ? std::sqrt(chi_square / freedom) : 1.0;
  analysis::UncertaintyPart of_steps{std::max(1.0, birge) / std::sqrt(weights) / mean_hz};
  if (birge * birge > analysis::chi_squared_limit(std::max(1.0, freedom), once_in_twenty)) {
    of_steps.degrees_of_freedom = freedom; // it is known by their scatter alone
  }
  const std::array parts{of_steps, analysis::UncertaintyPart{u_acs_rate_rel}};
  const analysis::CombinedUncertainty of_rate = analysis::combine(parts);
  ClockReport report;
  report.source = sensor;
  report.clock.nominal_rate_hz = rates.front().real_rate_hz / rates.front().lambda;
  report.clock.mean_rate_hz = mean_hz;
  report.clock.mean_interval_s = 1.0 / mean_hz;
  report.clock.u_mean_interval_s = of_rate.u / mean_hz;
  report.clock.degrees_of_freedom_mean_interval = of_rate.degrees_of_freedom;
  report.clock.k_mean_interval = of_rate.k;
  return report;
}

} // namespace dyncal::inline evaluation
