#include "services/views/document/report_sections.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/rounding.hpp"
#include "services/contract/unit.hpp"
#include "services/evaluation/result/delay_points.hpp"
#include "services/evaluation/result/point_identity.hpp"
#include "services/views/document/html.hpp"
#include "services/views/figures/deviation.hpp"
#include "services/views/report/stated_value.hpp"
#include "services/views/report/transfer_data.hpp"

namespace dyncal::inline views {
namespace {

constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

std::string in_unit(const std::string& quantity, const std::string& unit) {
  const std::string shown = short_form(unit);
  return shown.empty() || shown == "1" ? quantity
                                       : fmt::format("{} / ({})", quantity, escaped(shown));
}

// Of a flag in the list of the report; 0: not in it.
std::size_t flag_number(const StoredResult& result, const std::string& name) {
  const auto found = std::ranges::find(result.flags, name, &StoredFlag::name);
  return found == result.flags.end() ? 0
                                     : static_cast<std::size_t>(found - result.flags.begin()) + 1;
}

// "F1 F3"
std::string flag_marks(const StoredResult& result, const std::vector<std::string>& names) {
  std::vector<std::string> marks;
  for (const std::string& name : names) {
    const std::size_t number = flag_number(result, name);
    std::string mark = number == 0 ? name : fmt::format("F{}", number);
    if (std::find(marks.begin(), marks.end(), mark) == marks.end()) {
      marks.push_back(std::move(mark));
    }
  }
  return fmt::format("{}", fmt::join(marks, " "));
}

// The mean of what the reference measured; in brackets what was planned where it measured nothing.
std::string level_cell(const StoredResult& result, const StoredValue& value) {
  const double level_m_s2 = measured_level_m_s2(result, value);
  return std::isfinite(level_m_s2) ? fmt::format("{:.4g}", level_m_s2)
                                   : fmt::format("({:g})", value.level_m_s2);
}

// U in per cent of the value.
std::string per_cent_cell(const StoredValue& value) {
  return value.magnitude > 0.0
             ? rounded_uncertainty(100.0 * value.of_magnitude.expanded / value.magnitude)
             : "";
}

std::string value_table(const ReportContents& contents, const std::vector<StoredValue>& values) {
  HtmlTable table("values",
                  {"<i>f</i> / Hz", "<i>a</i> / (m/s²)", in_unit("|<i>H</i>|", values.front().unit),
                   "<i>U</i>(|<i>H</i>|)", "<i>U</i> / %", "<i>k</i>", "<i>φ</i> / °",
                   "<i>U</i>(<i>φ</i>) / °", "<i>φ</i> / rad", "<i>U</i>(<i>φ</i>) / rad",
                   "<i>k</i>", "<i>n</i>", "flags"});
  for (const StoredValue& value : values) {
    const StatedValue magnitude = stated_magnitude(value);
    const StatedValue degrees = stated_phase_deg(value);
    const StatedValue radians = stated_phase_rad(value);
    table.row({value.frequency_text_hz, level_cell(contents.result, value), magnitude.value,
               magnitude.expanded, per_cent_cell(value), magnitude.k, degrees.value,
               degrees.expanded, radians.value, radians.expanded, radians.k,
               std::to_string(value.repetitions), flag_marks(contents.result, value.flag_names)});
  }
  return table.finish();
}

std::string joined(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, " "));
}

// Ids of several figures would meet in one document.
std::string with_own_ids(std::string svg, std::size_t figure) {
  for (const std::string& opening : {std::string("id=\"clip"), std::string("url(#clip")}) {
    const std::string own = opening.substr(0, opening.size() - 4) + fmt::format("f{}clip", figure);
    for (std::size_t at = svg.find(opening); at != std::string::npos;
         at = svg.find(opening, at + own.size())) {
      svg.replace(at, opening.size(), own);
    }
  }
  const std::size_t begin = svg.find("<svg");
  return begin == std::string::npos ? "" : svg.substr(begin);
}

// "80", with the level where there are several.
std::string place_cell(const StoredPoint& point, bool with_level) {
  return with_level ? fmt::format("{} at {:g} m/s²", point.frequency_text_hz, point.level_m_s2)
                    : point.frequency_text_hz;
}

figures::TransferFunctionData transfer_data(const StoredResult& result, const std::string& channel,
                                            const std::vector<StoredValue>& values) {
  figures::TransferFunctionData data;
  data.error_bars = figures::ErrorBars::expanded; // as the tables state
  data.title = channel;
  data.subtitle = fmt::format("bench {}, run {}", result.bench, result.run);
  data.unit = short_form(values.front().unit);
  data.excited_axis = values.front().excited_axis;
  for (const StoredPoint& point : result.points_of(channel)) {
    if (point.valid) {
      data.repetitions.push_back(repetition_of(point, joined(point.flag_names)));
    }
  }
  for (const StoredValue& value : values) {
    data.mean.push_back(
        {value.frequency_hz,
         value.level_m_s2,
         {value.magnitude, value.of_magnitude.u, value.unwrapped_phase_rad, value.of_phase.u},
         joined(value.flag_names),
         value.of_magnitude.expanded,
         value.of_phase.expanded,
         value.phase_rad});
  }
  if (const analysis::GroupDelay* delay = result.group_delay_of(channel)) {
    data.group_delay = *delay;
  }
  return data;
}

std::string figure_element(const figures::Picture& picture, std::size_t number,
                           const std::string& caption) {
  return "<figure>\n" + with_own_ids(svg_of(picture), number) + element("figcaption", caption) +
         "\n</figure>\n";
}

// Two a channel: `number` counts channels.
std::string channel_figures(const figures::TransferFunctionData& data, std::size_t number) {
  return figure_element(figures::transfer_function_figure(data, "").picture, 2 * number,
                        "Repetitions (markers), mean with bars of the expanded uncertainty U "
                        "(line); phase unwrapped; values with a flag have a ring.") +
         figure_element(figures::deviation_figure(data, "").picture, 2 * number + 1,
                        "Repetitions with bars of their standard uncertainty, against their mean "
                        "(zero) with its expanded uncertainty U (band).");
}

std::string delay_sentence(const StoredResult& result, const std::string& channel) {
  const analysis::GroupDelay* delay = result.group_delay_of(channel);
  if (delay == nullptr) {
    return "";
  }
  analysis::CombinedUncertainty of_delay_us = delay->of_delay;
  of_delay_us.u *= 1e6;
  const std::set<double> levels = delay_levels_m_s2(result.values_of(channel));
  return element(
      "p", fmt::format("Group delay over all frequencies (from the slope of the phase{}): {}.",
                       levels.empty() ? "" : fmt::format(" at {} m/s²", fmt::join(levels, ", ")),
                       stated_text(1e6 * delay->delay_s, of_delay_us, "us")));
}

// The first valid result of every frequency: its budget stands for the others.
std::vector<StoredPoint> budget_points(const StoredResult& result, const std::string& channel) {
  std::vector<StoredPoint> chosen;
  for (StoredPoint& point : result.points_of(channel)) {
    const bool is_new = std::none_of(chosen.begin(), chosen.end(), [&](const StoredPoint& other) {
      return other.frequency_hz == point.frequency_hz && other.level_m_s2 == point.level_m_s2;
    });
    if (point.valid && is_new && !point.budget.empty()) {
      chosen.push_back(std::move(point));
    }
  }
  return chosen;
}

std::vector<analysis::Contribution> contributions_of(const std::vector<StoredPoint>& points) {
  std::vector<analysis::Contribution> rows;
  for (const StoredPoint& point : points) {
    for (const analysis::Contribution& row : point.budget) {
      if (std::none_of(rows.begin(), rows.end(), [&](const analysis::Contribution& other) {
            return other.name() == row.name();
          })) {
        rows.push_back(row);
      }
    }
  }
  return rows;
}

// Two digits without an exponent where that is readable; nothing for what is not there.
std::string small_number(double value) {
  if (!std::isfinite(value) || value == 0.0) {
    return value == 0.0 ? "0" : "";
  }
  return std::abs(value) < 1e-5 ? fmt::format("{:.0e}", value) : rounded_uncertainty(value);
}

// Columns are contributions C1, C2, ...; in per cent and degrees.
std::string budget_table(const std::vector<StoredPoint>& points,
                         const std::vector<analysis::Contribution>& rows, bool of_magnitude) {
  std::vector<std::string> head{"<i>f</i> / Hz"};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    head.push_back(fmt::format("C{}", i + 1));
  }
  head.emplace_back("<i>u</i>");
  HtmlTable table("budget", head);
  const bool with_level = have_several_levels(points);
  for (const StoredPoint& point : points) {
    std::vector<std::string> cells{place_cell(point, with_level)};
    double squares = 0.0;
    for (const analysis::Contribution& column : rows) {
      const auto found =
          std::ranges::find(point.budget, column.name(), &analysis::Contribution::name);
      if (found == point.budget.end()) {
        cells.emplace_back("");
        continue;
      }
      const double u =
          of_magnitude ? 100.0 * found->u_magnitude_rel : degrees_per_radian * found->u_phase_rad;
      squares += u * u;
      cells.push_back(small_number(u));
    }
    cells.push_back(small_number(std::sqrt(squares)));
    table.row(cells);
  }
  return table.finish();
}

std::string budget_section(const StoredResult& result, const std::string& channel) {
  const std::vector<StoredPoint> points = budget_points(result, channel);
  const std::vector<analysis::Contribution> rows = contributions_of(points);
  if (rows.empty()) {
    return "";
  }
  std::string html = fmt::format("<h3>Uncertainty budget of {}</h3>\n", escaped(channel));
  html += element("p", "Standard uncertainties (k = 1) of a single result, the first valid one at "
                       "each frequency; rows add in squares. In the mean over the repetitions, "
                       "what is drawn anew averages, what is common does not; its U also holds "
                       "the scatter of the repetitions.");
  HtmlTable legend(
      "legend", {"", "contribution", "distribution", "in every repetition", "degrees of freedom"});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const analysis::Contribution& row = rows[i];
    legend.row({fmt::format("C{}", i + 1), row.name(), std::string(to_string(row.distribution)),
                std::string(to_string(row.repeats)),
                std::isfinite(row.degrees_of_freedom)
                    ? fmt::format("{:.0f}", row.degrees_of_freedom)
                    : "infinite"});
  }
  html += legend.finish();
  html += "<h4>Magnitude: <i>u</i> / % of the value</h4>\n" + budget_table(points, rows, true);
  html += "<h4>Phase: <i>u</i> / °</h4>\n" + budget_table(points, rows, false);
  return html;
}

std::string missing_values(const StoredResult& result, const std::string& channel) {
  HtmlTable table("legend", {"<i>f</i> / Hz", "repetition", "why there is no value"});
  const bool with_level = have_several_levels(result.points);
  for (const StoredPoint& point : result.points_of(channel)) {
    if (!point.valid) {
      table.row({place_cell(point, with_level), std::to_string(point.repetition), point.problem});
    }
  }
  return table.empty() ? "" : element("p", "Without a value:", "warning") + table.finish();
}

} // namespace

std::string channel_section(const ReportContents& contents, const std::string& channel,
                            std::size_t number) {
  const StoredResult& result = contents.result;
  const std::vector<StoredValue> values = result.values_of(channel);
  std::string html = fmt::format("<section>\n<h2>Transfer function of {}</h2>\n", escaped(channel));
  html += element(
      "p", fmt::format("Means over n repetitions. U is the expanded uncertainty, U = k u, for a "
                       "coverage probability of {}; a is the amplitude of the excitation that the "
                       "reference measured, in brackets where it is only planned.",
                       coverage_percent(values.front().coverage_probability)));
  html += element("p", "U holds what the records show and what the bench file states. Errors that "
                       "leave no trace in the records are listed, each with the experiment that "
                       "shows it, on the page \"what this measurement cannot see\" of the guide "
                       "(what-it-cannot-see.md).");
  html += value_table(contents, values);
  if (const std::string advice = advice_on_repetitions(values); !advice.empty()) {
    html += element("p", advice);
  }
  html += missing_values(result, channel);
  html += delay_sentence(result, channel);
  html += channel_figures(transfer_data(result, channel, values), number);
  return html + budget_section(result, channel) + "</section>\n";
}

std::string other_channels(const ReportContents& contents) {
  HtmlTable table("legend", {"channel", "unit", "responds", "largest |<i>H</i>|"});
  for (const StoredChannel& channel : contents.result.channels) {
    if (std::find(contents.channels.begin(), contents.channels.end(), channel.channel) !=
        contents.channels.end()) {
      continue;
    }
    double largest = 0.0;
    for (const StoredValue& value : contents.result.values_of(channel.channel)) {
      largest = std::max(largest, std::isfinite(value.magnitude) ? value.magnitude : 0.0);
    }
    table.row({channel.channel, short_form(channel.unit), channel.responds ? "yes" : "no",
               rounded_uncertainty(largest)});
  }
  return table.empty() ? ""
                       : "<h2>Other channels of the run</h2>\n" +
                             element("p", "Evaluated as well; their values are in the result file. "
                                          "A channel responds if its magnitude is above three "
                                          "times its standard uncertainty at most frequencies.") +
                             table.finish();
}

std::string flag_section(const ReportContents& contents) {
  const std::string heading = "<h2>Flags</h2>\n";
  if (contents.result.flags.empty()) {
    return heading + element("p", "No value of this run has a flag.");
  }
  HtmlTable table("legend", {"", "flag", "found", "what it means"});
  for (std::size_t i = 0; i < contents.result.flags.size(); ++i) {
    const StoredFlag& flag = contents.result.flags[i];
    constexpr std::size_t max_sentences = 4;
    table.row({fmt::format("F{}", i + 1), flag.name,
               fmt::format("{}", fmt::join(first_of(flag.sentences, max_sentences), "; ")),
               flag.meaning});
  }
  return heading + table.finish();
}

std::string single_results(const ReportContents& contents) {
  std::string html = "<h2>Annex: single results</h2>\n" +
                     element("p", "One result a step and repetition; u is a standard uncertainty "
                                  "(k = 1). The hash is the beginning of the SHA-256 of the "
                                  "samples used; the result file has all of it.");
  const bool with_level = have_several_levels(contents.result.points);
  for (const std::string& channel : contents.channels) {
    HtmlTable table("single", {"<i>f</i> / Hz", "rep.", "|<i>H</i>|", "<i>u</i>", "<i>φ</i> / °",
                               "<i>u</i> / °", "measured <i>a</i>", "<i>T</i> / °C", "lost", "data",
                               "flags"});
    for (const StoredPoint& point : contents.result.points_of(channel)) {
      const RoundedValue magnitude = round_by_uncertainty(point.magnitude, point.u_magnitude);
      const RoundedValue phase = round_phase(point.phase_rad, point.u_phase_rad).degrees;
      const auto shown = [](double value, int decimals) {
        return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : std::string();
      };
      table.row({place_cell(point, with_level), std::to_string(point.repetition),
                 point.valid ? magnitude.value : "no value", point.valid ? magnitude.u : "",
                 point.valid ? phase.value : "", point.valid ? phase.u : "",
                 shown(point.measured_level_m_s2, 3),
                 shown(point.temperature_degc.value_or(NAN), 1), std::to_string(point.lost),
                 point.data_sha256.substr(0, 12), flag_marks(contents.result, point.flag_names)});
    }
    html += fmt::format("<h3>{}</h3>\n", escaped(channel)) + table.finish();
  }
  return html;
}

} // namespace dyncal::inline views
