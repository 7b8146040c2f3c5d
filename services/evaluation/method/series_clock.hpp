// What a run by series time stamping says of the sensor's sample clock: the rates of its steps,
// paper eq. (6), taken together.
//
// Mean weighted by their uncertainties; where they scatter by more than these say, its uncertainty
// is what the scatter says (Birge), with n - 1 degrees of freedom from where chance does so once in
// twenty times on. The clock of the ACS, in which all of them were measured, is common to them. Any
// thread.
#pragma once

#include <span>
#include <string>

#include "analysis/method/nominal_frequency.hpp"
#include "services/evaluation/result/clock_report.hpp"

namespace dyncal::inline evaluation {

// `u_acs_rate_rel`: of the ACS's clock. REQUIRES: at least one rate.
[[nodiscard]] ClockReport series_clock_report(const std::string& sensor, double u_acs_rate_rel,
                                              std::span<const analysis::NominalFrequency> rates);

} // namespace dyncal::inline evaluation
