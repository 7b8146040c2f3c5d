#include "services/programs/command/check_view.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <iterator>
#include <numbers>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "services/base/per_enumerator.hpp"
#include "services/base/printable_text.hpp"
#include "services/contract/run_identity.hpp"
#include "services/programs/command/command.hpp"
#include "services/views/figures/control_chart.hpp"
#include "services/views/report/json_number.hpp"

namespace dyncal::inline programs {
namespace {

using Json = nlohmann::ordered_json;

constexpr int warning_found = 5;
constexpr double seconds_of_day = 86'400.0;

// What people read a deviation in.
struct Unit {
  const char* name;
  double factor;
};

Unit unit_of(ControlQuantity quantity) {
  constexpr double degrees = 180.0 / std::numbers::pi;
  static constexpr Unit units[] = {{"%", 100.0}, {"deg", degrees}, {"%", 100.0}, {"us", 1e6}};
  return units[static_cast<std::size_t>(quantity)];
}

std::string quantity_text(ControlQuantity quantity) {
  return per_enumerator(quantity, {"|H|", "arg H", "|H| of all", "delay of all"});
}

std::string identifier_of(ControlQuantity quantity) {
  return per_enumerator(quantity, {"magnitude_rel", "phase_rad", "mean_magnitude_rel", "delay_s"});
}

bool is_of_magnitude(ControlQuantity quantity) {
  return quantity == ControlQuantity::magnitude || quantity == ControlQuantity::mean_magnitude;
}

std::string instant(const StoredRun& run) {
  return run.began_utc.size() < 19 ? std::string("-") : run.began_utc.substr(0, 19) + "Z";
}

std::string name_of_run(const StoredRun& run) {
  return RunIdentity::parse(run.run).name;
}

std::string label_of(const ControlLine& line) {
  return line.frequency_text_hz.empty() ? "all points"
                                        : place_text(line.point, {.levels = true, .axes = true});
}

// Of the newest result against the one before, what both have in common taken out.
std::optional<double> normalised_error(const CheckView& view, const ControlLine& line) {
  const auto of_point = std::ranges::find(view.history.lines, line.point, &HistoryLine::point);
  if (of_point == view.history.lines.end() ||
      of_point->values.back().calibration + 1 != view.chart.calibrations.size()) {
    return std::nullopt;
  }
  const HistoryValue& newest = of_point->values.back();
  return line.quantity == ControlQuantity::magnitude ? newest.en_magnitude
         : line.quantity == ControlQuantity::phase   ? newest.en_phase
                                                     : std::nullopt;
}

std::set<std::string> channels_of(const ControlChart& chart) {
  std::set<std::string> channels;
  for (const ControlLine& line : chart.lines) {
    channels.insert(line.point.channel);
  }
  return channels;
}

std::string line_text(const CheckView& view, const ControlLine& line) {
  const Unit unit = unit_of(line.quantity);
  const auto shown = [&](double value) { return fmt::format("{:.3g}", unit.factor * value); };
  const auto en = normalised_error(view, line);
  return fmt::format("{:<24} {:<13} {:>4} {:>9} {:>9} {:>9} {:>9} {:>6}  {}\n",
                     one_line(label_of(line)), quantity_text(line.quantity), unit.name,
                     shown(line.s), line.newest ? shown(line.newest->deviation) : "-",
                     shown(line.warning), shown(line.action), en ? fmt::format("{:.2f}", *en) : "-",
                     line.newest ? to_string(line.newest->state) : "not measured");
}

std::string head(const CheckView& view) {
  const ControlChart& chart = view.chart;
  std::string text =
      fmt::format("{} on bench {}: {} result{}", one_line(view.sensor), one_line(chart.bench),
                  chart.calibrations.size(), chart.calibrations.size() == 1 ? "" : "s");
  if (!chart.lines.empty()) {
    text += fmt::format(", limits from {} of {} to {}\nnewest: run {} of {}, deviations from the "
                        "mean of those; E_n "
                        "against the one before, without what both have in common",
                        chart.first.size(),
                        one_line(instant(chart.calibrations[chart.first.front()].run)),
                        one_line(instant(chart.calibrations[chart.first.back()].run)),
                        one_line(name_of_run(chart.calibrations.back().run)),
                        one_line(instant(chart.calibrations.back().run)));
  }
  return text + "\n";
}

double days_since_first(const ControlChart& chart, std::size_t calibration) {
  const auto days = [&](std::size_t place) {
    std::tm utc{};
    const std::string& began = chart.calibrations[place].run.began_utc;
    const char* rest = strptime(began.c_str(), "%Y-%m-%dT%H:%M:%S", &utc);
    return rest == nullptr ? 0.0 : static_cast<double>(timegm(&utc)) / seconds_of_day;
  };
  return days(calibration) - days(0);
}

views::figures::ControlTrace trace_of(const ControlChart& chart, const ControlLine& line) {
  views::figures::ControlTrace trace{.label = label_of(line),
                                     .quantity = identifier_of(line.quantity),
                                     .warning = line.warning,
                                     .action = line.action,
                                     .points = {}};
  for (const ControlValue& value : line.values) {
    const StoredRun& run = chart.calibrations[value.calibration].run;
    trace.points.push_back({.run = run.run,
                            .began_utc = run.began_utc,
                            .days = days_since_first(chart, value.calibration),
                            .deviation = value.deviation,
                            .state = to_string(value.state)});
  }
  return trace;
}

Json line_json(const CheckView& view, const ControlLine& line) {
  Json values = Json::array();
  for (const ControlValue& value : line.values) {
    const StoredRun& run = view.chart.calibrations[value.calibration].run;
    values.push_back({{"run", run.run},
                      {"began_utc", run.began_utc},
                      {"deviation", json_number(value.deviation)},
                      {"state", to_string(value.state)}});
  }
  const auto en = normalised_error(view, line);
  return {{"channel", line.point.channel},
          {"quantity", identifier_of(line.quantity)},
          {"frequency_text_hz", line.frequency_text_hz},
          {"frequency_hz", json_number(line.point.frequency_hz)},
          {"level_m_s2", json_number(line.point.level_m_s2)},
          {"excited_axis", line.point.axis},
          {"centre", json_number(line.centre)},
          {"s", json_number(line.s)},
          {"warning", json_number(line.warning)},
          {"action", json_number(line.action)},
          {"en", en ? json_number(*en) : Json(nullptr)},
          {"state", line.newest ? Json(to_string(line.newest->state)) : Json(nullptr)},
          {"values", std::move(values)}};
}

} // namespace

std::string check_table(const CheckView& view) {
  std::string text = head(view);
  for (const std::string& channel : channels_of(view.chart)) {
    text +=
        fmt::format("\n{}\n{:<24} {:<13} {:>4} {:>9} {:>9} {:>9} {:>9} {:>6}\n", one_line(channel),
                    "point", "", "", "s", "deviation", "warning", "action", "E_n");
    for (const bool is_whole : {true, false}) {
      for (const ControlLine& line : view.chart.lines) {
        if (line.point.channel == channel && line.frequency_text_hz.empty() == is_whole) {
          text += line_text(view, line);
        }
      }
    }
  }
  text += "\n";
  for (const std::string& note : view.chart.notes) {
    text += one_line(note) + "\n";
  }
  return text + fmt::format("the check: {}\n", to_string(view.chart.state));
}

Json check_json(const CheckView& view) {
  const ControlChart& chart = view.chart;
  Json json{{"sensor", view.sensor},   {"bench", chart.bench},   {"state", to_string(chart.state)},
            {"newest", Json(nullptr)}, {"first", Json::array()}, {"notes", chart.notes},
            {"lines", Json::array()}};
  if (!chart.calibrations.empty()) {
    const StoredRun& newest = chart.calibrations.back().run;
    json["newest"] = {{"run", newest.run},
                      {"began_utc", newest.began_utc},
                      {"software", newest.software},
                      {"folder", newest.folder}};
  }
  for (const std::size_t place : chart.first) {
    json["first"].push_back(chart.calibrations[place].run.run);
  }
  for (const ControlLine& line : chart.lines) {
    json["lines"].push_back(line_json(view, line));
  }
  return json;
}

Expected<std::vector<std::filesystem::path>> write_check(const CheckView& view,
                                                         const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const std::string& channel : channels_of(view.chart)) {
    views::figures::ControlData data{
        .title = fmt::format("Check of {} with {}, {}", view.chart.bench, view.sensor, channel),
        .subtitle = fmt::format("limits from the first {} results", view.chart.first.size())};
    for (const ControlLine& line : view.chart.lines) {
      if (line.point.channel == channel) {
        (is_of_magnitude(line.quantity) ? data.magnitudes : data.phases)
            .push_back(trace_of(view.chart, line));
      }
    }
    std::string name = "check-" + channel;
    std::ranges::replace(name, '/', '-');
    DYNCAL_TRY(auto written,
               views::figures::write(views::figures::control_figure(data, name), folder));
    std::ranges::move(written, std::back_inserter(paths));
  }
  return paths;
}

int exit_status_of(CheckState state) {
  return per_enumerator(state, {0, warning_found, problems_found, could_not_look});
}

} // namespace dyncal::inline programs
