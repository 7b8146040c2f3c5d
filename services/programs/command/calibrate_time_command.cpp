// `dyncal calibrate time`: how far a DAU's time stamps are from a reference pulse per second (paper
// section 2.2, figure 2; the model is that of analysis/instrument/stamp_deviation.hpp), from the
// unit's own record of both pulses (services/programs/command/pulse_file.hpp).
//
// Prints which edges were rejected and why, and the deviation; writes OUTPUT.json and beside it
// OUTPUT.svg and OUTPUT.csv. A record of the GPS pulse alone has no deviation: it is judged by how
// well its pulses can be foretold from the ones before, and the status is that of success. Belongs
// to one thread.
#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "analysis/instrument/pulse_edges.hpp"
#include "analysis/instrument/stamp_deviation.hpp"
#include "services/base/json_text.hpp"
#include "services/base/output_file.hpp"
#include "services/programs/command/command.hpp"
#include "services/programs/command/pulse_file.hpp"
#include "services/views/figures/stamp_deviation.hpp"

namespace dyncal::inline programs {
namespace {

struct CalibrateTimeOptions {
  std::vector<std::filesystem::path> files;
  std::filesystem::path output = "time-calibration.json";
  std::optional<double>
      reference_offset_s; // of the reference pulse after the GPS second, at the unit
  double u_reference_s = 0.0;
};

void add_time(CLI::App& command, CalibrateTimeOptions& time) {
  command
      .add_option(
          "FILE", time.files,
          "records of pulse edges, lines of GPST;n;ticks and REFT;n;ticks; several are one record")
      ->required();
  command.add_option("--reference-offset", time.reference_offset_s,
                     "seconds by which the reference pulse comes after the second of GPS, if that "
                     "is known: gives the mean a meaning");
  add_default(command, "--reference-uncertainty", time.u_reference_s,
              "standard uncertainty of the reference pulse, in seconds", CLI::NonNegativeNumber);
  add_default(command, "--output", time.output,
              "file for the result as JSON; a figure (SVG and CSV) comes beside it");
}

using analysis::PulseFault;
using analysis::PulseInput;
using Json = nlohmann::ordered_json;

constexpr std::size_t events_shown = 20;

struct EvaluatedPulses {
  PulseRecord record;
  analysis::SortedPulses pulses;
  std::optional<analysis::PulsePrediction> prediction;
  std::optional<analysis::StampDeviationStatistics> deviation;
};

const char* name_of(PulseInput input) {
  return input == PulseInput::gps ? "GPS" : "reference";
}

const char* name_of(PulseFault fault) { // in the order of the enumeration
  constexpr std::array names{"extra edge", "missing edges", "duplicate", "pulses moved",
                             "session restart"};
  return names.at(static_cast<std::size_t>(fault));
}

std::size_t seconds_of(const analysis::SortedPulses& pulses, PulseInput input) {
  std::size_t total = 0;
  for (const analysis::PulseSession& session : pulses.sessions) {
    total += (input == PulseInput::gps ? session.gps : session.reference).size();
  }
  return total;
}

bool has_reference(const PulseRecord& record) {
  return std::any_of(record.edges.begin(), record.edges.end(),
                     [](const auto& edge) { return edge.input == PulseInput::reference; });
}

Expected<EvaluatedPulses> judge(const CalibrateTimeOptions& command) {
  DYNCAL_TRY(auto record, read_pulse_files(command.files));
  const auto failure = [&](const analysis::Error& error) {
    return fail(ErrorCode::no_result,
                fmt::format("{}: {}", command.files.front().string(), error.message));
  };
  auto pulses = analysis::sort_pulse_edges(record.edges);
  if (!pulses) {
    return failure(pulses.error());
  }
  EvaluatedPulses evaluated{std::move(record), std::move(*pulses), {}, {}};
  evaluated.prediction = analysis::predict_gps_pulses(evaluated.pulses);
  if (has_reference(evaluated.record)) {
    auto deviation = analysis::stamp_deviations(
        evaluated.pulses,
        {.reference_offset_s = command.reference_offset_s, .u_reference_s = command.u_reference_s});
    if (!deviation) {
      return failure(deviation.error());
    }
    evaluated.deviation = std::move(*deviation);
  }
  if (!evaluated.deviation && !evaluated.prediction) {
    return fail(ErrorCode::no_result, fmt::format("{}: too few consecutive pulses to evaluate",
                                                  command.files.front().string()));
  }
  return evaluated;
}

void print_edges(const EvaluatedPulses& evaluated) {
  const analysis::SortedPulses& pulses = evaluated.pulses;
  fmt::print("{} edges in {} session{}\n", evaluated.record.edges.size(), pulses.sessions.size(),
             pulses.sessions.size() == 1 ? "" : "s");
  fmt::print("{:<10} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "pulse", "seconds", "extra", "missing",
             "repeated", "moved");
  for (const PulseInput input : {PulseInput::gps, PulseInput::reference}) {
    if (input == PulseInput::reference && !has_reference(evaluated.record)) {
      continue;
    }
    fmt::print("{:<10} {:>9} {:>9} {:>9} {:>9} {:>9}\n", name_of(input), seconds_of(pulses, input),
               pulses.count(PulseFault::extra, input), pulses.count(PulseFault::missing, input),
               pulses.count(PulseFault::duplicate, input),
               pulses.count(PulseFault::pulse_step, input));
  }
  std::size_t shown = 0;
  for (const analysis::PulseEvent& event : pulses.events) {
    if (++shown > events_shown) {
      break;
    }
    fmt::print("  {}, {}: {}{}: {}\n", evaluated.record.place(event.edge), name_of(event.input),
               name_of(event.fault),
               event.fault == PulseFault::missing ? fmt::format(" ({})", event.missing) : "",
               event.reason);
  }
  if (pulses.events.size() > events_shown) {
    fmt::print("  and {} more, all in the JSON file\n", pulses.events.size() - events_shown);
  }
}

void print_prediction(const analysis::PulsePrediction& prediction) {
  fmt::print("counter {:.2f} ticks per second of GPS, sd {:.2f} ticks\n",
             prediction.ticks_per_second, prediction.sd_ticks);
  fmt::print("GPS pulse against its prediction from the pulses before: {} seconds, sd {:.1f} ns, "
             "{:+.1f} to {:+.1f} ns\n",
             prediction.count, 1e9 * prediction.sd_s, 1e9 * prediction.minimum_s,
             1e9 * prediction.maximum_s);
}

void print_deviation(const CalibrateTimeOptions& command,
                     const analysis::StampDeviationStatistics& deviation) {
  fmt::print("deviation of the stamps from the reference pulse: {} seconds ({} before the unit's "
             "clock could be trusted)\n",
             deviation.deviations.size(), deviation.untrusted);
  if (command.reference_offset_s) {
    fmt::print("  mean           {:+10.2f} ns   u {:.2f} ns\n", 1e9 * deviation.mean_s,
               1e9 * deviation.u_mean_s);
  } else {
    fmt::print("  mean            not known: the reference pulse comes {:.9f} s after the second "
               "of GPS, which is taken as its delay\n",
               deviation.reference_offset_s);
  }
  fmt::print("  sd             {:10.2f} ns   u {:.2f} ns (its values are correlated: worth {:.0f} "
             "independent ones)\n",
             1e9 * deviation.sd_s, 1e9 * deviation.u_sd_s, deviation.effective_count);
  fmt::print("  95 % within    {:+10.2f} ns to {:+.2f} ns\n", 1e9 * deviation.quantile_025_s,
             1e9 * deviation.quantile_975_s);
  fmt::print("  all within     {:+10.2f} ns to {:+.2f} ns, spread {:.2f} ns\n",
             1e9 * deviation.minimum_s, 1e9 * deviation.maximum_s,
             1e9 * (deviation.maximum_s - deviation.minimum_s));
  fmt::print("  drift          {:+10.2e} s/s  u {:.1e} s/s\n", deviation.drift, deviation.u_drift);
  for (const analysis::AllanPoint& point : deviation.allan) {
    fmt::print("  Allan deviation {:9.3g} s   {:.2e}\n", point.tau_s, point.deviation);
  }
  fmt::print("standard uncertainty of a stamp, mean corrected: {:.1f} ns\n",
             1e9 * deviation.u_stamp_s);
}

Json events_json(const EvaluatedPulses& evaluated) {
  Json events = Json::array();
  for (const analysis::PulseEvent& event : evaluated.pulses.events) {
    events.push_back({{"place", evaluated.record.place(event.edge)},
                      {"pulse", name_of(event.input)},
                      {"what", name_of(event.fault)},
                      {"missing", event.missing},
                      {"reason", event.reason}});
  }
  return events;
}

Json counts_json(const analysis::SortedPulses& pulses, PulseInput input) {
  return {{"seconds", seconds_of(pulses, input)},
          {"extra", pulses.count(PulseFault::extra, input)},
          {"missing", pulses.count(PulseFault::missing, input)},
          {"duplicates", pulses.count(PulseFault::duplicate, input)},
          {"moved", pulses.count(PulseFault::pulse_step, input)}};
}

Json deviation_json(const CalibrateTimeOptions& command,
                    const analysis::StampDeviationStatistics& deviation) {
  Json allan = Json::array();
  for (const analysis::AllanPoint& point : deviation.allan) {
    allan.push_back({{"tau_s", point.tau_s}, {"deviation", point.deviation}});
  }
  Json json{{"count", deviation.deviations.size()},
            {"untrusted", deviation.untrusted},
            {"reference_offset_s", deviation.reference_offset_s},
            {"reference_offset_is",
             command.reference_offset_s ? "given" : "the mean, so that the deviation has none"},
            {"u_reference_s", command.u_reference_s}};
  if (command.reference_offset_s) {
    json["mean_s"] = deviation.mean_s;
  }
  json.update(
      {{"u_mean_s", deviation.u_mean_s},
       {"sd_s", deviation.sd_s},
       {"u_sd_s", deviation.u_sd_s},
       {"independent_count", deviation.effective_count},
       {"min_s", deviation.minimum_s},
       {"max_s", deviation.maximum_s},
       {"spread_s", deviation.maximum_s - deviation.minimum_s},
       {"quantiles_s", {{"0.025", deviation.quantile_025_s}, {"0.975", deviation.quantile_975_s}}},
       {"drift", deviation.drift},
       {"u_drift", deviation.u_drift},
       {"u_stamp_s", deviation.u_stamp_s},
       {"allan", allan}});
  return json;
}

Json result_json(const CalibrateTimeOptions& command, const EvaluatedPulses& evaluated) {
  Json json{{"files", std::vector<std::string>(command.files.begin(), command.files.end())},
            {"sign", "positive: the stamp is later than the reference pulse"},
            {"sessions", evaluated.pulses.sessions.size()},
            {"gps", counts_json(evaluated.pulses, PulseInput::gps)},
            {"reference", counts_json(evaluated.pulses, PulseInput::reference)},
            {"events", events_json(evaluated)}};
  if (evaluated.prediction) {
    const analysis::PulsePrediction& prediction = *evaluated.prediction;
    json["gps_prediction"] = {{"count", prediction.count},
                              {"sd_s", prediction.sd_s},
                              {"min_s", prediction.minimum_s},
                              {"max_s", prediction.maximum_s},
                              {"ticks_per_second", prediction.ticks_per_second},
                              {"sd_ticks", prediction.sd_ticks}};
  }
  if (evaluated.deviation) {
    json["deviation"] = deviation_json(command, *evaluated.deviation);
  }
  return json;
}

figures::Figure figure_of(const CalibrateTimeOptions& command, const EvaluatedPulses& evaluated) {
  const analysis::StampDeviationStatistics& deviation = *evaluated.deviation;
  figures::StampDeviationData data;
  data.title = "Deviation of the time stamps from the reference pulse";
  data.subtitle = fmt::format(
      "{} seconds, sd {:.1f} ns, 95 % within {:+.1f} to {:+.1f} ns{}", deviation.deviations.size(),
      1e9 * deviation.sd_s, 1e9 * deviation.quantile_025_s, 1e9 * deviation.quantile_975_s,
      command.reference_offset_s ? "" : "; the mean is not known and was removed");
  data.comments = {fmt::format("reference pulse {} s after the second of GPS, {}",
                               deviation.reference_offset_s,
                               command.reference_offset_s ? "given" : "the mean of the record"),
                   "positive: the stamp is later than the reference pulse"};
  data.tick_s = 1.0 / evaluated.pulses.ticks_per_second;
  data.deviations = deviation.deviations;
  data.allan = deviation.allan;
  return stamp_deviation_figure(data, command.output.stem().string());
}

Expected<void> write(const CalibrateTimeOptions& command, const EvaluatedPulses& evaluated) {
  DYNCAL_TRY(
      write_output_file(command.output, json_text(result_json(command, evaluated), 1) + '\n'));
  fmt::print("wrote {}\n", command.output.string());
  if (!evaluated.deviation) {
    return {};
  }
  const std::filesystem::path folder =
      command.output.has_parent_path() ? command.output.parent_path() : ".";
  DYNCAL_TRY(const auto written, figures::write(figure_of(command, evaluated), folder));
  for (const std::filesystem::path& path : written) {
    fmt::print("wrote {}\n", path.string());
  }
  return {};
}

Expected<void> run_calibrate_time(const CalibrateTimeOptions& command) {
  DYNCAL_TRY(const auto evaluated, judge(command));
  print_edges(evaluated);
  if (evaluated.prediction) {
    print_prediction(*evaluated.prediction);
  }
  if (evaluated.deviation) {
    print_deviation(command, *evaluated.deviation);
  } else {
    fmt::print("no edges of a reference pulse (REFT;n;ticks): the deviation of the stamps cannot "
               "be determined from this record\n");
  }
  return write(command, evaluated);
}

const Command calibrate_time_command{
    290, "calibrate time", "deviation of a DAU's time stamps from a reference pulse per second",
    add_time, run_calibrate_time};

} // namespace
} // namespace dyncal::inline programs
