// What people read of decisions, in the same words everywhere: digits, ranges, rule, verdict. Any
// thread.
#pragma once

#include <string>
#include <string_view>

#include "services/views/conformity/conformity.hpp"

namespace dyncal::inline views {

struct StatedDeviation { // U with two digits, the value to the same place; empty: not known
  std::string value;
  std::string expanded;
};
[[nodiscard]] StatedDeviation stated_deviation(const JudgedValue& value);

// "pass"
[[nodiscard]] std::string_view name_of(analysis::ConformityStatement statement, Language language);

// "98.7 %", "> 99.9 %"; empty: not known
[[nodiscard]] std::string probability_text(const JudgedValue& value,
                                           Language language = Language::english);

// "magnitude, 10 Hz to 63 Hz, 2 m/s^2 to 15 m/s^2"
[[nodiscard]] std::string range_text(const ToleranceRow& row,
                                     Language language = Language::english);

// "-5 % to 3 %"
[[nodiscard]] std::string limits_text(const ToleranceRow& row,
                                      Language language = Language::english);

// "of 1", "of the value at 80 Hz", "of 0 deg - 360 deg f x 0.0081 s"
[[nodiscard]] std::string nominal_text(const ToleranceRow& row,
                                       Language language = Language::english);

// "magnitude, 10 Hz to 63 Hz: -5 % to 5 % of 1"
[[nodiscard]] std::string row_text(const ToleranceRow& row, Language language = Language::english);

// The decision rule as a sentence for documents.
[[nodiscard]] std::string rule_text(const Tolerances& tolerances,
                                    Language language = Language::english);

// "Data sheet 4711: pass: 24 pass."
[[nodiscard]] std::string verdict_text(const ConformityReport& report,
                                       Language language = Language::english);

// What else a reader must know of how it was decided.
[[nodiscard]] std::string digits_text(Language language = Language::english);

} // namespace dyncal::inline views
