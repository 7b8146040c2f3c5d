#include "services/evaluation/method/series_clock.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::inline evaluation {

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
  const double birge =
      rates.size() > 1 ? std::sqrt(chi_square / static_cast<double>(rates.size() - 1)) : 1.0;
  const double u_rel =
      std::hypot(std::max(1.0, birge) / std::sqrt(weights) / mean_hz, u_acs_rate_rel);
  ClockReport report;
  report.source = sensor;
  report.clock.nominal_rate_hz = rates.front().real_rate_hz / rates.front().lambda;
  report.clock.mean_rate_hz = mean_hz;
  report.clock.mean_interval_s = 1.0 / mean_hz;
  report.clock.u_mean_interval_s = u_rel / mean_hz;
  return report;
}

} // namespace dyncal::inline evaluation
