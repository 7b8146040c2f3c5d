#include "services/views/conformity/stated_conformity.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/per_enumerator.hpp"
#include "services/base/rounding.hpp"

namespace dyncal::inline views {

using analysis::ConformityStatement;
using analysis::DecisionRule;

StatedDeviation stated_deviation(const JudgedValue& value) {
  if (!std::isfinite(value.deviation)) {
    return {};
  }
  const RoundedValue rounded = round_by_uncertainty(value.deviation, value.expanded);
  return {rounded.value, rounded.u};
}

std::string probability_text(const JudgedValue& value) {
  constexpr double end = 0.0005;
  if (!std::isfinite(value.probability)) {
    return "";
  }
  if (value.probability > 1.0 - end) {
    return "> 99.9 %";
  }
  return value.probability < end ? "< 0.1 %" : fmt::format("{:.1f} %", 100.0 * value.probability);
}

std::string range_text(const ToleranceRow& row) {
  const auto of_range = [](double from, double to, const char* unit) {
    return from == to ? fmt::format("{} {}", from, unit)
                      : fmt::format("{} {} to {} {}", from, unit, to, unit);
  };
  std::string text = fmt::format("{}, {}", row.is_of_phase() ? "phase" : "magnitude",
                                 of_range(row.from_hz, row.to_hz, "Hz"));
  if (row.from_level_m_s2 && row.to_level_m_s2) {
    text += ", " + of_range(*row.from_level_m_s2, *row.to_level_m_s2, "m/s^2");
  } else if (row.from_level_m_s2) {
    text += fmt::format(", from {} m/s^2", *row.from_level_m_s2);
  } else if (row.to_level_m_s2) {
    text += fmt::format(", up to {} m/s^2", *row.to_level_m_s2);
  }
  return text;
}

std::string limits_text(const ToleranceRow& row) {
  const std::string unit = symbol_of(row.unit);
  return fmt::format("{} {} to {} {}", row.lower, unit, row.upper, unit);
}

std::string nominal_text(const ToleranceRow& row) {
  const std::string delay =
      row.nominal_delay_s == 0.0 ? "" : fmt::format(" - 360 deg f x {} s", row.nominal_delay_s);
  if (row.relative_to_hz) {
    return fmt::format("from the value at {} Hz{}", *row.relative_to_hz, delay);
  }
  return row.is_of_phase() ? fmt::format("from {} deg{}", row.nominal_deg, delay)
                           : fmt::format("from {}", row.nominal);
}

std::string row_text(const ToleranceRow& row) {
  return fmt::format("{}: {} {}", range_text(row), limits_text(row), nominal_text(row));
}

std::string rule_text(const Tolerances& tolerances) {
  const std::string w = fmt::format("w = {} U", tolerances.guard_factor);
  const std::string risk =
      tolerances.guard_factor == 1.0 ? " The risk that a pass is false is at most 2.3 %." : "";
  switch (tolerances.rule) {
  case DecisionRule::simple_acceptance:
    return "Simple acceptance (ILAC-G8:09/2019): pass within the tolerance limits, else fail; the "
           "risk that a pass is false is up to 50 % for a value at a limit.";
  case DecisionRule::guard_band:
    return fmt::format("Guard band (ILAC-G8:09/2019): pass within the tolerance limits less {}, "
                       "else fail.{}",
                       w, risk);
  case DecisionRule::guard_band_non_binary:
    return fmt::format("Guard band, non-binary (ILAC-G8:09/2019): pass within the tolerance limits "
                       "less {}; conditional pass within the limits; conditional fail less than w "
                       "beyond them; else fail.{}",
                       w, risk);
  }
  return "";
}

std::string verdict_text(const ConformityReport& report) {
  std::vector<std::string> counts;
  constexpr auto number = number_of_enumerators<ConformityStatement>();
  for (std::size_t place = 0; place < number; ++place) {
    const auto statement = static_cast<ConformityStatement>(place);
    const auto count = std::ranges::count(report.values, statement, &JudgedValue::statement);
    if (count > 0) {
      counts.push_back(fmt::format("{} {}", count, analysis::to_string(statement)));
    }
  }
  return fmt::format("{}: {} ({})", report.tolerances.specification,
                     analysis::to_string(report.statement()),
                     counts.empty() ? "no value is within its limits' range"
                                    : fmt::format("{}", fmt::join(counts, ", ")));
}

std::string digits_text() {
  return "Decided with all digits of value and U, before they were rounded; a value at a limit is "
         "within it. The probability is that of the true value to be within the tolerance limits, "
         "for a normal distribution (Student's t of few repetitions) with this U.";
}

} // namespace dyncal::inline views
