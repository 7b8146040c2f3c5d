#include "services/evaluation/transfer_summary.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/instrument/adc_calibration.hpp"
#include "analysis/method/repetitions.hpp"
#include "analysis/response/group_delay.hpp"
#include "services/evaluation/contribution_message.hpp"
#include "services/version.hpp"

namespace dyncal::services {
namespace {

analysis::Repetition repetition_of(const wire::CalibrationResult& result) {
  std::vector<analysis::Contribution> budget;
  for (const wire::BudgetContribution& row : result.budget()) {
    budget.push_back(contribution_of(row));
  }
  return analysis::make_repetition(std::polar(result.magnitude(), result.phase_rad()), budget);
}

struct PointOfMean {
  wire::TransferPoint message;
  analysis::PhasePoint phase;
};

PointOfMean point_of(const std::vector<const wire::CalibrationResult*>& results,
                     const analysis::RepetitionMean& mean) {
  PointOfMean point;
  point.message.frequency_text_hz(results.front()->frequency_text_hz());
  point.message.frequency_hz(results.front()->frequency_hz());
  point.message.level_m_s2(results.front()->level_m_s2());
  point.message.magnitude(mean.magnitude);
  point.message.u_magnitude(mean.u_magnitude);
  point.message.phase_rad(mean.phase_rad);
  point.message.u_phase_rad(mean.u_phase_rad);
  point.message.unwrapped_phase_rad(mean.phase_rad);
  point.message.scatter_magnitude(mean.scatter_magnitude);
  point.message.scatter_phase_rad(mean.scatter_phase_rad);
  point.message.repetitions(static_cast<std::uint32_t>(mean.repetitions));
  point.phase = {results.front()->frequency_hz(), mean.phase_rad, mean.u_independent_phase_rad};
  return point;
}

// Several levels at one frequency are points of their own; the line through the phases takes the
// first of them.
std::vector<std::size_t> first_of_each_frequency(const std::vector<PointOfMean>& points) {
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i == 0 || points[i].phase.frequency_hz > points[i - 1].phase.frequency_hz) {
      chosen.push_back(i);
    }
  }
  return chosen;
}

// The ADC's lag is calibrated as one curve: its uncertainty shifts all phases alike in delay. The
// largest over the frequencies stands for all.
double u_adc_delay_s(const Recipe& recipe, const std::vector<analysis::PhasePoint>& phases) {
  double max_s = 0.0;
  for (const analysis::PhasePoint& point : phases) {
    if (const auto adc = analysis::adc_response_at(recipe.adc_calibration, point.frequency_hz)) {
      max_s = std::max(max_s, adc->u_phase_lag_rad / (2.0 * std::numbers::pi * point.frequency_hz));
    }
  }
  return max_s;
}

// What shifts all frequencies alike: it adds in full to the group delay.
double u_common_delay_s(const Recipe& recipe, const std::vector<analysis::PhasePoint>& phases) {
  const bool by_series = recipe.method == wire::METHOD_SERIES_TIMESTAMPING;
  return std::hypot(recipe.systematic.acs_delay_s,
                    by_series ? recipe.u_dso_delay_s : u_adc_delay_s(recipe, phases));
}

// One clock against the other, and the latency of stamps: the same error of time at every
// frequency.
double u_clock_offset_s(
    const std::map<std::pair<std::uint32_t, std::uint32_t>, wire::CalibrationResult>& results) {
  double max_s = 0.0;
  for (const auto& [key, result] : results) {
    for (const wire::BudgetContribution& message : result.budget()) {
      const analysis::Contribution row = contribution_of(message);
      if (row.kind == analysis::ContributionKind::clock_offset) {
        max_s = std::max(max_s, row.u_phase_rad / (2.0 * std::numbers::pi * result.frequency_hz()));
      }
    }
  }
  return max_s;
}

void add_group_delay(const Recipe& recipe, double u_clock_s, std::vector<PointOfMean>& points,
                     wire::TransferFunction& function) {
  const std::vector<std::size_t> chosen = first_of_each_frequency(points);
  std::vector<analysis::PhasePoint> phases;
  for (const std::size_t i : chosen) {
    phases.push_back(points[i].phase);
  }
  const auto delay = analysis::evaluate_group_delay(
      phases, {std::hypot(u_common_delay_s(recipe, phases), u_clock_s),
               recipe.systematic.reference_phase_rad});
  function.group_delay_valid(delay.has_value());
  if (!delay) {
    function.group_delay_problem(delay.error().message);
    return;
  }
  function.group_delay_s(delay->delay_s);
  function.u_group_delay_s(delay->u_delay_s);
  function.intercept_rad(delay->intercept_rad);
  function.u_intercept_rad(delay->u_intercept_rad);
  function.cov_delay_intercept_rad_s(delay->cov_delay_intercept);
  function.phase_covariance_rad2() = delay->phase_covariance;
  if (delay->polarity_inverted) {
    function.flags().emplace_back("polarity inverted");
  }
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    points[chosen[i]].message.unwrapped_phase_rad(delay->unwrapped_rad[i]);
  }
}

} // namespace

void TransferSummary::add(const wire::CalibrationResult& result) {
  const std::string channel = result.channel().to_string();
  if (std::find(channels_.begin(), channels_.end(), channel) == channels_.end()) {
    channels_.push_back(channel);
  }
  results_[channel][{result.step(), result.repetition()}] = result;
}

std::vector<wire::TransferFunction> TransferSummary::transfer_functions() const {
  std::vector<wire::TransferFunction> functions;
  for (const std::string& channel : channels_) {
    std::map<std::pair<double, double>, std::vector<const wire::CalibrationResult*>>
        by_frequency_and_level;
    wire::TransferFunction function;
    for (const auto& [key, result] : results_.at(channel)) {
      if (result.valid()) {
        by_frequency_and_level[{result.frequency_hz(), result.level_m_s2()}].push_back(&result);
        function.unit(result.unit());
        function.lost(function.lost() + result.lost());
      }
    }
    std::vector<PointOfMean> points;
    for (const auto& [key, results] : by_frequency_and_level) {
      std::vector<analysis::Repetition> repetitions;
      std::transform(results.begin(), results.end(), std::back_inserter(repetitions),
                     [](const wire::CalibrationResult* result) { return repetition_of(*result); });
      if (const auto mean = analysis::mean_of_repetitions(repetitions)) {
        points.push_back(point_of(results, *mean));
      }
    }
    if (points.empty()) {
      continue;
    }
    function.bench(recipe_.bench);
    function.run(recipe_.run);
    function.channel(channel);
    function.method(recipe_.method);
    add_group_delay(recipe_, u_clock_offset_s(results_.at(channel)), points, function);
    for (PointOfMean& point : points) {
      function.points().push_back(std::move(point.message));
    }
    function.software(software_version());
    function.recipe_sha256(recipe_.sha256);
    functions.push_back(std::move(function));
  }
  return functions;
}

} // namespace dyncal::services
