#include "services/views/document/report_sections.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "services/base/rounding.hpp"
#include "services/contract/unit.hpp"
#include "services/evaluation/result/delay_points.hpp"
#include "services/evaluation/result/point_identity.hpp"
#include "services/views/document/html.hpp"
#include "services/views/figures/deviation.hpp"
#include "services/views/language/flag_text.hpp"
#include "services/views/language/report_sentences.hpp"
#include "services/views/objections/objections.hpp"
#include "services/views/report/stated_value.hpp"
#include "services/views/report/transfer_data.hpp"

namespace dyncal::inline views {
namespace {

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
                   "<i>k</i>", "<i>n</i>", sentences::flags_column(contents.language)});
  for (const StoredValue& value : values) {
    const StatedValue magnitude = stated_magnitude(value);
    const StatedValue degrees = stated_phase_deg(value);
    const StatedValue radians = stated_phase_rad(value);
    table.row(
        decimal(contents.language, {value.frequency_text_hz, level_cell(contents.result, value),
                                    magnitude.value, magnitude.expanded, per_cent_cell(value),
                                    magnitude.k, degrees.value, degrees.expanded, radians.value,
                                    radians.expanded, radians.k, std::to_string(value.repetitions),
                                    flag_marks(contents.result, value.flag_names)}));
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

figures::TransferFunctionData transfer_data(const ReportContents& contents,
                                            const std::string& channel,
                                            const std::vector<StoredValue>& values) {
  const StoredResult& result = contents.result;
  figures::TransferFunctionData data;
  data.language = contents.language;
  data.error_bars = figures::ErrorBars::expanded; // as the tables state
  data.title = channel;
  data.subtitle = fmt::format("{}, {}", sentences::bench_mark(data.language, result.bench),
                              sentences::run_mark(data.language, result.run));
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
    data.removes_delay = true;
  }
  return data;
}

std::string figure_element(const figures::Picture& picture, std::size_t number,
                           const std::string& caption) {
  return "<figure>\n" + with_own_ids(svg_of(picture), number) + element("figcaption", caption) +
         "\n</figure>\n";
}

std::string delay_text(const analysis::GroupDelay& delay, Language language) {
  const bool is_short = std::abs(delay.delay_s) < 1e-3;
  const double unit = is_short ? 1e6 : 1e3;
  analysis::CombinedUncertainty of_delay = delay.of_delay;
  of_delay.u *= unit;
  return stated_text(unit * delay.delay_s, of_delay, is_short ? "µs" : "ms", language);
}

std::string phase_caption(const figures::TransferFunctionData& data) {
  return data.group_delay
             ? sentences::delay_removed(data.language, delay_text(*data.group_delay, data.language))
             : sentences::phase_continuous(data.language);
}

// Two a channel: `number` counts channels.
std::string channel_figures(const figures::TransferFunctionData& data, std::size_t number) {
  return figure_element(figures::transfer_function_figure(data, "").picture, 2 * number,
                        sentences::figure_caption(data.language, phase_caption(data))) +
         figure_element(figures::deviation_figure(data, "").picture, 2 * number + 1,
                        sentences::deviation_caption(data.language));
}

std::string delay_sentence(const ReportContents& contents, const std::string& channel) {
  const analysis::GroupDelay* delay = contents.result.group_delay_of(channel);
  if (delay == nullptr) {
    return "";
  }
  const Language language = contents.language;
  const std::set<double> levels = delay_levels_m_s2(contents.result.values_of(channel));
  const std::string at_levels =
      levels.empty() ? ""
                     : sentences::at_levels(
                           language, decimal(language, fmt::format("{}", fmt::join(levels, "; "))));
  return element("p", sentences::group_delay(language, at_levels, delay_text(*delay, language)));
}

std::string missing_values(const ReportContents& contents, const std::string& channel) {
  const Language language = contents.language;
  HtmlTable table("legend", {"<i>f</i> / Hz", sentences::repetition(language),
                             sentences::why_no_value(language)});
  for (const StoredPoint& point : contents.result.points_of(channel)) {
    if (!point.valid) {
      table.row({place_cell(contents, point), std::to_string(point.repetition),
                 why_without_value(point).in(language)});
    }
  }
  return table.empty()
             ? ""
             : element("p", sentences::without_a_value, language, "warning") + table.finish();
}

// Where values of the channels that are shown have a flag: in place of the evaluation's sentences,
// which are in English alone.
std::string flag_places(const ReportContents& contents, const std::string& flag) {
  const auto has = [&](const std::vector<std::string>& names) {
    return std::ranges::find(names, flag) != names.end();
  };
  std::vector<std::string> places;
  for (const std::string& channel : contents.channels) {
    std::vector<std::string> frequencies;
    const auto add = [&](const std::string& frequency_text_hz) {
      if (std::ranges::find(frequencies, frequency_text_hz) == frequencies.end()) {
        frequencies.push_back(frequency_text_hz);
      }
    };
    for (const StoredValue& value : contents.result.values_of(channel)) {
      if (has(value.flag_names)) {
        add(value.frequency_text_hz);
      }
    }
    for (const StoredPoint& point : contents.result.points_of(channel)) {
      if (has(point.flag_names)) {
        add(point.frequency_text_hz);
      }
    }
    const auto whole =
        std::ranges::find(contents.result.channels, channel, &StoredChannel::channel);
    if (whole != contents.result.channels.end() && has(whole->flag_names)) {
      places.push_back(sentences::all_frequencies(contents.language, channel));
    } else if (!frequencies.empty()) {
      places.push_back(
          fmt::format("{}: {} Hz", channel,
                      decimal(contents.language, fmt::format("{}", fmt::join(frequencies, "; ")))));
    }
  }
  return fmt::format("{}", fmt::join(places, "; "));
}

} // namespace

std::string place_cell(const ReportContents& contents, const StoredPoint& point) {
  const std::string frequency = decimal(contents.language, point.frequency_text_hz);
  return have_several_levels(contents.result.points)
             ? sentences::at_level(
                   contents.language, frequency,
                   decimal(contents.language, fmt::format("{:g}", point.level_m_s2)))
             : frequency;
}

std::string channel_section(const ReportContents& contents, const std::string& channel,
                            std::size_t number) {
  const StoredResult& result = contents.result;
  const Language language = contents.language;
  const std::vector<StoredValue> values = result.values_of(channel);
  std::string html =
      "<section>\n" + element("h2", sentences::transfer_function_of(language, channel));
  html += element(
      "p",
      sentences::means(language, coverage_percent(values.front().coverage_probability, language)));
  html += element("p", sentences::not_seen, language);
  html += value_table(contents, values);
  if (const std::string advice = advice_on_repetitions(values, language); !advice.empty()) {
    html += element("p", advice);
  }
  html += missing_values(contents, channel);
  html += delay_sentence(contents, channel);
  html += channel_figures(transfer_data(contents, channel, values), number);
  return html + budget_section(contents, channel) + "</section>\n";
}

std::string other_channels(const ReportContents& contents) {
  const Language language = contents.language;
  HtmlTable table("legend", {sentences::channel(language), sentences::unit(language),
                             sentences::responds(language),
                             fmt::format("{} |<i>H</i>|", sentences::largest.in(language))});
  for (const StoredChannel& channel : contents.result.channels) {
    if (std::find(contents.channels.begin(), contents.channels.end(), channel.channel) !=
        contents.channels.end()) {
      continue;
    }
    double largest = 0.0;
    for (const StoredValue& value : contents.result.values_of(channel.channel)) {
      largest = std::max(largest, std::isfinite(value.magnitude) ? value.magnitude : 0.0);
    }
    table.row({channel.channel, short_form(channel.unit),
               (channel.responds ? sentences::yes : sentences::no)(language),
               decimal(language, rounded_uncertainty(largest))});
  }
  return table.empty() ? ""
                       : element("h2", sentences::other_channels, language) +
                             element("p", sentences::also_evaluated, language) + table.finish();
}

std::string flag_section(const ReportContents& contents) {
  const Language language = contents.language;
  const std::string heading = element("h2", sentences::flags, language);
  if (contents.result.flags.empty()) {
    return heading + element("p", sentences::no_flag, language);
  }
  HtmlTable table("legend", {"", sentences::flag(language), sentences::found(language),
                             sentences::what_it_means(language)});
  for (std::size_t i = 0; i < contents.result.flags.size(); ++i) {
    const StoredFlag& flag = contents.result.flags[i];
    constexpr std::size_t max_sentences = 4;
    const bool is_english = language == Language::english;
    table.row(
        {fmt::format("F{}", i + 1), flag.name,
         is_english ? fmt::format("{}", fmt::join(first_of(flag.sentences, max_sentences), "; "))
                    : flag_places(contents, flag.name),
         is_english ? flag.meaning : std::string(german_meaning_of(parse_flag_name(flag.name)))});
  }
  return heading + table.finish();
}

std::string single_results(const ReportContents& contents) {
  const Language language = contents.language;
  std::string html = element("h2", sentences::single_results, language) +
                     element("p", sentences::single_results_note, language);
  for (const std::string& channel : contents.channels) {
    HtmlTable table("single", {"<i>f</i> / Hz", sentences::repetition_short(language), "|<i>H</i>|",
                               "<i>u</i>", "<i>φ</i> / °", "<i>u</i> / °",
                               sentences::measured_amplitude(language), "<i>T</i> / °C",
                               sentences::lost(language), sentences::data(language),
                               sentences::flags_column(language)});
    for (const StoredPoint& point : contents.result.points_of(channel)) {
      const RoundedValue magnitude = round_by_uncertainty(point.magnitude, point.u_magnitude);
      const RoundedValue phase = round_phase(point.phase_rad, point.u_phase_rad).degrees;
      const auto shown = [](double value, int decimals) {
        return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : std::string();
      };
      std::vector<std::string> cells =
          decimal(language,
                  {point.valid ? magnitude.value : "", point.valid ? magnitude.u : "",
                   point.valid ? phase.value : "", point.valid ? phase.u : "",
                   shown(point.measured_level_m_s2, 3),
                   shown(point.temperature_degc.value_or(NAN), 1), std::to_string(point.lost),
                   point.data_sha256.substr(0, 12), flag_marks(contents.result, point.flag_names)});
      if (!point.valid) {
        cells.front() = sentences::no_value(language);
      }
      cells.insert(cells.begin(), {place_cell(contents, point), std::to_string(point.repetition)});
      table.row(cells);
    }
    html += element("h3", channel) + table.finish();
  }
  return html;
}

} // namespace dyncal::inline views
