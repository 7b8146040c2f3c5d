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
#include "services/views/report/run_equipment.hpp"
#include "services/views/report/stated_value.hpp"

namespace dyncal::inline views {
namespace {

std::string with_uncertainty(const MeasuredCondition& condition, const std::string& unit) {
  const RoundedValue rounded = round_by_uncertainty(condition.value, condition.expanded);
  return fmt::format("{} {}, U = {} {} (k = 2)", rounded.value, unit, rounded.u, unit);
}

void add_stated_conditions(const Conditions& conditions, DefinitionTable& table) {
  if (conditions.temperature_degc) {
    table.add("Ambient temperature", with_uncertainty(*conditions.temperature_degc, "°C"));
  }
  if (conditions.humidity_percent) {
    table.add("Relative humidity", with_uncertainty(*conditions.humidity_percent, "%"));
  }
  if (conditions.pressure_hpa) {
    table.add("Air pressure", with_uncertainty(*conditions.pressure_hpa, "hPa"));
  }
  table.add("Mounting", conditions.mounting);
  table.add("Orientation", conditions.orientation);
}

// The largest deviation of the measured from the planned level, over all results.
std::string level_deviation(const std::vector<StoredPoint>& points) {
  double largest = NAN;
  for (const StoredPoint& point : points) {
    if (std::isfinite(point.measured_level_m_s2) && point.level_m_s2 > 0.0) {
      const double deviation = std::abs(point.measured_level_m_s2 / point.level_m_s2 - 1.0);
      largest = std::isfinite(largest) ? std::max(largest, deviation) : deviation;
    }
  }
  return std::isfinite(largest) ? fmt::format("{:.2g} %", 100.0 * largest) : "";
}

std::string pauses_of(const StoredResult& result) {
  HtmlTable table("legend", {"pause from", "to", "reason"});
  for (const RunPause& pause : result.pauses) {
    table.row({utc_text(pause.began_utc_ns), utc_text(pause.ended_utc_ns), pause.reason});
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

std::string microseconds(double seconds, int decimals) {
  return std::isfinite(seconds) ? fmt::format("{:.{}f} us", 1e6 * seconds, decimals) : "";
}

std::string clock_facts(const analysis::SampleClockStatistics& clock) {
  const double u_interval_s = clock.u_mean_interval_s;
  DefinitionTable table;
  table.add(
      "Mean sample rate",
      std::isfinite(u_interval_s) && u_interval_s > 0.0 && clock.mean_interval_s > 0.0
          ? stated_text(clock.mean_rate_hz, clock.of_mean_rate(), "Hz")
          : fmt::format("{:.6g} Hz (nothing is known of its uncertainty)", clock.mean_rate_hz));
  if (clock.nominal_rate_hz > 0.0 && std::isfinite(u_interval_s) && u_interval_s > 0.0) {
    analysis::CombinedUncertainty of_deviation_ppm = clock.of_rate_deviation();
    of_deviation_ppm.u *= 1e6;
    table.add("Deviation from the nominal rate",
              stated_text(1e6 * clock.rate_deviation_rel(), of_deviation_ppm, "ppm"));
  }
  table.add("Sample intervals", std::to_string(clock.intervals));
  table.add("Median, smallest, largest",
            fmt::format("{}, {}, {}", microseconds(clock.median_s, 3),
                        microseconds(clock.minimum_s, 3), microseconds(clock.maximum_s, 3)));
  table.add("Standard deviation", microseconds(clock.sd_s, 4));
  table.add("Resolution of the stamps", microseconds(clock.tick_s, 5));
  table.add("Events (steps, gaps, doubled samples)", std::to_string(clock.event_count));
  table.add("Samples lost over the whole run", std::to_string(clock.lost));
  return table.finish();
}

std::string corrections_of(const StoredResult& result) {
  if (!result.corrections) {
    return "";
  }
  const StoredCorrections& corrections = *result.corrections;
  DefinitionTable table;
  table.add("Delay of the reference", corrections.reference_delay_s != 0.0
                                          ? fmt::format("{:g} s", corrections.reference_delay_s)
                                          : std::string("none"));
  if (corrections.adc_calibration) {
    const std::size_t points = corrections.adc_calibration->size();
    table.add("Sync ADC of the acquisition unit",
              points == 0 ? std::string("not corrected")
                          : fmt::format("calibrated at {} frequencies", points));
  }
  if (corrections.dso_delay_s) {
    table.add(
        "Delay of the oscilloscope's trigger",
        fmt::format("{:g} s, u = {:g} s", *corrections.dso_delay_s, corrections.u_dso_delay_s));
  }
  return "<h3>Corrections</h3>\n" + table.finish();
}

// Each correction of the steps by name, with the range of what it does to the phase: of angles, so
// that 179.9 and -179.9 degrees are 0.2 degrees apart.
std::string applied_corrections(const StoredResult& result) {
  constexpr double turn = 360.0;
  struct Range {
    double low = INFINITY;
    double high = -INFINITY;
    double u = 0.0;
  };
  std::map<std::string, Range> ranges;
  for (const StoredStep& step : result.steps) {
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
  HtmlTable table("legend", {"applied", "to the phase / °", "largest <i>u</i> / °"});
  for (const auto& [name, range] : ranges) {
    table.row({name, fmt::format("{:.4g} to {:.4g}", range.low, range.high),
               rounded_uncertainty(range.u * 180.0 / M_PI)});
  }
  return table.empty() ? "" : table.finish();
}

} // namespace

std::string conditions_section(const ReportContents& contents) {
  DefinitionTable table;
  if (contents.sensor && !contents.sensor->conditions.empty()) {
    add_stated_conditions(contents.sensor->conditions, table);
  } else if (contents.laboratory) {
    add_stated_conditions(contents.laboratory->conditions, table);
  }
  const std::vector<StoredPoint> points = contents.result.points_of(contents.channels);
  const std::string temperature = temperature_range(points);
  table.add("Temperature of the sensor, measured by itself",
            temperature.empty() ? "" : temperature + " °C");
  const std::string level = level_range(points);
  table.add("Excited axis", points.empty() ? "" : points.front().excited_axis);
  table.add("Amplitude of the excitation, measured", level.empty() ? "" : level + " m/s²");
  table.add("Largest deviation from the planned amplitude", level_deviation(points));
  return "<h2>Conditions</h2>\n" + table.finish() + pauses_of(contents.result);
}

std::string losses_section(const ReportContents& contents) {
  HtmlTable table("legend", {"source", "samples used", "did not come", "came unusable",
                             "dropped by a full buffer", "stamp not trusted", "not measured"});
  for (const auto& [source, sum] : losses_of(contents.result, contents.channels.front())) {
    table.row({source, std::to_string(sum.used), std::to_string(sum.lost),
               std::to_string(sum.unusable), std::to_string(sum.overflowed),
               std::to_string(sum.not_trusted), std::to_string(sum.not_measured)});
  }
  return "<h2>Losses within the evaluated steps</h2>\n" + table.finish();
}

std::string closures_section(const ReportContents& contents) {
  std::string html;
  for (const std::string& channel : contents.channels) {
    HtmlTable table("legend", {"what must hold", "", "value", "limit", "found"});
    for (const Closure& closure : contents.result.closures_of(channel)) {
      const auto number = [&](double value) {
        return closure.verdict == Verdict::not_possible
                   ? std::string()
                   : fmt::format("{:.3g}{}", value, closure.unit == "1" ? "" : " " + closure.unit);
      };
      table.row({std::string(title_of(closure.kind)),
                 closure.verdict == Verdict::not_possible ? "not possible"
                                                          : std::string(to_string(closure.verdict)),
                 number(closure.value), number(closure.limit), closure.sentence});
    }
    if (!table.empty()) {
      html += element("h2", "Closures of " + channel) + table.finish();
    }
  }
  return html;
}

std::string clock_section(const ReportContents& contents) {
  std::string html;
  for (const ClockReport& report : contents.result.clocks) {
    html += fmt::format("<h2>Sample clock of {}</h2>\n", escaped(report.source)) +
            clock_facts(report.clock);
  }
  for (const EmbeddedPicture& picture : contents.pictures) {
    html += fmt::format("<figure><img src=\"{}\" alt=\"{}\"></figure>\n",
                        escaped(picture.data_uri()), escaped(picture.file_name));
  }
  for (const std::string& reason : contents.left_out) {
    html += element("p", "A figure of the run folder is left out: " + reason, "warning");
  }
  return html;
}

std::string equipment_section(const ReportContents& contents) {
  HtmlTable table("legend", {"equipment", "serial", "certificate", "calibrated by", "from, until"});
  const auto add = [&](const CalibratedDevice& device) {
    std::string name = device.name;
    for (const std::string& text : {device.manufacturer, device.model}) {
      name += text.empty() ? "" : ", " + text;
    }
    table.row({name, device.serial, device.certificate, device.issued_by,
               device.issued + (device.valid_until.empty() ? "" : ", " + device.valid_until)});
  };
  if (const ReferenceStandard* reference = reference_of(contents)) {
    std::ranges::for_each(reference->devices, add);
  }
  if (contents.laboratory) {
    std::ranges::for_each(contents.laboratory->equipment, add);
  }
  for (const CalibratedDevice& device : run_equipment(contents.result, contents.channels.front())) {
    add(device);
  }
  return table.empty() ? "" : "<h2>Equipment</h2>\n" + table.finish();
}

std::string devices_section(const ReportContents& contents) {
  HtmlTable table("legend", {"source", "device", "serial", "firmware", "nominal rate / Hz",
                             "time base", "software"});
  for (const RunSource& source : contents.result.sources) {
    const drivers::SourceDescription& description = source.description;
    table.row(
        {source.source, description.device, description.serial, description.firmware,
         description.nominal_rate_hz > 0.0 ? fmt::format("{:g}", description.nominal_rate_hz) : "",
         to_string(description.time_base), source.software});
  }
  return "<h2>Annex: devices and corrections</h2>\n" + table.finish() +
         corrections_of(contents.result) + applied_corrections(contents.result);
}

std::string software_section(const ReportContents& contents) {
  const StoredResult& result = contents.result;
  DefinitionTable table;
  table.add("Run conducted with", result.software);
  table.add("Evaluated by", result.analysis_software);
  table.add("on host", result.analysis_host);
  table.add("DDS implementation of the analysis", result.analysis_dds);
  table.add("Report made by", contents.software);
  table.add("Held against", fmt::format("{}", fmt::join(contents.provenance, " ")));
  const auto hash = [](const std::string& text) {
    return fmt::format("<code>{}</code>", escaped(text));
  };
  table.add_html("Result file", escaped(result.file.filename().string()));
  table.add_html("its SHA-256", hash(result.sha256));
  table.add_html("SHA-256 of the recipe", hash(result.recipe_sha256));
  return "<h2>Annex: software and hashes</h2>\n" + table.finish();
}

std::string recipe_section(const ReportContents& contents) {
  const std::string& recipe = contents.result.recipe;
  return recipe.empty()
             ? ""
             : "<h2>Annex: recipe (bench file)</h2>\n<pre>" + escaped(recipe) + "</pre>\n";
}

} // namespace dyncal::inline views
