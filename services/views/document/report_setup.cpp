#include "services/views/document/report_setup.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/core.h>

#include "services/contract/unit.hpp"
#include "services/views/document/html.hpp"
#include "services/views/report/rounding.hpp"

namespace dyncal::services {
namespace {

std::string with_uncertainty(const MeasuredCondition& condition, const std::string& unit) {
  const RoundedValue rounded = round_by_uncertainty(condition.value, condition.expanded);
  return fmt::format("{} {}, U = {} {} (k = 2)", rounded.value, unit, rounded.u, unit);
}

// "10.2 to 11.7"; empty without a finite value.
std::string range_of(const std::vector<StoredPoint>& points, double StoredPoint::*member,
                     int decimals) {
  double low = INFINITY;
  double high = -INFINITY;
  for (const StoredPoint& point : points) {
    if (std::isfinite(point.*member)) {
      low = std::min(low, point.*member);
      high = std::max(high, point.*member);
    }
  }
  return low > high ? "" : fmt::format("{:.{}f} to {:.{}f}", low, decimals, high, decimals);
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
  const CheckedJson root = result.root();
  if (!root.has("pauses")) {
    return "";
  }
  HtmlTable table("legend", {"pause from", "to", "reason"});
  for (const CheckedJson& pause : root.nodes("pauses")) {
    table.row({pause.text("began_utc"), pause.text("ended_utc"), pause.text("reason")});
  }
  return table.finish();
}

struct Losses {
  double used = 0;
  double lost = 0;
  double unusable = 0;
  double overflowed = 0;
  double not_trusted = 0;
  double not_measured = 0;
};

std::string count_text(double count) {
  return fmt::format("{:.0f}", count);
}

// Every step once: all channels of a source share its samples.
std::map<std::string, Losses> losses_of(const StoredResult& result, const std::string& channel) {
  std::map<std::string, Losses> losses;
  for (const CheckedJson& point : result.root().nodes("points")) {
    if (point.text("channel") != channel || !point.has("source_samples")) {
      continue;
    }
    for (const CheckedJson& source : point.nodes("source_samples")) {
      Losses& sum = losses[source.text("source")];
      sum.used += source.number("used");
      sum.lost += source.number("lost");
      sum.unusable += source.number("unusable");
      sum.overflowed += source.number("overflowed");
      sum.not_trusted += source.number("not_trusted");
      sum.not_measured += source.number("not_measured");
    }
  }
  return losses;
}

std::string microseconds(double seconds, int decimals) {
  return std::isfinite(seconds) ? fmt::format("{:.{}f} us", 1e6 * seconds, decimals) : "";
}

std::string clock_facts(const CheckedJson& clock) {
  const double rate_hz = clock.number("mean_rate_hz");
  const double interval_s = clock.number("mean_interval_s");
  const double u_interval_s = clock.number("u_mean_interval_s");
  DefinitionTable table;
  table.add("Mean sample rate",
            std::isfinite(u_interval_s) && u_interval_s > 0.0 && interval_s > 0.0
                ? [&] {
                    const RoundedValue rounded = round_by_uncertainty(
                        rate_hz, 2.0 * rate_hz * u_interval_s / interval_s);
                    return fmt::format("{} Hz, U = {} Hz (k = 2)", rounded.value, rounded.u);
                  }()
                : fmt::format("{:.6g} Hz (nothing is known of its uncertainty)", rate_hz));
  table.add("Sample intervals", fmt::format("{:.0f}", clock.number("count")));
  table.add("Median, smallest, largest",
            fmt::format("{}, {}, {}", microseconds(clock.number("median_s"), 3),
                        microseconds(clock.number("min_s"), 3),
                        microseconds(clock.number("max_s"), 3)));
  table.add("Standard deviation", microseconds(clock.number("sd_s"), 4));
  table.add("Resolution of the stamps", microseconds(clock.number("tick_s"), 5));
  table.add("Events (steps, gaps, doubled samples)", fmt::format("{:.0f}", clock.number("events")));
  table.add("Samples lost over the whole run", fmt::format("{:.0f}", clock.number("lost")));
  return table.finish();
}

std::string corrections_of(const StoredResult& result) {
  const CheckedJson root = result.root();
  if (!root.has("corrections")) {
    return "";
  }
  const CheckedJson corrections = root.node("corrections");
  DefinitionTable table;
  const double reference_delay_s = corrections.number("reference_delay_s");
  table.add("Delay of the reference", reference_delay_s != 0.0
                                          ? fmt::format("{:g} s", reference_delay_s)
                                          : std::string("none"));
  if (corrections.has("adc_calibration")) {
    const std::size_t points = corrections.nodes("adc_calibration").size();
    table.add("Sync ADC of the acquisition unit",
              points == 0 ? std::string("not corrected")
                          : fmt::format("calibrated at {} frequencies", points));
  }
  if (corrections.has("dso_delay_s")) {
    table.add("Delay of the oscilloscope's trigger",
              fmt::format("{:g} s, u = {:g} s", corrections.number("dso_delay_s"),
                          corrections.number("u_dso_delay_s")));
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
  for (const CheckedJson& step : result.root().nodes("steps")) {
    for (const CheckedJson& correction : step.nodes("corrections")) {
      Range& range = ranges[correction.text("name")];
      const double stated = correction.number("phase_deg");
      const double degrees =
          range.high < range.low ? stated : stated + turn * std::round((range.low - stated) / turn);
      range.low = std::min(range.low, degrees);
      range.high = std::max(range.high, degrees);
      range.u = std::max(range.u, correction.number("u_phase_rad"));
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
  std::vector<StoredPoint> points;
  for (const std::string& channel : contents.channels) {
    for (StoredPoint& point : contents.result.points_of(channel)) {
      points.push_back(std::move(point));
    }
  }
  const std::string temperature = range_of(points, &StoredPoint::temperature_degc, 1);
  table.add("Temperature of the sensor, measured by itself",
            temperature.empty() ? "" : temperature + " °C");
  const std::string level = range_of(points, &StoredPoint::measured_level_m_s2, 3);
  table.add("Amplitude of the excitation, measured", level.empty() ? "" : level + " m/s²");
  table.add("Largest deviation from the planned amplitude", level_deviation(points));
  return "<h2>Conditions</h2>\n" + table.finish() + pauses_of(contents.result);
}

std::string losses_section(const ReportContents& contents) {
  HtmlTable table("legend", {"source", "samples used", "did not come", "came unusable",
                             "dropped by a full buffer", "stamp not trusted", "not measured"});
  for (const auto& [source, sum] : losses_of(contents.result, contents.channels.front())) {
    table.row({source, count_text(sum.used), count_text(sum.lost), count_text(sum.unusable),
               count_text(sum.overflowed), count_text(sum.not_trusted),
               count_text(sum.not_measured)});
  }
  return "<h2>Losses within the evaluated steps</h2>\n" + table.finish();
}

std::string clock_section(const ReportContents& contents) {
  std::string html;
  for (const CheckedJson& clock : contents.result.root().nodes("sample_clock")) {
    html += fmt::format("<h2>Sample clock of {}</h2>\n", escaped(clock.text("source"))) +
            clock_facts(clock);
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

std::string devices_section(const ReportContents& contents) {
  HtmlTable table("legend", {"source", "device", "serial", "firmware", "nominal rate / Hz",
                             "time base", "software"});
  for (const CheckedJson& source : contents.result.root().nodes("sources")) {
    const double rate_hz = source.number_or("nominal_rate_hz", NAN);
    table.row({source.text("source"), source.text_or("device", ""), source.text_or("serial", ""),
               source.text_or("firmware", ""),
               std::isfinite(rate_hz) && rate_hz > 0.0 ? fmt::format("{:g}", rate_hz) : "",
               source.text_or("time_base", ""), source.text_or("software", "")});
  }
  return "<h2>Annex: devices and corrections</h2>\n" + table.finish() +
         corrections_of(contents.result) + applied_corrections(contents.result);
}

std::string software_section(const ReportContents& contents) {
  const StoredResult& result = contents.result;
  const CheckedJson root = result.root();
  DefinitionTable table;
  table.add("Run conducted with", result.software);
  table.add("Evaluated by", root.node("analysis").text_or("software", ""));
  table.add("on host", root.node("analysis").text_or("host", ""));
  table.add("DDS implementation of the analysis", root.node("dds").text_or("analysis", ""));
  table.add("Report made by", contents.software);
  const auto hash = [](const std::string& text) {
    return fmt::format("<code>{}</code>", escaped(text));
  };
  table.add_html("Result file", escaped(result.file.filename().string()));
  table.add_html("its SHA-256", hash(result.sha256));
  table.add_html("SHA-256 of the recipe", hash(result.recipe_sha256));
  return "<h2>Annex: software and hashes</h2>\n" + table.finish();
}

std::string recipe_section(const ReportContents& contents) {
  const std::string recipe = contents.result.root().text_or("recipe", "");
  return recipe.empty()
             ? ""
             : "<h2>Annex: recipe (bench file)</h2>\n<pre>" + escaped(recipe) + "</pre>\n";
}

} // namespace dyncal::services
