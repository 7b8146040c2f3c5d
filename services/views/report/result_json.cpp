#include "services/views/report/result_json.hpp"

#include <array>
#include <cmath>
#include <ctime>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "services/base/json_text.hpp"
#include "services/base/output_file.hpp"
#include "services/base/version.hpp"
#include "services/views/report/clock_json.hpp"
#include "services/views/report/expanded_uncertainty.hpp"
#include "services/views/report/flag_legend.hpp"
#include "services/views/report/json_number.hpp"
#include "services/views/report/result_table.hpp"
#include "services/views/report/run_setup_json.hpp"
#include "services/views/report/step_json.hpp"

namespace dyncal::services {
namespace {

using Json = nlohmann::ordered_json;

// "2026-03-01T12:00:00.123456789Z"
Json utc_text(std::int64_t utc_ns) {
  if (utc_ns == 0) {
    return nullptr;
  }
  constexpr std::int64_t second_ns = 1'000'000'000;
  const std::int64_t fraction_ns = ((utc_ns % second_ns) + second_ns) % second_ns;
  const std::time_t seconds = (utc_ns - fraction_ns) / second_ns;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &utc);
  return fmt::format("{}.{:09}Z", text.data(), fraction_ns);
}

Json monte_carlo_json(const analysis::TransferCheck& drawn) {
  const auto interval = [](const analysis::MonteCarloResult& result) -> Json {
    return {json_number(result.low), json_number(result.high)};
  };
  return {{"trials", drawn.magnitude.trials},
          {"stable", drawn.magnitude.stable && drawn.phase_rad.stable},
          {"u_magnitude", json_number(drawn.magnitude.u)},
          {"magnitude_interval", interval(drawn.magnitude)},
          {"u_phase_rad", json_number(drawn.phase_rad.u)},
          {"phase_interval_rad", interval(drawn.phase_rad)}};
}

Json samples_json(const StepResult& result) {
  Json samples = Json::array();
  for (const SourceSamples& source : result.samples) {
    samples.push_back({{"source", source.source},
                       {"used", source.used},
                       {"lost", source.lost},
                       {"unusable", source.unusable},
                       {"overflowed", source.overflowed},
                       {"not_trusted", source.not_trusted},
                       {"not_measured", source.not_measured},
                       {"first_stamp_ns", source.first_stamp_ns},
                       {"last_stamp_ns", source.last_stamp_ns}});
  }
  return samples;
}

void add_flags(const std::vector<Flag>& flags, Json& json) {
  json["flags"] = sentences_of(flags);
  json["flag_names"] = names_of(flags);
}

void add_measured_excitation(const RunOutcome& outcome, const StepResult& result, Json& point) {
  const auto measured = measured_excitation(outcome, result);
  if (!measured) {
    return;
  }
  point["measured_frequency_hz"] = json_number(measured->reference->frequency.hz());
  point["u_measured_frequency_hz"] = json_number(measured->reference->u_frequency_hz);
  if (measured->is_acceleration) {
    point["measured_level_m_s2"] = json_number(measured->reference->fit.amplitude());
    point["u_measured_level_m_s2"] = json_number(measured->reference->fit.u_amplitude());
  }
}

void add_fit_of_channel(const RunOutcome& outcome, const StepResult& result, Json& point) {
  for (const analysis::ChannelFit& fit : result.fits) {
    if (fit.channel == result.channel) {
      point["fit"] = fit_json(outcome, fit);
    }
  }
}

void add_series(const SeriesFinding& series, Json& point) {
  point["sample_rate_hz"] = json_number(series.sample_rate_hz);
  point["u_sample_rate_hz"] = json_number(series.u_sample_rate_hz);
  point["series_start"] = series.start;
  point["series_start_scatter_s"] = json_number(series.start_scatter_s);
}

Json point_head(const StepResult& result) {
  Json samples = Json::object();
  for (const SourceSamples& source : result.samples) {
    samples[source.source] = source.used;
  }
  Json point = value_json(result);
  point["samples"] = samples;
  return point;
}

Json point_json(const RunOutcome& outcome, const StepResult& result) {
  Json point = point_head(result);
  add_flags(result.flags, point);
  point["budget"] = budget_json(result);
  point["signals"] = signals_json(result);
  point["data_sha256"] = result.data_sha256;
  if (result.valid) {
    add_expanded(magnitude_uncertainty(result), phase_uncertainty(result), point);
    add_measured_excitation(outcome, result, point);
    point["source_samples"] = samples_json(result);
    add_fit_of_channel(outcome, result, point);
  } else {
    point["problem"] = result.problem;
  }
  if (result.attempt > 1) {
    point["attempt"] = result.attempt;
  }
  if (result.temperature_degc) {
    point["temperature_degc"] = json_number(*result.temperature_degc);
  }
  if (result.monte_carlo) {
    point["monte_carlo"] = monte_carlo_json(*result.monte_carlo);
  }
  if (result.series) {
    add_series(*result.series, point);
  }
  return point;
}

Json transfer_json(const RunOutcome& outcome, const TransferFunction& function,
                   const FrequencyPoint& point) {
  Json json{{"channel", function.channel}, {"unit", function.unit}};
  json.update(mean_json(point));
  json["u_independent_phase_rad"] = json_number(point.mean.u_independent_phase_rad);
  std::vector<Flag> flags = flags_of(outcome, function.channel, point);
  flags.insert(flags.end(), function.flags.begin(), function.flags.end());
  add_flags(flags_once(flags), json);
  return json;
}

Json delay_json(const std::string& channel, const analysis::GroupDelay& delay) {
  Json covariance = Json::array();
  for (const double element : delay.phase_covariance) {
    covariance.push_back(json_number(element));
  }
  return {{"channel", channel},
          {"value_s", json_number(delay.delay_s)},
          {"u_s", json_number(delay.u_delay_s)},
          {"intercept_rad", json_number(delay.intercept_rad)},
          {"intercept_deg", degrees(delay.intercept_rad)},
          {"u_intercept_rad", json_number(delay.u_intercept_rad)},
          {"u_intercept_deg", degrees(delay.u_intercept_rad)},
          {"cov_delay_intercept_rad_s", json_number(delay.cov_delay_intercept)},
          {"phase_covariance_rad2", std::move(covariance)},
          {"chi_squared", json_number(delay.chi_squared)},
          {"degrees_of_freedom", json_number(delay.degrees_of_freedom)},
          {"polarity_inverted", delay.polarity_inverted}};
}

Json channel_json(const TransferFunction& function) {
  Json json{{"channel", function.channel},
            {"unit", function.unit},
            {"responds", responds(function)},
            {"lost", function.lost}};
  add_flags(function.flags, json);
  if (!function.group_delay) {
    json["group_delay_problem"] = function.group_delay_problem;
  }
  return json;
}

Json legend_json(const RunOutcome& outcome) {
  Json legend = Json::array();
  for (const FlagMeaning& meaning : flag_legend(flags_of(outcome))) {
    legend.push_back({{"name", meaning.name},
                      {"sentences", meaning.sentences},
                      {"meaning", meaning.explanation}});
  }
  return legend;
}

Json pauses_json(const RunOutcome& outcome) {
  Json pauses = Json::array();
  for (const RunPause& pause : outcome.pauses) {
    pauses.push_back({{"began_utc", utc_text(pause.began_utc_ns)},
                      {"ended_utc", utc_text(pause.ended_utc_ns)},
                      {"reason", pause.reason}});
  }
  return pauses;
}

Json head_json(const RunOutcome& outcome) {
  Json json{
      {"schema", {{"name", "dyncal-result"}, {"version", result_schema_version}}},
      {"bench", outcome.bench},
      {"run", outcome.run},
      {"method", to_string(outcome.method)},
      {"phase_convention",
       "lead: arg H in rad, a delay is negative; u_ are standard uncertainties (k = 1), U_ = "
       "k u_ expanded ones"},
      {"software", software_version()},
      {"analysis",
       {{"software",
         outcome.analysis_software.empty() ? Json(nullptr) : Json(outcome.analysis_software)},
        {"host", outcome.analysis_host.empty() ? Json(nullptr) : Json(outcome.analysis_host)}}},
      {"dds", {{"analysis", outcome.analysis_dds}}},
      {"began_utc", utc_text(outcome.began_utc_ns)},
      {"ended_utc", utc_text(outcome.ended_utc_ns)},
      {"planned_steps", outcome.planned_steps},
      {"interrupted", outcome.interrupted},
      {"problem", outcome.problem},
      {"recipe_sha256", outcome.recipe_sha256},
      {"flags", legend_json(outcome)},
      {"sources", sources_json(outcome)}};
  if (!outcome.pauses.empty()) {
    json["pauses"] = pauses_json(outcome);
  }
  if (outcome.recipe) {
    json["roles"] = roles_json(*outcome.recipe);
    json["corrections"] = corrections_json(*outcome.recipe, outcome.adc_file);
  }
  return json;
}

} // namespace

nlohmann::ordered_json result_json(const RunOutcome& outcome) {
  Json json = head_json(outcome);
  json["steps"] = steps_json(outcome);
  json["channels"] = Json::array();
  json["transfer_function"] = Json::array();
  json["group_delay"] = Json::array();
  json["sample_clock"] = Json::array();
  json["points"] = Json::array();
  for (const StepResult& result : outcome.results) {
    json["points"].push_back(point_json(outcome, result));
  }
  for (const TransferFunction& function : outcome.transfer_functions) {
    json["channels"].push_back(channel_json(function));
    for (const FrequencyPoint& point : function.points) {
      json["transfer_function"].push_back(transfer_json(outcome, function, point));
    }
    if (function.group_delay) {
      json["group_delay"].push_back(delay_json(function.channel, *function.group_delay));
    }
  }
  for (const ClockReport& report : outcome.clock_reports) {
    json["sample_clock"].push_back(clock_json(report));
  }
  if (outcome.recipe) {
    json["recipe"] = outcome.recipe->text;
  }
  return json;
}

Expected<void> write_json(const std::filesystem::path& path, const nlohmann::ordered_json& json) {
  return write_output_file(path, json_text(json, 1) + '\n');
}

} // namespace dyncal::services
