#include "services/views/report/transfer_data.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "analysis/base/phasor.hpp"
#include "services/contract/run_identity.hpp"
#include "services/contract/unit.hpp"
#include "services/views/report/expanded_uncertainty.hpp"
#include "services/views/report/flag_legend.hpp"

namespace dyncal::inline views {
namespace {

double fit_residual(const StepResult& result) {
  const auto own = std::ranges::find(result.signals, result.channel, &ChannelSignal::channel);
  return own == result.signals.end() ? std::numeric_limits<double>::quiet_NaN() : own->residual;
}

std::vector<const StepResult*> valid_results(const RunOutcome& outcome,
                                             const std::string& channel) {
  std::vector<const StepResult*> results;
  for (const StepResult& result : outcome.results) {
    if (result.valid && result.channel == channel) {
      results.push_back(&result);
    }
  }
  return results;
}

// What both have: title, repetitions, what the flags mean.
figures::TransferFunctionData common_data(const RunOutcome& outcome,
                                          const TransferFunction& function) {
  figures::TransferFunctionData data;
  data.title = function.channel;
  data.subtitle =
      fmt::format("bench {}, run {}", outcome.bench, RunIdentity::parse(outcome.run).name);
  data.unit = short_form(function.unit);
  data.excited_axis = function.excited_axis;
  for (const StepResult* result : valid_results(outcome, function.channel)) {
    data.repetitions.push_back(repetition_of(*result, flag_names(result->flags)));
  }
  for (const StoredFlag& flag : flag_legend(flags_of(outcome, function))) {
    data.flag_sentences.push_back(legend_line(flag));
  }
  return data;
}

// The phase, in the turn next to another.
double in_turn_of(double phase_rad, double near_rad) {
  constexpr double turn = 2 * std::numbers::pi;
  return phase_rad + turn * std::round((near_rad - phase_rad) / turn);
}

// Of at least one.
figures::ValueOverFrequency plain_mean(const std::vector<const StepResult*>& repetitions) {
  const StepResult& first = *repetitions.front();
  const auto count = static_cast<double>(repetitions.size());
  figures::ValueOverFrequency mean{.frequency_hz = first.frequency_hz,
                                   .level_m_s2 = first.level_m_s2};
  std::vector<Flag> flags;
  for (const StepResult* one : repetitions) {
    mean.value.magnitude += one->magnitude / count;
    mean.value.phase_rad += in_turn_of(one->phase_rad, first.phase_rad) / count;
    flags.insert(flags.end(), one->flags.begin(), one->flags.end());
  }
  mean.flags = flag_names(flags);
  return mean;
}

} // namespace

figures::RepetitionPoint repetition_of(const StepResult& result, const std::string& flag_names) {
  return {result.repetition,
          {result.frequency_hz,
           result.level_m_s2,
           {result.magnitude, result.u_magnitude, result.phase_rad, result.u_phase_rad},
           flag_names},
          fit_residual(result),
          result.step,
          result.attempt};
}

figures::TransferFunctionData transfer_data(const RunOutcome& outcome,
                                            const TransferFunction& function) {
  figures::TransferFunctionData data = common_data(outcome, function);
  for (const FrequencyPoint& point : function.points) {
    const ExpandedUncertainty magnitude = magnitude_uncertainty(point.mean);
    const ExpandedUncertainty phase = phase_uncertainty(point.mean);
    data.mean.push_back({point.frequency_hz,
                         point.level_m_s2,
                         {point.mean.magnitude, magnitude.u, point.unwrapped_phase_rad, phase.u},
                         flag_names(flags_of(outcome, function.channel, point)),
                         magnitude.expanded,
                         phase.expanded,
                         point.mean.phase_rad});
  }
  data.group_delay = function.group_delay;
  return data;
}

figures::TransferFunctionData transfer_data_so_far(const RunOutcome& outcome,
                                                   const std::string& channel) {
  const std::vector<const StepResult*> results = valid_results(outcome, channel);
  TransferFunction function;
  function.channel = channel;
  function.unit = results.empty() ? "" : results.front()->unit;
  function.excited_axis = results.empty() ? "" : results.front()->excited_axis;
  figures::TransferFunctionData data = common_data(outcome, function);
  data.means_are_plain = true;
  std::map<std::pair<double, double>, std::vector<const StepResult*>> by_excitation;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const StepResult& result = *results[i];
    by_excitation[{result.frequency_hz, result.level_m_s2}].push_back(&result);
    data.repetitions[i].point.expanded_magnitude = magnitude_uncertainty(result).expanded;
    data.repetitions[i].point.expanded_phase_rad = phase_uncertainty(result).expanded;
  }
  for (const auto& [excitation, repetitions] : by_excitation) {
    figures::ValueOverFrequency mean = plain_mean(repetitions);
    if (!data.mean.empty()) {
      mean.value.phase_rad = in_turn_of(mean.value.phase_rad, data.mean.back().value.phase_rad);
    }
    mean.stated_phase_rad = analysis::wrap_phase(mean.value.phase_rad);
    data.mean.push_back(std::move(mean));
  }
  return data;
}

} // namespace dyncal::inline views
