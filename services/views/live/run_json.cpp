#include "services/views/live/run_json.hpp"

#include <nlohmann/json.hpp>

#include "services/views/report/json_members.hpp"
#include "services/views/report/result_json.hpp"
#include "services/views/report/rounded_json.hpp"
#include "services/views/report/stated_value.hpp"
#include "services/views/report/stored_members.hpp"

namespace dyncal::inline views::live {
namespace {

using Json = nlohmann::ordered_json;

RunOutcome outcome_of(const std::string& bench, const network::Run& run) {
  RunOutcome outcome;
  outcome.bench = bench;
  outcome.run = run.name;
  for (const auto& [key, result] : run.results) {
    outcome.results.push_back(result);
    outcome.results.back().fits.clear();
    outcome.results.back().samples.clear();
  }
  for (const auto& [channel, function] : run.transfer_functions) {
    outcome.transfer_functions.push_back(function);
  }
  for (const auto& [source, report] : run.clock_reports) {
    outcome.clock_reports.push_back(report);
  }
  return outcome;
}

Json points_json(const network::Run& run, const StoredResult& result) {
  Json points = Json::array();
  auto heard = run.results.begin(); // in the same order
  for (const StoredPoint& point : result.points) {
    points.push_back(JsonWriter::of(point));
    points.back().erase("budget"); // U is of it; the page does not show it
    points.back()["attempt"] = point.attempt;
    points.back()["provisional"] = (heard++)->second.provisional;
    points.back()["text"] =
        rounded_json(point.magnitude, point.u_magnitude, point.phase_rad, point.u_phase_rad);
  }
  return points;
}

// Rounded by U, as documents state them.
Json values_json(const StoredResult& result) {
  Json values = Json::array();
  for (const StoredValue& value : result.values) {
    values.push_back(JsonWriter::of(value));
    values.back()["text"] = rounded_json(value.magnitude, value.of_magnitude.expanded,
                                         value.phase_rad, value.of_phase.expanded);
  }
  return values;
}

Json channels_json(const StoredResult& result) {
  Json channels = Json::array();
  for (const StoredChannel& channel : result.channels) {
    channels.push_back(JsonWriter::of(channel));
    for (std::size_t i = 0; i < channel.closures.size(); ++i) {
      channels.back()["closures"][i]["title"] = title_of(channel.closures[i].kind);
    }
    channels.back()["advice"] = advice_on_repetitions(result.values_of(channel.channel));
    if (const analysis::GroupDelay* delay = result.group_delay_of(channel.channel)) {
      analysis::CombinedUncertainty of_delay_ms = delay->of_delay;
      of_delay_ms.u *= 1e3;
      channels.back()["text"] = {
          {"group_delay_ms", rounded_json(1e3 * delay->delay_s, of_delay_ms)}};
    }
  }
  return channels;
}

Json clocks_json(const StoredResult& result) {
  Json clocks = Json::array();
  for (const ClockReport& report : result.clocks) {
    clocks.push_back(JsonWriter::of(report));
    analysis::CombinedUncertainty of_interval_us = report.clock.of_mean_interval();
    of_interval_us.u *= 1e6;
    clocks.back()["text"] = {
        {"mean_interval_us", rounded_json(1e6 * report.clock.mean_interval_s, of_interval_us)}};
  }
  return clocks;
}

} // namespace

Json run_json(const std::string& bench, const network::Run& run) {
  const StoredResult result = stored_result_of(outcome_of(bench, run));
  return {{"run", run.name},
          {"state", to_string(run.state())},
          {"flag_legend", JsonWriter::of(result.flags)},
          {"points", points_json(run, result)},
          {"channels", channels_json(result)},
          {"transfer_function", values_json(result)},
          {"group_delay", JsonWriter::of(result.group_delays)},
          {"sample_clock", clocks_json(result)}};
}

} // namespace dyncal::inline views::live
