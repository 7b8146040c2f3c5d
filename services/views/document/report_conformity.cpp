#include <fmt/format.h>

#include "services/views/conformity/stated_conformity.hpp"
#include "services/views/document/html.hpp"
#include "services/views/document/report_sections.hpp"
#include "services/views/language/conformity_sentences.hpp"
#include "services/views/language/report_sentences.hpp"

namespace dyncal::inline views {
namespace {

// The values of one channel and limit that begin there.
std::string limit_table(const ConformityReport& report, Language language, std::size_t& place) {
  const JudgedValue& first = report.values[place];
  const ToleranceRow& row = report.tolerances.rows[first.row];
  const std::string unit = escaped(symbol_of(row.unit));
  std::string html = element("h3", sentences::limit_of(language, first.channel, first.row + 1)) +
                     element("p", row_text(row, language));
  HtmlTable table("values",
                  {"<i>f</i> / Hz", "<i>a</i> / (m/s²)",
                   fmt::format("{} / {}", sentences::deviation_column.in(language), unit),
                   "<i>U</i> / " + unit, "<i>P</i>", sentences::statement_column(language)});
  std::string reasons;
  for (; place < report.values.size(); ++place) {
    const JudgedValue& value = report.values[place];
    if (value.channel != first.channel || value.row != first.row) {
      break;
    }
    const StatedDeviation stated = stated_deviation(value);
    std::vector<std::string> cells =
        decimal(language, {value.frequency_text_hz, fmt::format("{:g}", value.level_m_s2),
                           stated.value, stated.expanded});
    cells.push_back(probability_text(value, language));
    cells.emplace_back(name_of(value.statement, language));
    if (!value.reason.empty()) {
      reasons += element(
          "p", sentences::place_of_value(language, cells[0], cells[1], value.reason.in(language)));
    }
    table.row(cells);
  }
  return html + table.finish() + reasons;
}

} // namespace

std::string conformity_section(const ReportContents& contents) {
  if (!contents.conformity) {
    return "";
  }
  const Language language = contents.language;
  const ConformityReport& conformity = *contents.conformity;
  std::string html = "<section class=\"conformity\">\n" +
                     element("h2", sentences::conformity, language) +
                     element("p", verdict_text(conformity, language));
  for (const TranslatedText& note : conformity.notes) {
    html += element("p", note.in(language));
  }
  html += element("p", rule_text(conformity.tolerances, language) + " " + digits_text(language));
  for (std::size_t place = 0; place < conformity.values.size();) {
    html += limit_table(conformity, language, place);
  }
  return html + "</section>\n";
}

} // namespace dyncal::inline views
