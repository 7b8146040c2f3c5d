#include "services/views/document/report_sections.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/core.h>

#include "services/views/document/html.hpp"
#include "services/views/language/setup_sentences.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

std::string microseconds(double seconds, int decimals, Language language) {
  return std::isfinite(seconds)
             ? decimal(language, fmt::format("{:.{}f} µs", 1e6 * seconds, decimals))
             : "";
}

std::string clock_facts(const analysis::SampleClockStatistics& clock, Language language) {
  const double u_interval_s = clock.u_mean_interval_s;
  const bool has_u = std::isfinite(u_interval_s) && u_interval_s > 0.0;
  DefinitionTable table(language);
  table.add(sentences::mean_rate,
            has_u && clock.mean_interval_s > 0.0
                ? stated_text(clock.mean_rate_hz, clock.of_mean_rate(), "Hz", language)
                : sentences::rate_without_uncertainty(
                      language, decimal(language, fmt::format("{:.6g}", clock.mean_rate_hz))));
  if (clock.nominal_rate_hz > 0.0 && has_u) {
    analysis::CombinedUncertainty of_deviation_ppm = clock.of_rate_deviation();
    of_deviation_ppm.u *= 1e6;
    table.add(sentences::rate_deviation,
              stated_text(1e6 * clock.rate_deviation_rel(), of_deviation_ppm, "ppm", language));
  }
  table.add(sentences::intervals, std::to_string(clock.intervals));
  table.add(sentences::median, fmt::format("{}; {}; {}", microseconds(clock.median_s, 3, language),
                                           microseconds(clock.minimum_s, 3, language),
                                           microseconds(clock.maximum_s, 3, language)));
  table.add(sentences::standard_deviation, microseconds(clock.sd_s, 4, language));
  table.add(sentences::tick, microseconds(clock.tick_s, 5, language));
  table.add(sentences::events, std::to_string(clock.event_count));
  table.add(sentences::lost_in_run, std::to_string(clock.lost));
  return table.finish();
}

// Those whose file names begin so.
std::vector<EmbeddedPicture> pictures_of(const ReportContents& contents, std::string_view begin) {
  std::vector<EmbeddedPicture> found;
  std::ranges::copy_if(
      contents.pictures, std::back_inserter(found),
      [&](const EmbeddedPicture& picture) { return picture.file_name.starts_with(begin); });
  return found;
}

std::string picture_elements(const std::vector<EmbeddedPicture>& pictures) {
  std::string html;
  for (const EmbeddedPicture& picture : pictures) {
    html += fmt::format("<figure><img src=\"{}\" alt=\"{}\"></figure>\n",
                        escaped(picture.data_uri()), escaped(picture.file_name));
  }
  return html;
}

} // namespace

std::string interferometer_section(const ReportContents& contents) {
  const std::vector<EmbeddedPicture> pictures = pictures_of(contents, "ellipse-");
  if (contents.language != Language::english || pictures.empty()) {
    return "";
  }
  return element("h2", "Interferometer") + picture_elements(pictures);
}

std::string clock_section(const ReportContents& contents) {
  const Language language = contents.language;
  std::string html;
  for (const ClockReport& report : contents.result.clocks) {
    html += element("h2", sentences::clock_of(language, report.source)) +
            clock_facts(report.clock, language);
  }
  const std::vector<EmbeddedPicture> pictures = pictures_of(contents, "interval-");
  if (language != Language::english && !pictures.empty()) {
    return html + element("p", sentences::clock_figures, language); // they are drawn in English
  }
  html += picture_elements(pictures);
  for (const std::string& reason : contents.left_out) {
    const std::string why = language == Language::english ? ": " + reason : "";
    html += element("p", sentences::figure_left_out(language, why), "warning");
  }
  return html;
}

} // namespace dyncal::inline views
