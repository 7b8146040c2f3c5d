// `dyncal history SENSOR`: the drift of a sensor over its calibrations in the store
// (services/records/store/history.hpp), as tables, JSON and figures; --check: of a check sensor,
// whether its bench is in control (services/records/store/control_chart.hpp), with an exit status
// for each state. Belongs to one thread.
#include <cmath>
#include <ctime>
#include <filesystem>
#include <numbers>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/base/output_file.hpp"
#include "services/base/printable_text.hpp"
#include "services/base/rounding.hpp"
#include "services/contract/unit.hpp"
#include "services/programs/command/check_view.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/keep_options.hpp"
#include "services/programs/command/work_progress.hpp"
#include "services/records/store/history.hpp"
#include "services/views/figures/drift.hpp"

namespace dyncal::inline programs {
namespace {

struct HistoryOptions {
  StorePlace store;
  std::string sensor;
  HistoryFilter filter;
  std::optional<std::filesystem::path> figures;
  bool json = false;
  bool is_check = false;
  ControlOptions control;
  std::optional<double> limit_percent;
  std::optional<double> limit_deg;
};

constexpr double degrees = 180.0 / std::numbers::pi;

// Of --check alone.
void add_check(CLI::App& command, HistoryOptions& history) {
  CLI::Option* check = command.add_flag(
      "--check", history.is_check,
      "control chart of a check sensor: is its bench in control? Exit status: 0 in control, 5 "
      "warning, 3 action, 4 too few results");
  command
      .add_option("--first", history.control.first,
                  "how many complete results give the limits, and their mean the centre")
      ->check(CLI::Range(ControlOptions::least_first, std::size_t{1000}))
      ->capture_default_str()
      ->needs(check);
  command
      .add_option("--bench", history.control.bench,
                  "results of this bench (default: of the newest)")
      ->needs(check);
  command
      .add_option("--since", history.control.since_utc,
                  "begin with results of this day or instant, in UTC: after a service, say")
      ->needs(check);
  add_checked(command, "--limit-percent", history.limit_percent,
              "action limit of |H| at each point, in place of that by scatter", CLI::PositiveNumber)
      ->needs(check);
  add_checked(command, "--limit-deg", history.limit_deg, "the same of arg H, in degrees",
              CLI::PositiveNumber)
      ->needs(check);
}

void add_history(CLI::App& command, HistoryOptions& history) {
  command
      .add_option("SENSOR", history.sensor, "serial number, device or source, as 'runs' lists it")
      ->required();
  command.add_option("--channel", history.filter.channel, "only this channel (default: all)");
  add_checked(command, "--frequency", history.filter.frequency_hz, "only this frequency in Hz",
              CLI::PositiveNumber);
  command.add_option("--level", history.filter.level_m_s2, "only this planned level in m/s^2");
  command.add_option("--figures", history.figures, "write figures (SVG and CSV) into this folder");
  command.add_flag("--json", history.json, "print JSON");
  add_store_place(command, history.store);
  add_check(command, history);
}

using Json = nlohmann::ordered_json;

constexpr double seconds_of_day = 86'400.0;

std::string day_and_time(const Calibration& calibration) {
  const std::string& began = calibration.run.began_utc;
  return began.empty() ? "-" : began.substr(0, 19) + "Z";
}

// Since 1970; 0 where it is not known.
double days_of(const Calibration& calibration) {
  std::tm utc{};
  const char* rest = strptime(calibration.run.began_utc.c_str(), "%Y-%m-%dT%H:%M:%S", &utc);
  return rest == nullptr ? 0.0 : static_cast<double>(timegm(&utc)) / seconds_of_day;
}

Json number_or_null(std::optional<double> value) {
  return value && std::isfinite(*value) ? Json(*value) : Json(nullptr);
}

Json value_json(const HistoryValue& value) {
  const StoredValue& point = value.point;
  return {{"calibration", value.calibration},
          {"unit", point.unit},
          {"level_m_s2", number_or_null(point.level_m_s2)},
          {"magnitude", point.magnitude},
          {"U_magnitude", point.of_magnitude.expanded},
          {"phase_rad", point.phase_rad},
          {"U_phase_rad", point.of_phase.expanded},
          {"deviation_magnitude_rel", value.deviation_magnitude_rel},
          {"deviation_phase_rad", value.deviation_phase_rad},
          {"en_magnitude", number_or_null(value.en_magnitude)},
          {"en_phase", number_or_null(value.en_phase)},
          {"agrees", value.agrees()},
          {"flag_names", point.flag_names}};
}

void print_json(const History& history) {
  Json json{{"sensor", history.sensor}, {"calibrations", Json::array()}, {"lines", Json::array()}};
  for (const Calibration& calibration : history.calibrations) {
    const StoredRun& run = calibration.run;
    Json open = Json::array();
    for (const OpenClosure& closure : calibration.open_closures) {
      open.push_back(closure.sentence);
    }
    json["calibrations"].push_back(
        {{"bench", run.bench},
         {"run", run.run},
         {"state", run.state},
         {"began_utc", run.began_utc.empty() ? Json(nullptr) : Json(run.began_utc)},
         {"source", calibration.source},
         {"software", run.software},
         {"recipe_sha256", run.recipe_sha256},
         {"result_sha256", run.result_sha256},
         {"folder", run.folder},
         {"amendments", run.amendments},
         {"open_closures", std::move(open)}});
  }
  for (const HistoryLine& line : history.lines) {
    Json values = Json::array();
    for (const HistoryValue& value : line.values) {
      values.push_back(value_json(value));
    }
    const PointIdentity& point = line.point;
    json["lines"].push_back(
        {{"channel", point.channel},
         {"frequency_text_hz", line.frequency_text_hz},
         {"frequency_hz", point.frequency_hz},
         {"level_m_s2", number_or_null(point.level_m_s2)},
         {"excited_axis", point.axis.empty() ? Json(nullptr) : Json(point.axis)},
         {"values", std::move(values)}});
  }
  fmt::print("{}\n", json_text(json, 2));
}

std::string en_text(std::optional<double> en) {
  return en ? fmt::format("{:.2f}", *en) : std::string("-");
}

void print_line(const HistoryLine& line, const History& history) {
  const std::string unit = short_form(line.values.back().point.unit);
  fmt::print("\n{}, magnitude in {}\n", one_line(to_string(line.point, history.differences())),
             unit.empty() ? "a unit that is not known" : one_line(unit));
  fmt::print("{:<20} {:<12} {:>13} {:>10} {:>10} {:>7} {:>11} {:>9} {:>9} {:>7}\n", "begin (UTC)",
             "state", "|H|", "U", "d|H| / %", "E_n", "arg H / deg", "U / deg", "d / deg", "E_n");
  for (const HistoryValue& value : line.values) {
    const Calibration& calibration = history.calibrations[value.calibration];
    const StoredValue& point = value.point;
    const RoundedValue phase = round_phase(point.phase_rad, point.of_phase.expanded).degrees;
    fmt::print("{:<20} {:<12} {:>13.6g} {:>10.2g} {:>10.3f} {:>7} {:>11} {:>9} {:>9.4f} "
               "{:>7}{}{}\n",
               one_line(day_and_time(calibration)), one_line(calibration.run.state),
               point.magnitude, point.of_magnitude.expanded, 100.0 * value.deviation_magnitude_rel,
               en_text(value.en_magnitude), phase.value, phase.u,
               degrees * value.deviation_phase_rad, en_text(value.en_phase),
               value.agrees() ? "" : "  disagrees with the one before",
               point.flag_names.empty()
                   ? ""
                   : "  " + one_line(fmt::format("{}", fmt::join(point.flag_names, ","))));
  }
}

void print_open_closures(const History& history) {
  for (const Calibration& calibration : history.calibrations) {
    for (const OpenClosure& closure : calibration.open_closures) {
      fmt::print("open closure of the calibration of {}: {}\n", one_line(day_and_time(calibration)),
                 one_line(closure.sentence));
    }
  }
}

void print_tables(const History& history) {
  fmt::print("{}: {} calibrations, deviations from the first, E_n against the one before without "
             "what both have in common, each U at its own k\n",
             one_line(history.sensor), history.calibrations.size());
  std::size_t compared = 0;
  std::size_t agreeing = 0;
  for (const HistoryLine& line : history.lines) {
    print_line(line, history);
    for (const HistoryValue& value : line.values) {
      compared += value.en_magnitude ? 1 : 0;
      agreeing += value.en_magnitude && value.agrees() ? 1 : 0;
    }
  }
  fmt::print("\n{} of {} values agree with the calibration before (|E_n| <= 1 in magnitude and "
             "phase)\n",
             agreeing, compared);
  print_open_closures(history);
  for (const Calibration& calibration : history.calibrations) {
    for (const std::string& sentence : calibration.run.amendments) {
      fmt::print("calibration of {}: {}\n", one_line(day_and_time(calibration)),
                 one_line(sentence));
    }
  }
}

figures::DriftData drift_of(const std::string& channel, const History& history) {
  figures::DriftData data;
  data.title = fmt::format("Drift of {}, {}", history.sensor, channel);
  const double first_day = days_of(history.calibrations.front());
  data.subtitle = fmt::format("{} calibrations, the first on {}", history.calibrations.size(),
                              day_and_time(history.calibrations.front()));
  for (const HistoryLine& line : history.lines) {
    if (line.point.channel != channel) {
      continue;
    }
    figures::DriftLine& drawn = data.lines.emplace_back();
    drawn.label = place_text(line.point, history.differences());
    drawn.frequency_hz = line.point.frequency_hz;
    drawn.level_m_s2 = line.point.level_m_s2;
    drawn.excited_axis = line.point.axis;
    data.unit = short_form(line.values.back().point.unit);
    for (const HistoryValue& value : line.values) {
      const Calibration& calibration = history.calibrations[value.calibration];
      drawn.values.push_back({.run = calibration.run.run,
                              .began_utc = calibration.run.began_utc,
                              .days = days_of(calibration) - first_day,
                              .magnitude = value.point.magnitude,
                              .expanded_magnitude = value.point.of_magnitude.expanded,
                              .deviation_magnitude_rel = value.deviation_magnitude_rel,
                              .phase_rad = value.point.phase_rad,
                              .expanded_phase_rad = value.point.of_phase.expanded,
                              .deviation_phase_rad = value.deviation_phase_rad});
    }
  }
  return data;
}

Expected<void> write_drift(const History& history, const std::filesystem::path& folder) {
  std::string channel;
  for (const HistoryLine& line : history.lines) {
    if (line.point.channel == channel) {
      continue;
    }
    channel = line.point.channel;
    std::string name = "drift-" + channel;
    for (char& c : name) {
      c = c == '/' ? '-' : c;
    }
    DYNCAL_TRY(const auto written,
               figures::write(figures::drift_figure(drift_of(channel, history), name), folder));
    for (const std::filesystem::path& path : written) {
      fmt::print(stderr, "wrote {}\n", path.string());
    }
  }
  return {};
}

Expected<std::vector<Calibration>> look_up(const HistoryOptions& command,
                                           const SharedWorkCount& count) {
  DYNCAL_TRY(auto store, Store::open_existing(command.store.text()));
  DYNCAL_TRY(auto calibrations, store->calibrations(command.sensor, count));
  DYNCAL_TRY(store->add_common_parts(calibrations, count));
  for (Calibration& calibration : calibrations) {
    keep_wanted(calibration, command.filter);
  }
  return calibrations;
}

Expected<int> run_check(const HistoryOptions& command, std::vector<Calibration> calibrations) {
  ControlOptions options = command.control;
  if (command.limit_percent) {
    options.limit_magnitude_rel = *command.limit_percent / 100.0;
  }
  if (command.limit_deg) {
    options.limit_phase_rad = *command.limit_deg / degrees;
  }
  CheckView view{.sensor = command.sensor,
                 .chart = control_chart_of(std::move(calibrations), options),
                 .history = {}};
  view.history = history_of(command.sensor, view.chart.calibrations);
  if (command.figures) {
    DYNCAL_TRY(const auto written, write_check(view, *command.figures));
    for (const std::filesystem::path& path : written) {
      fmt::print(stderr, "wrote {}\n", path.string());
    }
  }
  fmt::print("{}", command.json ? json_text(check_json(view), 2) + "\n" : check_table(view));
  return exit_status_of(view.chart.state);
}

Expected<int> run_history(const HistoryOptions& command) {
  DYNCAL_TRY(auto calibrations, with_progress("opening the store", [&](const auto& count) {
               return look_up(command, count);
             }));
  if (command.is_check) {
    return run_check(command, std::move(calibrations));
  }
  const History history = history_of(command.sensor, std::move(calibrations));
  if (history.lines.empty()) {
    return fail(ErrorCode::no_result,
                fmt::format("the store has no calibration of sensor '{}' with a value{}; 'dyncal "
                            "runs' lists serial numbers and sources",
                            command.sensor,
                            command.filter.channel.empty() && !command.filter.frequency_hz &&
                                    !command.filter.level_m_s2
                                ? ""
                                : " at this channel, frequency and level"));
  }
  if (command.figures) {
    DYNCAL_TRY(write_drift(history, *command.figures));
  }
  command.json ? print_json(history) : print_tables(history);
  return 0;
}

const Command history_command{
    100, "history",
    "drift of a sensor over its calibrations, with U and E_n against the one before", add_history,
    run_history};

} // namespace
} // namespace dyncal::inline programs
