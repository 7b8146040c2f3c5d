#include "services/views/report/result_json.hpp"

#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/base/output_file.hpp"
#include "services/base/version.hpp"
#include "services/views/report/flag_legend.hpp"
#include "services/views/report/json_members.hpp"
#include "services/views/report/result_table.hpp"
#include "services/views/report/stored_members.hpp"
#include "services/views/report/stored_setup.hpp"

namespace dyncal::inline views {
namespace {

StoredPoint stored_point(const RunOutcome& outcome, const StepResult& result) {
  StoredPoint point;
  static_cast<StepResult&>(point) = result;
  point.sentences = sentences_of(result.flags);
  point.flag_names = names_of(result.flags);
  if (!result.valid) {
    return point;
  }
  point.of_magnitude = magnitude_uncertainty(result);
  point.of_phase = phase_uncertainty(result);
  add_measured_excitation(outcome, point);
  for (const analysis::ChannelFit& fit : result.fits) {
    if (fit.channel == result.channel) {
      point.own_fit = stored_fit(outcome, fit);
    }
  }
  return point;
}

StoredValue stored_value(const RunOutcome& outcome, const TransferFunction& function,
                         const FrequencyPoint& point) {
  std::vector<Flag> flags = flags_of(outcome, function.channel, point);
  flags.insert(flags.end(), function.flags.begin(), function.flags.end());
  flags = flags_once(flags);
  StoredValue value = value_of(function, point);
  value.flags = sentences_of(flags);
  value.flag_names = names_of(flags);
  return value;
}

void add_function(const RunOutcome& outcome, const TransferFunction& function,
                  StoredResult& result) {
  result.channels.push_back(
      {function.channel, function.unit, responds(function), function.lost,
       sentences_of(function.flags), names_of(function.flags),
       function.group_delay ? std::nullopt : std::optional(function.group_delay_problem),
       function.closures});
  for (const FrequencyPoint& point : function.points) {
    result.values.push_back(stored_value(outcome, function, point));
  }
  if (function.group_delay) {
    result.group_delays.push_back({function.channel, *function.group_delay});
  }
}

void add_plan(const RunOutcome& outcome, StoredResult& result) {
  if (outcome.recipe) {
    result.roles = stored_roles(*outcome.recipe);
    result.corrections = stored_corrections(*outcome.recipe, outcome.adc_file);
    result.steps = stored_steps(outcome);
    result.recipe = outcome.recipe->text;
  }
}

} // namespace

StoredValue value_of(const TransferFunction& function, const FrequencyPoint& point) {
  return {.channel = function.channel,
          .unit = function.unit,
          .frequency_text_hz = point.frequency_text_hz,
          .frequency_hz = point.frequency_hz,
          .level_m_s2 = point.level_m_s2,
          .excited_axis = function.excited_axis,
          .magnitude = point.mean.magnitude,
          .of_magnitude = magnitude_uncertainty(point.mean),
          .phase_rad = point.mean.phase_rad,
          .of_phase = phase_uncertainty(point.mean),
          .unwrapped_phase_rad = point.unwrapped_phase_rad,
          .scatter_magnitude = point.mean.scatter_magnitude,
          .scatter_phase_rad = point.mean.scatter_phase_rad,
          .repetitions = static_cast<unsigned>(point.mean.repetitions),
          .coverage_probability = analysis::two_sigma_probability,
          .u_independent_phase_rad = point.mean.u_independent_phase_rad,
          .flags = {},
          .flag_names = {}};
}

StoredResult stored_result_of(const RunOutcome& outcome) {
  StoredResult result;
  result.bench = outcome.bench;
  result.run = outcome.run;
  result.method = to_string(outcome.method);
  result.software = software_version();
  result.analysis_software = outcome.analysis_software;
  result.analysis_host = outcome.analysis_host;
  result.analysis_dds = outcome.analysis_dds;
  result.began_utc = utc_text(outcome.began_utc_ns);
  result.ended_utc = utc_text(outcome.ended_utc_ns);
  result.planned_steps = static_cast<unsigned>(outcome.planned_steps);
  result.interrupted = outcome.interrupted;
  result.problem = outcome.problem;
  result.recipe_sha256 = outcome.recipe_sha256;
  result.flags = flag_legend(flags_of(outcome));
  result.sources = outcome.sources;
  result.pauses = outcome.pauses;
  result.clocks = outcome.clock_reports;
  add_plan(outcome, result);
  for (const StepResult& one : outcome.results) {
    result.points.push_back(stored_point(outcome, one));
  }
  for (const TransferFunction& function : outcome.transfer_functions) {
    add_function(outcome, function, result);
  }
  return result;
}

nlohmann::ordered_json result_json(const StoredResult& result) {
  nlohmann::ordered_json json{
      {"schema", {{"name", "dyncal-result"}, {"version", result_schema_version}}}};
  JsonWriter writer(json);
  members(writer, result);
  return json;
}

nlohmann::ordered_json result_json(const RunOutcome& outcome, const RunStatements& stated) {
  StoredResult result = stored_result_of(outcome);
  static_cast<RunStatements&>(result) = stated;
  return result_json(result);
}

Expected<void> write_json(const std::filesystem::path& path, const nlohmann::ordered_json& json) {
  return write_output_file(path, json_text(json, 1) + '\n');
}

} // namespace dyncal::inline views
