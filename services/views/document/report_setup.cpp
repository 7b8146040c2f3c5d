#include "services/views/document/report_sections.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "services/base/rounding.hpp"
#include "services/contract/unit.hpp"
#include "services/evaluation/result/members.hpp"
#include "services/views/document/html.hpp"
#include "services/views/document/toml_comments.hpp"
#include "services/views/lab_file/documented_conditions.hpp"
#include "services/views/language/closure_text.hpp"
#include "services/views/language/journal_sentences.hpp"
#include "services/views/language/reason_text.hpp"
#include "services/views/language/report_sentences.hpp"
#include "services/views/language/setup_sentences.hpp"
#include "services/views/language/translated_texts.hpp"
#include "services/views/report/run_equipment.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

std::string with_uncertainty(const MeasuredCondition& condition, const std::string& unit,
                             Language language) {
  const RoundedValue rounded = round_by_uncertainty(condition.value, condition.expanded);
  return sentences::with_expanded(language, decimal(language, rounded.value), unit,
                                  decimal(language, rounded.u), unit);
}

void add_stated_conditions(const Conditions& conditions, Language language,
                           DefinitionTable& table) {
  if (conditions.temperature_degc) {
    table.add(sentences::ambient_temperature,
              with_uncertainty(*conditions.temperature_degc, "°C", language));
  }
  if (conditions.humidity_percent) {
    table.add(sentences::relative_humidity,
              with_uncertainty(*conditions.humidity_percent, "%", language));
  }
  if (conditions.pressure_hpa) {
    table.add(sentences::air_pressure, with_uncertainty(*conditions.pressure_hpa, "hPa", language));
  }
  table.add(sentences::mounting, conditions.mounting);
  table.add(sentences::orientation, conditions.orientation);
}

// The largest deviation of the measured from the planned level, over all results.
std::string level_deviation(const std::vector<StoredPoint>& points, Language language) {
  double largest = NAN;
  for (const StoredPoint& point : points) {
    if (std::isfinite(point.measured_level_m_s2) && point.level_m_s2 > 0.0) {
      const double deviation = std::abs(point.measured_level_m_s2 / point.level_m_s2 - 1.0);
      largest = std::isfinite(largest) ? std::max(largest, deviation) : deviation;
    }
  }
  return std::isfinite(largest) ? decimal(language, fmt::format("{:.2g} %", 100.0 * largest)) : "";
}

std::string pauses_of(const ReportContents& contents) {
  const Language language = contents.language;
  HtmlTable table("legend", head_of(language, {sentences::pause_from, sentences::pause_to,
                                               sentences::pause_reason}));
  for (const RunPause& pause : contents.result.pauses) {
    table.row({instant_text(language, utc_text(pause.began_utc_ns)),
               instant_text(language, utc_text(pause.ended_utc_ns)),
               reason_text(language, pause.reason)});
  }
  return table.empty() ? "" : table.finish();
}

// Every step once: all channels of a source share its samples.
std::map<std::string, SourceSamples> losses_of(const StoredResult& result,
                                               const std::string& channel) {
  std::map<std::string, SourceSamples> losses;
  for (const StoredPoint& point : result.points_of(channel)) {
    for (const SourceSamples& source : point.samples) {
      SourceSamples& sum = losses[source.source];
      sum.used += source.used;
      sum.lost += source.lost;
      sum.unusable += source.unusable;
      sum.overflowed += source.overflowed;
      sum.not_trusted += source.not_trusted;
      sum.not_measured += source.not_measured;
    }
  }
  return losses;
}

// A delay of the recipe, with all its digits.
std::string delay_text(double delay_s, Language language) {
  return decimal(language, fmt::format("{:g}", 1e6 * delay_s));
}

std::string corrections_of(const ReportContents& contents) {
  if (!contents.result.corrections) {
    return "";
  }
  const Language language = contents.language;
  const StoredCorrections& corrections = *contents.result.corrections;
  DefinitionTable table(language);
  table.add(sentences::reference_delay,
            corrections.reference_delay_s != 0.0
                ? delay_text(corrections.reference_delay_s, language) + " µs"
                : sentences::none(language));
  if (corrections.adc_calibration) {
    const std::size_t points = corrections.adc_calibration->size();
    table.add(sentences::sync_adc, points == 0 ? sentences::not_corrected(language)
                                               : sentences::calibrated_at(language, points));
  }
  if (corrections.dso_delay_s) {
    table.add(sentences::trigger_delay,
              sentences::delay_with_u(language, delay_text(*corrections.dso_delay_s, language),
                                      delay_text(corrections.u_dso_delay_s, language)));
  }
  return element("h3", sentences::corrections, language) + table.finish();
}

std::string correction_name(const std::string& name, Language language) {
  const std::pair<std::string_view, Sentence> known[] = {
      {"reference_response", sentences::reference_response},
      {"reference_delay", sentences::reference_delay},
      {"adc_phase_lag", sentences::adc_phase_lag},
      {"dso_delay", sentences::trigger_delay}};
  for (const auto& [identifier, sentence] : known) {
    if (name == identifier) {
      return sentence(language);
    }
  }
  constexpr std::string_view of_channel = "channel_response ";
  return name.starts_with(of_channel)
             ? sentences::channel_response(language, name.substr(of_channel.size()))
             : name;
}

// Each correction of the steps by name, with the range of what it does to the phase: of angles, so
// that 179.9 and -179.9 degrees are 0.2 degrees apart.
std::string applied_corrections(const ReportContents& contents) {
  constexpr double turn = 360.0;
  struct Range {
    double low = INFINITY;
    double high = -INFINITY;
    double u = 0.0;
  };
  std::map<std::string, Range> ranges;
  for (const StoredStep& step : contents.result.steps) {
    for (const StoredCorrection& correction : step.corrections) {
      Range& range = ranges[correction.name];
      const double stated = degrees_of(correction.phase_rad);
      const double degrees =
          range.high < range.low ? stated : stated + turn * std::round((range.low - stated) / turn);
      range.low = std::min(range.low, degrees);
      range.high = std::max(range.high, degrees);
      range.u = std::max(range.u, correction.u_phase_rad);
    }
  }
  const Language language = contents.language;
  const auto number = [&](double value) { return decimal(language, fmt::format("{:.4g}", value)); };
  HtmlTable table("legend", head_of(language, {sentences::applied, sentences::to_the_phase,
                                               sentences::largest_u}));
  for (const auto& [name, range] : ranges) {
    table.row({correction_name(name, language),
               sentences::from_to(language, number(range.low), number(range.high)),
               decimal(language, rounded_uncertainty(range.u * 180.0 / M_PI))});
  }
  return table.empty() ? "" : table.finish();
}

} // namespace

std::string conditions_section(const ReportContents& contents) {
  const Language language = contents.language;
  DefinitionTable table(language);
  Conditions typed = contents.laboratory ? contents.laboratory->conditions : Conditions{};
  if (contents.sensor && !contents.sensor->conditions.empty()) {
    typed = contents.sensor->conditions;
  }
  const DocumentedConditions documented = documented_conditions(contents.result, typed);
  add_stated_conditions(documented.conditions, language, table);
  std::string origins;
  for (const TranslatedText& origin : documented.origins) {
    origins += (origins.empty() ? "" : " ") + origin.in(language);
  }
  table.add(sentences::origin_of_these, origins);
  const std::vector<StoredPoint> points = contents.result.points_of(contents.channels);
  const std::string temperature = temperature_range(points, language);
  table.add(sentences::own_temperature, temperature.empty() ? "" : temperature + " °C");
  const std::string level = level_range(points, language);
  table.add(sentences::excited_axis, points.empty() ? "" : points.front().excited_axis);
  table.add(sentences::measured_excitation, level.empty() ? "" : level + " m/s²");
  table.add(sentences::level_deviation, level_deviation(points, language));
  return element("h2", sentences::conditions, language) + table.finish() + pauses_of(contents);
}

std::string losses_section(const ReportContents& contents) {
  const Language language = contents.language;
  HtmlTable table("legend", head_of(language, {sentences::source, sentences::samples_used,
                                               sentences::did_not_come, sentences::came_unusable,
                                               sentences::dropped, sentences::not_trusted,
                                               sentences::not_measured}));
  for (const auto& [source, sum] : losses_of(contents.result, contents.channels.front())) {
    table.row({source, std::to_string(sum.used), std::to_string(sum.lost),
               std::to_string(sum.unusable), std::to_string(sum.overflowed),
               std::to_string(sum.not_trusted), std::to_string(sum.not_measured)});
  }
  return element("h2", sentences::losses, language) + table.finish();
}

std::string closures_section(const ReportContents& contents) {
  const Language language = contents.language;
  std::string html;
  for (const std::string& channel : contents.channels) {
    std::vector<std::string> head{sentences::must_hold(language), "", sentences::value(language),
                                  sentences::limit(language)};
    if (language == Language::english) { // the language of what evaluation says
      head.push_back(sentences::found(language));
    }
    HtmlTable table("legend", head);
    for (const Closure& closure : contents.result.closures_of(channel)) {
      const bool is_possible = closure.verdict != Verdict::not_possible;
      const auto number = [&](double value) {
        return is_possible ? decimal(language, fmt::format("{:.3g}", value)) +
                                 (closure.unit == "1" ? "" : " " + closure.unit)
                           : std::string();
      };
      std::vector<std::string> cells{std::string(closure_title(closure.kind, language)),
                                     std::string(verdict_text(closure.verdict, language)),
                                     number(closure.value), number(closure.limit)};
      if (language == Language::english) {
        cells.push_back(closure.sentence);
      }
      table.row(cells);
    }
    if (!table.empty()) {
      html += element("h2", sentences::closures_of(language, channel)) + table.finish();
    }
  }
  return html;
}

std::string equipment_section(const ReportContents& contents) {
  const Language language = contents.language;
  HtmlTable table("legend",
                  head_of(language, {sentences::equipment_name, sentences::equipment_serial,
                                     sentences::equipment_certificate, sentences::equipment_issuer,
                                     sentences::equipment_days}));
  const auto add = [&](const CalibratedDevice& device) {
    std::string name = device.name;
    for (const std::string& text : {device.manufacturer, device.model}) {
      name += text.empty() ? "" : ", " + text;
    }
    const std::string until =
        device.valid_until.empty() ? "" : ", " + day_text(language, device.valid_until);
    table.row({name, device.serial, device.certificate, device.issued_by,
               day_text(language, device.issued) + until});
  };
  if (const ReferenceStandard* reference = reference_of(contents)) {
    std::ranges::for_each(reference->devices, add);
  }
  if (contents.laboratory) {
    std::ranges::for_each(contents.laboratory->equipment, add);
  }
  std::ranges::for_each(run_equipment(contents.result, contents.channels.front(), language), add);
  return table.empty() ? "" : element("h2", sentences::equipment, language) + table.finish();
}

std::string devices_section(const ReportContents& contents) {
  const Language language = contents.language;
  HtmlTable table("legend", head_of(language, {sentences::source, sentences::device,
                                               sentences::equipment_serial,
                                               sentences::device_firmware, sentences::nominal_rate,
                                               sentences::time_base, sentences::software_column}));
  for (const RunSource& source : contents.result.sources) {
    const drivers::SourceDescription& description = source.description;
    table.row(
        {source.source, description.device, description.serial, description.firmware,
         description.nominal_rate_hz > 0.0
             ? decimal(language, fmt::format("{:g}", description.nominal_rate_hz))
             : "",
         description.time_base == drivers::TimeBase::utc ? "UTC" : sentences::local_time(language),
         source.software});
  }
  return element("h2", sentences::devices, language) + table.finish() + corrections_of(contents) +
         applied_corrections(contents);
}

std::string software_section(const ReportContents& contents) {
  const Language language = contents.language;
  const StoredResult& result = contents.result;
  DefinitionTable table(language);
  table.add(sentences::run_conducted_by, result.conducted_by ? text_of(*result.conducted_by) : "");
  table.add(sentences::conducted_with, result.software);
  table.add(sentences::evaluated_by, result.analysis_software);
  table.add(sentences::on_host, result.analysis_host);
  table.add(sentences::dds_of_analysis, result.analysis_dds);
  table.add(sentences::made_by, contents.software);
  table.add(sentences::held_against,
            fmt::format("{}", fmt::join(texts_in(language, contents.provenance), " ")));
  const auto add_hash = [&](const Sentence& name, const std::string& hash) {
    table.add_html(name.in(language), fmt::format("<code>{}</code>", escaped(hash)));
  };
  table.add(sentences::result_file, result.file.filename().string());
  add_hash(sentences::its_hash, result.sha256);
  add_hash(sentences::recipe_hash, result.recipe_sha256);
  return element("h2", sentences::software, language) + table.finish();
}

std::string journal_section(const ReportContents& contents) {
  const Language language = contents.language;
  HtmlTable table("legend", {sentences::instant_column(language), sentences::kind_column(language),
                             sentences::by_column(language), sentences::text_column(language)});
  for (const JournalEntry& entry : contents.result.journal) {
    std::string text = entry.text;
    if (entry.kind == JournalKind::amendment) {
      text = fmt::format("{}", fmt::join(amendment_sentences(entry, language), "; "));
    } else if (entry.kind == JournalKind::event) {
      text = sentences::said_by_program(language, entry.text);
    }
    const Sentence& kind =
        per_enumerator(entry.kind, {sentences::note, sentences::event, sentences::amendment});
    table.row({entry.utc, kind(language), name_of(entry.by), text});
  }
  return table.empty() ? "" : element("h2", sentences::journal, language) + table.finish();
}

std::string recipe_section(const ReportContents& contents) {
  const std::string recipe = without_comments(contents.result.recipe);
  return recipe.empty() ? ""
                        : element("h2", sentences::recipe, contents.language) + "<pre>" +
                              escaped(recipe) + "</pre>\n";
}

} // namespace dyncal::inline views
