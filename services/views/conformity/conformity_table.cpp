#include "services/views/conformity/conformity_table.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "services/base/printable_text.hpp"
#include "services/evaluation/result/point_identity.hpp"
#include "services/views/conformity/stated_conformity.hpp"

namespace dyncal::inline views {
namespace {

std::string value_line(const JudgedValue& value, const std::string& level) {
  const StatedDeviation stated = stated_deviation(value);
  return fmt::format("  {:>10}{} {:>12} {:>10} {:>9}  {}{}\n", one_line(value.frequency_text_hz),
                     level, stated.value, stated.expanded, probability_text(value),
                     analysis::to_string(value.statement),
                     value.reason.empty() ? "" : ": " + one_line(value.reason.english));
}

// The values of one channel and row that begin there.
std::string row_section(const ConformityReport& report, std::size_t& place, bool with_level) {
  const JudgedValue& first = report.values[place];
  const ToleranceRow& row = report.tolerances.rows[first.row];
  const std::string unit = symbol_of(row.unit);
  std::string text = fmt::format("\n{}, limit {}: {}\n", one_line(first.channel), first.row + 1,
                                 one_line(row_text(row)));
  text += fmt::format("  {:>10}{} {:>12} {:>10} {:>9}\n", "f / Hz",
                      with_level ? fmt::format(" {:>15}", "level / (m/s^2)") : "", "dev. / " + unit,
                      "U / " + unit, "P");
  for (; place < report.values.size(); ++place) {
    const JudgedValue& value = report.values[place];
    if (value.channel != first.channel || value.row != first.row) {
      break;
    }
    text += value_line(value, with_level ? fmt::format(" {:>15}", value.level_m_s2) : "");
  }
  return text;
}

} // namespace

std::string conformity_table(const ConformityReport& report) {
  std::string text = rule_text(report.tolerances) + "\n";
  const bool with_level = !report.values.empty() && have_several_levels(report.values);
  for (std::size_t place = 0; place < report.values.size();) {
    text += row_section(report, place, with_level);
  }
  text += "\n";
  for (const TranslatedText& note : report.notes) {
    text += one_line(note.english) + "\n";
  }
  return text + one_line(verdict_text(report)) + "\n";
}

} // namespace dyncal::inline views
