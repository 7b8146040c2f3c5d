#include <fmt/format.h>

#include "services/views/conformity/stated_conformity.hpp"
#include "services/views/document/html.hpp"
#include "services/views/document/report_sections.hpp"

namespace dyncal::inline views {
namespace {

// The values of one channel and limit that begin there.
std::string limit_table(const ConformityReport& report, std::size_t& place) {
  const JudgedValue& first = report.values[place];
  const ToleranceRow& row = report.tolerances.rows[first.row];
  const std::string unit = escaped(symbol_of(row.unit));
  std::string html = fmt::format("<h3>{}, limit {}</h3>\n", escaped(first.channel), first.row + 1) +
                     element("p", row_text(row));
  HtmlTable table("values", {"<i>f</i> / Hz", "<i>a</i> / (m/s²)", "deviation / " + unit,
                             "<i>U</i> / " + unit, "<i>P</i>", "statement"});
  std::string reasons;
  for (; place < report.values.size(); ++place) {
    const JudgedValue& value = report.values[place];
    if (value.channel != first.channel || value.row != first.row) {
      break;
    }
    const StatedDeviation stated = stated_deviation(value);
    table.row({value.frequency_text_hz, fmt::format("{:g}", value.level_m_s2), stated.value,
               stated.expanded, probability_text(value),
               std::string(analysis::to_string(value.statement))});
    if (!value.reason.empty()) {
      reasons += element("p", fmt::format("{} Hz, {:g} m/s²: {}", value.frequency_text_hz,
                                          value.level_m_s2, value.reason));
    }
  }
  return html + table.finish() + reasons;
}

} // namespace

std::string conformity_section(const std::optional<ConformityReport>& conformity) {
  if (!conformity) {
    return "";
  }
  std::string html = "<section class=\"conformity\">\n<h2>Conformity</h2>\n";
  html += element("p", verdict_text(*conformity));
  for (const std::string& note : conformity->notes) {
    html += element("p", note);
  }
  html += element("p", rule_text(conformity->tolerances) + " " + digits_text());
  for (std::size_t place = 0; place < conformity->values.size();) {
    html += limit_table(*conformity, place);
  }
  return html + "</section>\n";
}

} // namespace dyncal::inline views
