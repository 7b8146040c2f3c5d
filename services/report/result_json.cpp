#include "services/report/run_report.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace dyncal::services {
namespace {

using Json = nlohmann::ordered_json;

// JSON cannot represent NaN or infinity.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json budget_json(const StepResult& result) {
  Json lines = Json::array();
  for (const analysis::Contribution& row : result.budget) {
    lines.push_back({{"name", row.name()},
                     {"distribution", to_string(row.distribution)},
                     {"degrees_of_freedom", number(row.degrees_of_freedom)}, // null: infinite
                     {"u_magnitude_rel", number(row.u_magnitude_rel)},
                     {"u_phase_rad", number(row.u_phase_rad)}});
  }
  return lines;
}

Json monte_carlo_json(const analysis::TransferCheck& drawn) {
  return {{"trials", drawn.magnitude.trials},
          {"stable", drawn.magnitude.stable && drawn.phase_rad.stable},
          {"u_magnitude", number(drawn.magnitude.u)},
          {"magnitude_interval", {number(drawn.magnitude.low), number(drawn.magnitude.high)}},
          {"u_phase_rad", number(drawn.phase_rad.u)},
          {"phase_interval_rad", {number(drawn.phase_rad.low), number(drawn.phase_rad.high)}}};
}

Json point_json(const StepResult& result) {
  Json samples = Json::object();
  for (const SourceSamples& source : result.samples) {
    samples[source.source] = source.used;
  }
  Json point{{"channel", result.channel},
             {"step", result.step},
             {"frequency_hz", result.frequency_hz},
             {"level_m_s2", result.level_m_s2},
             {"repetition", result.repetition},
             {"valid", result.valid},
             {"magnitude", number(result.magnitude)},
             {"u_magnitude", number(result.u_magnitude)},
             {"phase_rad", number(result.phase_rad)},
             {"u_phase_rad", number(result.u_phase_rad)},
             {"unit", result.unit},
             {"samples", samples},
             {"lost", result.lost},
             {"flags", sentences_of(result.flags)},
             {"budget", budget_json(result)},
             {"data_sha256", result.data_sha256}};
  if (!result.valid) {
    point["problem"] = result.problem;
  }
  if (result.monte_carlo) {
    point["monte_carlo"] = monte_carlo_json(*result.monte_carlo);
  }
  if (result.series) {
    point["sample_rate_hz"] = number(result.series->sample_rate_hz);
    point["u_sample_rate_hz"] = number(result.series->u_sample_rate_hz);
    point["series_start"] = result.series->start;
    point["series_start_scatter_s"] = number(result.series->start_scatter_s);
  }
  return point;
}

Json transfer_json(const TransferFunction& function, const FrequencyPoint& point) {
  return {{"channel", function.channel},
          {"frequency_hz", point.frequency_hz},
          {"magnitude", number(point.mean.magnitude)},
          {"u_magnitude", number(point.mean.u_magnitude)},
          {"phase_rad", number(point.mean.phase_rad)},
          {"u_phase_rad", number(point.mean.u_phase_rad)},
          {"unwrapped_phase_rad", number(point.unwrapped_phase_rad)},
          {"scatter_magnitude", number(point.mean.scatter_magnitude)},
          {"scatter_phase_rad", number(point.mean.scatter_phase_rad)},
          {"unit", function.unit},
          {"repetitions", point.mean.repetitions}};
}

Json delay_json(const std::string& channel, const analysis::GroupDelay& delay) {
  return {{"channel", channel},
          {"value_s", number(delay.delay_s)},
          {"u_s", number(delay.u_delay_s)},
          {"intercept_rad", number(delay.intercept_rad)},
          {"u_intercept_rad", number(delay.u_intercept_rad)}};
}

Json clock_json(const ClockReport& report) {
  const analysis::SampleClockStatistics& clock = report.clock;
  return {{"source", report.source},
          {"mean_interval_s", clock.mean_interval_s},
          {"u_mean_interval_s", clock.u_mean_interval_s},
          {"sd_s", clock.sd_s},
          {"min_s", clock.minimum_s},
          {"max_s", clock.maximum_s},
          {"median_s", clock.median_s},
          {"mad_sd_s", clock.mad_sd_s},
          {"count", clock.intervals},
          {"nominal_rate_hz", clock.nominal_rate_hz},
          {"mean_rate_hz", clock.mean_rate_hz},
          {"tick_s", clock.tick_s},
          {"lattice_statistic", clock.lattice_statistic},
          {"events", clock.event_count},
          {"pair_period_samples", number(clock.pair_period_samples)},
          {"pair_period_s", number(clock.pair_period_s)},
          {"temperature_correlation", number(clock.temperature_correlation)},
          {"temperature_slope_s_per_degc", number(clock.temperature_slope_s_per_degc)},
          {"lost", clock.lost}};
}

std::string channel_table(const TransferFunction& function) {
  std::string text = fmt::format(
      "\n{}{}\n", function.channel,
      function.unit.empty() || function.unit == R"(\one)" ? "" : ", in " + function.unit);
  text += fmt::format("{:>12}  {:>12} {:>10}  {:>12} {:>10}  {}\n", "f / Hz", "|H|", "u(|H|)",
                      "arg H / rad", "u / rad", "n");
  for (const FrequencyPoint& point : function.points) {
    text += fmt::format("{:>12}  {:>12.6f} {:>10.1e}  {:>12.6f} {:>10.1e}  {}\n",
                        point.frequency_text_hz, point.mean.magnitude, point.mean.u_magnitude,
                        point.mean.phase_rad, point.mean.u_phase_rad, point.mean.repetitions);
  }
  if (function.group_delay) {
    const analysis::GroupDelay& delay = *function.group_delay;
    text += fmt::format(
        "  group delay {:.6g} ms, u = {:.2g} ms; intercept {:.2g} rad, u = {:.2g} rad\n",
        delay.delay_s * 1e3, delay.u_delay_s * 1e3, delay.intercept_rad, delay.u_intercept_rad);
  } else if (!function.group_delay_problem.empty()) {
    text += fmt::format("  no group delay: {}\n", function.group_delay_problem);
  }
  return text;
}

// A series has no stamps: its rate is known by eq. (6) alone.
std::string series_clock_line(const RunOutcome& outcome, const ClockReport& report) {
  std::set<std::string> starts;
  for (const StepResult& result : outcome.results) {
    if (result.series) {
      starts.insert(result.series->start);
    }
  }
  const analysis::SampleClockStatistics& clock = report.clock;
  const double u_rate_hz = clock.u_mean_interval_s * clock.mean_rate_hz * clock.mean_rate_hz;
  return fmt::format(
      "\nSample rate of {}: {:.6f} Hz, u = {:.1g} Hz, nominal {:g} Hz; its series start {}\n",
      report.source, clock.mean_rate_hz, u_rate_hz, clock.nominal_rate_hz,
      fmt::join(starts, " or "));
}

std::string clock_line(const ClockReport& report) {
  const analysis::SampleClockStatistics& clock = report.clock;
  return fmt::format("\nSample clock of {}: mean interval {:.5f} us, sd {:.1f} ns, spread "
                     "{:.0f} ns, {} intervals, {} events, {} samples lost\n",
                     report.source, clock.mean_interval_s * 1e6, clock.sd_s * 1e9,
                     (clock.maximum_s - clock.minimum_s) * 1e9, clock.intervals, clock.event_count,
                     clock.lost);
}

// The steps without a result, each reason once.
std::vector<std::string> problem_lines(const RunOutcome& outcome) {
  std::vector<std::string> lines;
  for (const StepResult& result : outcome.results) {
    std::string line =
        fmt::format("step {}, {} Hz: {}", result.step, result.frequency_text_hz, result.problem);
    if (!result.valid && std::find(lines.begin(), lines.end(), line) == lines.end()) {
      lines.push_back(std::move(line));
    }
  }
  return lines;
}

} // namespace

bool responds(const TransferFunction& function) {
  const auto above = std::count_if(function.points.begin(), function.points.end(),
                                   [](const FrequencyPoint& point) {
                                     return point.mean.magnitude > 3.0 * point.mean.u_magnitude;
                                   });
  return 2 * static_cast<std::size_t>(above) > function.points.size();
}

std::string result_table(const RunOutcome& outcome) {
  std::string text;
  std::vector<std::string> quiet;
  for (const TransferFunction& function : outcome.transfer_functions) {
    if (responds(function)) {
      text += channel_table(function);
    } else {
      quiet.push_back(function.channel);
    }
  }
  if (!quiet.empty()) {
    text += fmt::format("\nNo response above three times its uncertainty in: {}\n",
                        fmt::join(quiet, ", "));
  }
  for (const ClockReport& report : outcome.clock_reports) {
    text += report.clock.intervals == 0 ? series_clock_line(outcome, report) : clock_line(report);
  }
  const std::vector<std::string> problems = problem_lines(outcome);
  if (!problems.empty()) {
    text += fmt::format("\nWithout a result:\n  {}\n", fmt::join(problems, "\n  "));
  }
  return text;
}

nlohmann::ordered_json result_json(const RunOutcome& outcome) {
  Json json{{"bench", outcome.bench},
            {"run", outcome.run},
            {"method", to_string(outcome.method)},
            {"phase_convention",
             "lead: arg H in rad, a delay is negative; u_ are standard uncertainties"},
            {"dds", {{"analysis", outcome.analysis_dds}}},
            {"recipe_sha256", outcome.recipe_sha256},
            {"interrupted", outcome.interrupted},
            {"problem", outcome.problem},
            {"points", Json::array()},
            {"transfer_function", Json::array()},
            {"group_delay", Json::array()},
            {"sample_clock", Json::array()}};
  for (const StepResult& result : outcome.results) {
    json["points"].push_back(point_json(result));
  }
  for (const TransferFunction& function : outcome.transfer_functions) {
    for (const FrequencyPoint& point : function.points) {
      json["transfer_function"].push_back(transfer_json(function, point));
    }
    if (function.group_delay) {
      json["group_delay"].push_back(delay_json(function.channel, *function.group_delay));
    }
  }
  for (const ClockReport& report : outcome.clock_reports) {
    json["sample_clock"].push_back(clock_json(report));
  }
  return json;
}

Expected<void> write_json(const std::filesystem::path& path, const nlohmann::ordered_json& json) {
  std::ofstream stream(path);
  stream << json.dump(1) << '\n';
  if (!stream.flush()) {
    return fail(ErrorCode::bad_file, fmt::format("{}: cannot write this file", path.string()));
  }
  return {};
}

} // namespace dyncal::services
