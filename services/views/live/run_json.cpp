#include "services/views/live/run_json.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

#include "services/contract/channel_name.hpp"
#include "services/contract/excitation_quantity.hpp"
#include "services/contract/unit.hpp"
#include "services/views/report/json_members.hpp"
#include "services/views/report/result_json.hpp"
#include "services/views/report/rounded_json.hpp"
#include "services/views/report/stated_value.hpp"
#include "services/views/report/stored_members.hpp"

namespace dyncal::inline views::live {
namespace {

using Json = nlohmann::ordered_json;

RunOutcome outcome_of(const network::Bench& bench, const network::Run& run) {
  RunOutcome outcome;
  outcome.bench = bench.name;
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

// Of the plan, where it measures in m/s^2, as levels are stated.
std::optional<std::string> reference_of(const network::Bench& bench, const network::Run& run) {
  const auto name = parse_channel_name(run.plan ? run.plan->reference : "");
  const auto source = name ? bench.sources.find(name->source) : bench.sources.end();
  if (source == bench.sources.end() || !source->second.description) {
    return std::nullopt;
  }
  return is_acceleration(excitation_unit(*source->second.description, name->channel))
             ? std::optional(run.plan->reference)
             : std::nullopt;
}

void add_measured_levels(const network::Run& run, const std::string& reference,
                         StoredResult& result) {
  auto point = result.points.begin(); // in the same order
  for (const auto& [key, heard] : run.results) {
    const auto fit = std::ranges::find(heard.fits, reference, &analysis::ChannelFit::channel);
    if (fit != heard.fits.end()) {
      point->measured_level_m_s2 = fit->fit.amplitude();
      point->u_measured_level_m_s2 = fit->fit.u_amplitude();
    }
    ++point;
  }
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
    if (const double level = measured_level_m_s2(result, value); std::isfinite(level)) {
      values.back()["measured_level_m_s2"] = level;
    }
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

StoredResult heard_result(const network::Bench& bench, const network::Run& run) {
  StoredResult result = stored_result_of(outcome_of(bench, run));
  if (const auto reference = reference_of(bench, run)) {
    add_measured_levels(run, *reference, result);
  }
  return result;
}

Json run_json(const network::Bench& bench, const network::Run& run) {
  const StoredResult result = heard_result(bench, run);
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
