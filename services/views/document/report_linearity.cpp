#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "services/base/rounding.hpp"
#include "services/views/document/html.hpp"
#include "services/views/document/report_sections.hpp"
#include "services/views/language/conformity_sentences.hpp"
#include "services/views/language/linearity_sentences.hpp"

namespace dyncal::inline views {
namespace {

constexpr double percent = 100.0;
constexpr double degrees = 180.0 / std::numbers::pi;

std::vector<std::string> cells_of(const LinearityPoint& point, bool is_reference,
                                  Language language) {
  const std::string measured = std::isfinite(point.measured_level_m_s2)
                                   ? fmt::format("{:.4g}", point.measured_level_m_s2)
                                   : "";
  RoundedValue magnitude;
  RoundedValue phase;
  if (!is_reference) {
    magnitude = round_by_uncertainty(percent * point.deviation_rel, percent * point.expanded_rel);
    phase = round_by_uncertainty(degrees * point.phase_deviation_rad,
                                 degrees * point.expanded_phase_rad);
  }
  std::vector<std::string> cells =
      decimal(language, {fmt::format("{:g}", point.level_m_s2), measured, magnitude.value,
                         magnitude.u, phase.value, phase.u});
  cells.push_back(is_reference ? sentences::reference_level_column(language) : point.doubting_flag);
  return cells;
}

std::string line_table(const LinearityLine& line, Language language) {
  const std::string deviation = sentences::deviation_column(language);
  HtmlTable table("values", {"<i>a</i> / (m/s²)", sentences::measured_level_column(language),
                             deviation + " |<i>H</i>| / %", "<i>U</i> / %", deviation + " φ / °",
                             "<i>U</i> / °", sentences::flag_column(language)});
  for (const LinearityPoint& point : line.points) {
    table.row(cells_of(point, point.level_m_s2 == line.reference_level_m_s2, language));
  }
  const LinearityPoint& largest = line.largest();
  const RoundedValue stated =
      round_by_uncertainty(percent * largest.deviation_rel, percent * largest.expanded_rel);
  std::string html =
      element("h3", sentences::linearity_of(language, line.channel,
                                            decimal(language, line.frequency_text_hz))) +
      table.finish();
  if (largest.expanded_rel > 0.0) {
    html += element("p", sentences::largest_deviation(
                             language, decimal(language, stated.value), decimal(language, stated.u),
                             decimal(language, fmt::format("{:.2f}", largest.k)),
                             decimal(language, fmt::format("{:g}", largest.level_m_s2))));
  }
  return html;
}

} // namespace

std::string linearity_section(const ReportContents& contents) {
  if (!contents.linearity) {
    return "";
  }
  const Language language = contents.language;
  std::string html = "<section class=\"linearity\">\n" +
                     element("h2", sentences::amplitude_linearity, language) +
                     element("p", sentences::linearity_explained, language);
  for (const LinearityLine& line : contents.linearity->lines) {
    html += line_table(line, language);
  }
  for (const TranslatedText& note : contents.linearity->notes) {
    html += element("p", note.in(language));
  }
  return html + "</section>\n";
}

} // namespace dyncal::inline views
