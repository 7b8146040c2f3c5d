#include "services/views/conformity/stated_conformity.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/per_enumerator.hpp"
#include "services/base/rounding.hpp"
#include "services/views/language/conformity_sentences.hpp"

namespace dyncal::inline views {

using analysis::ConformityStatement;
using analysis::DecisionRule;

namespace {

std::string number_text(double value, Language language) {
  return decimal(language, fmt::format("{}", value));
}

} // namespace

StatedDeviation stated_deviation(const JudgedValue& value) {
  if (!std::isfinite(value.deviation)) {
    return {};
  }
  const RoundedValue rounded = round_by_uncertainty(value.deviation, value.expanded);
  return {rounded.value, rounded.u};
}

std::string_view name_of(ConformityStatement statement, Language language) {
  static constexpr Sentence names[] = {sentences::pass, sentences::conditional_pass,
                                       sentences::conditional_fail, sentences::undecided,
                                       sentences::fail};
  return per_enumerator(statement, names).in(language);
}

std::string probability_text(const JudgedValue& value, Language language) {
  constexpr double end = 0.0005;
  if (!std::isfinite(value.probability)) {
    return "";
  }
  if (value.probability > 1.0 - end) {
    return decimal(language, "> 99.9 %");
  }
  return decimal(language, value.probability < end
                               ? "< 0.1 %"
                               : fmt::format("{:.1f} %", 100.0 * value.probability));
}

std::string range_text(const ToleranceRow& row, Language language) {
  const auto of_range = [&](double from, double to, const char* unit) {
    const std::string lowest = number_text(from, language);
    return from == to
               ? sentences::single(language, lowest, unit)
               : sentences::from_to_in(language, lowest, unit, number_text(to, language), unit);
  };
  std::string text = fmt::format(
      "{}, {}", (row.is_of_phase() ? sentences::of_phase : sentences::of_magnitude).in(language),
      of_range(row.from_hz, row.to_hz, "Hz"));
  if (row.from_level_m_s2 && row.to_level_m_s2) {
    text += ", " + of_range(*row.from_level_m_s2, *row.to_level_m_s2, "m/s^2");
  } else if (row.from_level_m_s2) {
    text += sentences::from_level(language, number_text(*row.from_level_m_s2, language));
  } else if (row.to_level_m_s2) {
    text += sentences::up_to_level(language, number_text(*row.to_level_m_s2, language));
  }
  return text;
}

std::string limits_text(const ToleranceRow& row, Language language) {
  const std::string unit = symbol_of(row.unit);
  return sentences::from_to_in(language, number_text(row.lower, language), unit,
                               number_text(row.upper, language), unit);
}

std::string nominal_text(const ToleranceRow& row, Language language) {
  const std::string delay =
      row.nominal_delay_s == 0.0
          ? ""
          : fmt::format(" - 360 deg f x {} s", number_text(row.nominal_delay_s, language));
  if (row.relative_to_hz) {
    return sentences::from_value_at(language, number_text(*row.relative_to_hz, language), delay);
  }
  return row.is_of_phase()
             ? sentences::from_degrees(language, number_text(row.nominal_deg, language), delay)
             : sentences::from_nominal(language, number_text(row.nominal, language));
}

std::string row_text(const ToleranceRow& row, Language language) {
  return fmt::format("{}: {} {}", range_text(row, language), limits_text(row, language),
                     nominal_text(row, language));
}

std::string rule_text(const Tolerances& tolerances, Language language) {
  const std::string factor = number_text(tolerances.guard_factor, language);
  const std::string risk =
      tolerances.guard_factor == 1.0 ? sentences::false_pass_risk(language) : std::string();
  switch (tolerances.rule) {
  case DecisionRule::simple_acceptance:
    return sentences::simple_acceptance(language);
  case DecisionRule::guard_band:
    return sentences::guard_band(language, factor, risk);
  case DecisionRule::guard_band_non_binary:
    return sentences::guard_band_non_binary(language, factor, risk);
  }
  return "";
}

std::string verdict_text(const ConformityReport& report, Language language) {
  std::vector<std::string> counts;
  constexpr auto number = number_of_enumerators<ConformityStatement>();
  for (std::size_t place = 0; place < number; ++place) {
    const auto statement = static_cast<ConformityStatement>(place);
    const auto count = std::ranges::count(report.values, statement, &JudgedValue::statement);
    if (count > 0) {
      counts.push_back(fmt::format("{} {}", count, name_of(statement, language)));
    }
  }
  return fmt::format("{}: {} ({})", report.tolerances.specification,
                     name_of(report.statement(), language),
                     counts.empty() ? sentences::no_value_in_range(language)
                                    : fmt::format("{}", fmt::join(counts, ", ")));
}

std::string digits_text(Language language) {
  return sentences::digits(language);
}

} // namespace dyncal::inline views
