#include "services/report/run_report.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "services/evaluation/contribution_message.hpp"

namespace dyncal::services {
namespace {

using Json = nlohmann::ordered_json;

std::string method_word(wire::Method method) {
  switch (method) {
  case wire::METHOD_ANALOGUE:
    return "analogue";
  case wire::METHOD_SERIES_TIMESTAMPING:
    return "series-timestamping";
  case wire::METHOD_ABSOLUTE_TIME:
    return "absolute-time";
  case wire::METHOD_SAMPLE_TIMESTAMPING:
    break;
  }
  return "sample-timestamping";
}

// JSON has no word for a number that is none.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json budget_json(const wire::CalibrationResult& result) {
  Json lines = Json::array();
  for (const wire::BudgetContribution& message : result.budget()) {
    const analysis::Contribution row = contribution_of(message);
    lines.push_back({{"name", row.name()},
                     {"distribution", to_string(row.distribution)},
                     {"degrees_of_freedom", number(row.degrees_of_freedom)}, // null: infinite
                     {"u_magnitude_rel", number(row.u_magnitude_rel)},
                     {"u_phase_rad", number(row.u_phase_rad)}});
  }
  return lines;
}

Json monte_carlo_json(const wire::MonteCarloCheck& check) {
  return {{"trials", check.trials()},
          {"stable", check.stable()},
          {"u_magnitude", number(check.u_magnitude())},
          {"magnitude_interval", {number(check.magnitude_low()), number(check.magnitude_high())}},
          {"u_phase_rad", number(check.u_phase_rad())},
          {"phase_interval_rad", {number(check.phase_low_rad()), number(check.phase_high_rad())}}};
}

Json point_json(const wire::CalibrationResult& result) {
  Json samples = Json::object();
  for (const wire::SourceSamples& source : result.samples()) {
    samples[source.source()] = source.used();
  }
  Json point{{"channel", result.channel().to_string()},
             {"step", result.step()},
             {"frequency_hz", result.frequency_hz()},
             {"level_m_s2", result.level_m_s2()},
             {"repetition", result.repetition()},
             {"valid", result.valid()},
             {"magnitude", number(result.magnitude())},
             {"u_magnitude", number(result.u_magnitude())},
             {"phase_rad", number(result.phase_rad())},
             {"u_phase_rad", number(result.u_phase_rad())},
             {"unit", result.unit()},
             {"samples", samples},
             {"lost", result.lost()},
             {"flags", result.flags()},
             {"budget", budget_json(result)},
             {"data_sha256", result.data_sha256()}};
  if (!result.valid()) {
    point["problem"] = result.problem();
  }
  for (const wire::MonteCarloCheck& check : result.monte_carlo()) {
    point["monte_carlo"] = monte_carlo_json(check);
  }
  if (!result.series_start().empty()) {
    point["sample_rate_hz"] = number(result.sample_rate_hz());
    point["u_sample_rate_hz"] = number(result.u_sample_rate_hz());
    point["series_start"] = result.series_start();
    point["series_start_scatter_s"] = number(result.series_start_scatter_s());
  }
  return point;
}

Json transfer_json(const wire::TransferFunction& function, const wire::TransferPoint& point) {
  return {{"channel", function.channel().to_string()},
          {"frequency_hz", point.frequency_hz()},
          {"magnitude", number(point.magnitude())},
          {"u_magnitude", number(point.u_magnitude())},
          {"phase_rad", number(point.phase_rad())},
          {"u_phase_rad", number(point.u_phase_rad())},
          {"unwrapped_phase_rad", number(point.unwrapped_phase_rad())},
          {"scatter_magnitude", number(point.scatter_magnitude())},
          {"scatter_phase_rad", number(point.scatter_phase_rad())},
          {"unit", function.unit()},
          {"repetitions", point.repetitions()}};
}

Json delay_json(const wire::TransferFunction& function) {
  return {{"channel", function.channel().to_string()},
          {"value_s", number(function.group_delay_s())},
          {"u_s", number(function.u_group_delay_s())},
          {"intercept_rad", number(function.intercept_rad())},
          {"u_intercept_rad", number(function.u_intercept_rad())}};
}

Json clock_json(const wire::SampleClockReport& report) {
  return {{"source", report.source().to_string()},
          {"mean_interval_s", report.mean_interval_s()},
          {"u_mean_interval_s", report.u_mean_interval_s()},
          {"sd_s", report.sd_interval_s()},
          {"min_s", report.min_interval_s()},
          {"max_s", report.max_interval_s()},
          {"median_s", report.median_interval_s()},
          {"mad_sd_s", report.mad_sd_interval_s()},
          {"count", report.interval_count()},
          {"nominal_rate_hz", report.nominal_rate_hz()},
          {"mean_rate_hz", report.mean_rate_hz()},
          {"tick_s", report.tick_s()},
          {"lattice_statistic", report.lattice_statistic()},
          {"events", report.event_count()},
          {"pair_period_samples", number(report.pair_period_samples())},
          {"pair_period_s", number(report.pair_period_s())},
          {"temperature_correlation", number(report.temperature_correlation())},
          {"temperature_slope_s_per_degc", number(report.temperature_slope_s_per_degc())},
          {"lost", report.lost()}};
}

std::string channel_table(const wire::TransferFunction& function) {
  std::string text = fmt::format(
      "\n{}{}\n", function.channel().c_str(),
      function.unit().empty() || function.unit() == R"(\one)" ? "" : ", in " + function.unit());
  text += fmt::format("{:>12}  {:>12} {:>10}  {:>12} {:>10}  {}\n", "f / Hz", "|H|", "u(|H|)",
                      "arg H / rad", "u / rad", "n");
  for (const wire::TransferPoint& point : function.points()) {
    text += fmt::format("{:>12}  {:>12.6f} {:>10.1e}  {:>12.6f} {:>10.1e}  {}\n",
                        point.frequency_text_hz(), point.magnitude(), point.u_magnitude(),
                        point.phase_rad(), point.u_phase_rad(), point.repetitions());
  }
  if (function.group_delay_valid()) {
    text += fmt::format(
        "  group delay {:.6g} ms, u = {:.2g} ms; intercept {:.2g} rad, u = {:.2g} rad\n",
        function.group_delay_s() * 1e3, function.u_group_delay_s() * 1e3, function.intercept_rad(),
        function.u_intercept_rad());
  } else if (!function.group_delay_problem().empty()) {
    text += fmt::format("  no group delay: {}\n", function.group_delay_problem());
  }
  return text;
}

// A series has no stamps: its rate is known by eq. (6) alone.
std::string series_clock_line(const RunOutcome& outcome, const wire::SampleClockReport& report) {
  std::set<std::string> starts;
  for (const wire::CalibrationResult& result : outcome.results) {
    if (!result.series_start().empty()) {
      starts.insert(result.series_start());
    }
  }
  const double u_rate_hz =
      report.u_mean_interval_s() * report.mean_rate_hz() * report.mean_rate_hz();
  return fmt::format(
      "\nSample rate of {}: {:.6f} Hz, u = {:.1g} Hz, nominal {:g} Hz; its series start {}\n",
      report.source().c_str(), report.mean_rate_hz(), u_rate_hz, report.nominal_rate_hz(),
      fmt::join(starts, " or "));
}

} // namespace

bool responds(const wire::TransferFunction& function) {
  const auto above = std::count_if(function.points().begin(), function.points().end(),
                                   [](const wire::TransferPoint& point) {
                                     return point.magnitude() > 3.0 * point.u_magnitude();
                                   });
  return 2 * static_cast<std::size_t>(above) > function.points().size();
}

std::string result_table(const RunOutcome& outcome) {
  std::string text;
  std::vector<std::string> quiet;
  for (const wire::TransferFunction& function : outcome.transfer_functions) {
    if (responds(function)) {
      text += channel_table(function);
    } else {
      quiet.push_back(function.channel().to_string());
    }
  }
  if (!quiet.empty()) {
    text += fmt::format("\nNo response above three times its uncertainty in: {}\n",
                        fmt::join(quiet, ", "));
  }
  for (const wire::SampleClockReport& report : outcome.clock_reports) {
    if (report.interval_count() == 0) {
      text += series_clock_line(outcome, report);
      continue;
    }
    text += fmt::format("\nSample clock of {}: mean interval {:.5f} us, sd {:.1f} ns, spread "
                        "{:.0f} ns, {} intervals, {} events, {} samples lost\n",
                        report.source().c_str(), report.mean_interval_s() * 1e6,
                        report.sd_interval_s() * 1e9,
                        (report.max_interval_s() - report.min_interval_s()) * 1e9,
                        report.interval_count(), report.event_count(), report.lost());
  }
  std::vector<std::string> problems;
  for (const wire::CalibrationResult& result : outcome.results) {
    const std::string line = fmt::format("step {}, {} Hz: {}", result.step(),
                                         result.frequency_text_hz(), result.problem());
    if (!result.valid() && std::find(problems.begin(), problems.end(), line) == problems.end()) {
      problems.push_back(line);
    }
  }
  if (!problems.empty()) {
    text += fmt::format("\nWithout a result:\n  {}\n", fmt::join(problems, "\n  "));
  }
  return text;
}

nlohmann::ordered_json result_json(const RunOutcome& outcome) {
  Json json{{"bench", outcome.measurement.bench().to_string()},
            {"run", outcome.measurement.run().to_string()},
            {"method", method_word(outcome.measurement.method())},
            {"phase_convention",
             "lead: arg H in rad, a delay is negative; u_ are standard uncertainties"},
            {"dds", {{"analysis", outcome.analysis_dds}}},
            {"recipe_sha256", outcome.measurement.recipe_sha256()},
            {"interrupted", outcome.interrupted},
            {"problem", outcome.problem},
            {"points", Json::array()},
            {"transfer_function", Json::array()},
            {"group_delay", Json::array()},
            {"sample_clock", Json::array()}};
  for (const wire::CalibrationResult& result : outcome.results) {
    json["points"].push_back(point_json(result));
  }
  for (const wire::TransferFunction& function : outcome.transfer_functions) {
    for (const wire::TransferPoint& point : function.points()) {
      json["transfer_function"].push_back(transfer_json(function, point));
    }
    if (function.group_delay_valid()) {
      json["group_delay"].push_back(delay_json(function));
    }
  }
  for (const wire::SampleClockReport& report : outcome.clock_reports) {
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
