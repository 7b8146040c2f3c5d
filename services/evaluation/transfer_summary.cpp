#include "services/evaluation/transfer_summary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>
#include <optional>

#include <fmt/core.h>

#include "analysis/base/phasor.hpp"
#include "services/evaluation/closures/channel_run.hpp"
#include "services/evaluation/mean_points.hpp"
#include "services/evaluation/method/unstated_uncertainty.hpp"
#include "services/evaluation/result/delay_points.hpp"
#include "services/evaluation/shared_phase_uncertainty.hpp"
#include "services/evaluation/sweep_delay.hpp"

namespace dyncal::inline evaluation {
namespace {

// Towards 0 Hz; a velocity against a displacement tends to half of pi, which is neither.
constexpr double opposite_from_rad = 0.75 * std::numbers::pi;
constexpr double before_excitation = 3.0; // standard uncertainties of a group delay below 0

// Those of other levels at a frequency stand in the turn of the one on the line.
void place_phases(const std::vector<std::size_t>& chosen, const std::vector<double>& unwrapped_rad,
                  std::vector<FrequencyPoint>& points) {
  std::size_t i = 0;
  for (FrequencyPoint& point : points) {
    while (points[chosen[i]].frequency_hz < point.frequency_hz) {
      ++i;
    }
    point.unwrapped_phase_rad =
        &point == &points[chosen[i]]
            ? unwrapped_rad[i]
            : unwrapped_rad[i] + analysis::wrap_phase(point.mean.phase_rad - unwrapped_rad[i]);
  }
}

// Delays of the same phases at frequencies that are multiples of a spacing.
Flag ambiguous_delay(const analysis::GroupDelay& delay) {
  constexpr std::size_t most_named = 3;
  double nearest_s = std::abs(delay.alternatives_s.front() - delay.delay_s);
  std::string others;
  for (std::size_t i = 0; i < delay.alternatives_s.size(); ++i) {
    nearest_s = std::min(nearest_s, std::abs(delay.alternatives_s[i] - delay.delay_s));
    if (i < most_named) {
      others += fmt::format("{}{:.4g}", i > 0 ? ", " : "", 1e3 * delay.alternatives_s[i]);
    }
  }
  return flag_with_reason(
      ResultFlag::group_delay_ambiguous,
      fmt::format("{} ms fit as well{}; frequencies less than {:.3g} Hz apart would tell", others,
                  delay.alternatives_s.size() > most_named ? ", and more" : "", 1.0 / nearest_s));
}

std::optional<Flag> opposite_repetitions(const std::vector<FrequencyPoint>& points) {
  const auto found = std::find_if(points.begin(), points.end(), [](const FrequencyPoint& point) {
    return point.mean.polarity_differs;
  });
  if (found == points.end()) {
    return std::nullopt;
  }
  return flag_with_reason(ResultFlag::polarity_inverted,
                          fmt::format("repetitions at {} Hz point in opposite directions, and "
                                      "their mean is of neither",
                                      found->frequency_text_hz));
}

// The budget of a point: that of its first step, which the others repeat.
BudgetAtFrequency budget_of(const FrequencyPoint& point,
                            const std::vector<const StepResult*>& results) {
  const auto found = std::find_if(results.begin(), results.end(), [&](const StepResult* result) {
    return result->frequency_hz == point.frequency_hz && result->level_m_s2 == point.level_m_s2;
  });
  return {point.frequency_hz, (*found)->budget};
}

// Of the repetitions of the chosen points.
std::vector<SweepPhase> phases_of_sweeps(const std::vector<FrequencyPoint>& points,
                                         const std::vector<std::size_t>& chosen,
                                         const std::vector<const StepResult*>& results) {
  std::vector<SweepPhase> phases;
  for (const std::size_t i : chosen) {
    const FrequencyPoint& point = points[i];
    for (const StepResult* result : results) {
      if (result->frequency_hz == point.frequency_hz && result->level_m_s2 == point.level_m_s2) {
        phases.push_back({result->repetition, point.frequency_hz,
                          analysis::wrap_phase(result->phase_rad - point.mean.phase_rad),
                          repetition_of(*result).u_random_phase_rad});
      }
    }
  }
  return phases;
}

// Of U / 2, from a part with its degrees of freedom and one that is known.
analysis::KnownTo known_to(double half_expanded, const analysis::UncertaintyPart& part,
                           double known) {
  const std::array parts{part, analysis::UncertaintyPart{known}};
  const double u = std::hypot(part.u, known);
  return u > 0.0 ? analysis::KnownTo{2.0 * half_expanded / u,
                                     analysis::effective_degrees_of_freedom(parts)}
                 : analysis::KnownTo{};
}

void add_delay_of_sweeps(const analysis::CombinedUncertainty& sweeps,
                         analysis::CommonPhaseUncertainty& common) {
  const double known_s = common.delay_s;
  common.delay_s = std::hypot(known_s, 0.5 * sweeps.expanded());
  common.delay_known = known_to(common.delay_s, {sweeps.u, sweeps.degrees_of_freedom}, known_s);
}

// What differs from frequency to frequency, k = 1: of a mean that was repeated by its scatter, of a
// single step by the rows of its budget that are drawn anew.
analysis::UncertaintyPart independent_phase(const analysis::RepetitionMean& mean,
                                            const std::vector<analysis::Contribution>& budget) {
  analysis::UncertaintyPart part{mean.u_independent_phase_rad};
  if (mean.repetitions > 1) {
    const analysis::CombinedUncertainty& scatter = mean.independent_phase;
    const bool is_weak = part.u != 0.5 * scatter.expanded(); // as repetitions.hpp has it
    return is_weak ? part : analysis::UncertaintyPart{scatter.u, scatter.degrees_of_freedom};
  }
  std::vector<analysis::UncertaintyPart> rows;
  for (const analysis::Contribution& row : budget) {
    if (row.repeats == analysis::Repeats::anew) {
      rows.push_back({row.u_phase_rad, row.degrees_of_freedom});
    }
  }
  part.degrees_of_freedom = analysis::effective_degrees_of_freedom(rows);
  return part;
}

} // namespace

void TransferSummary::add(const StepResult& result) {
  if (std::find(channels_.begin(), channels_.end(), result.channel) == channels_.end()) {
    channels_.push_back(result.channel);
  }
  results_[result.channel].insert_or_assign({result.step, result.repetition}, result);
}

void TransferSummary::add_group_delay(const std::vector<const StepResult*>& results,
                                      TransferFunction& function) const {
  const std::vector<std::size_t> chosen = delay_points(function.points);
  std::vector<BudgetAtFrequency> budgets;
  std::transform(chosen.begin(), chosen.end(), std::back_inserter(budgets),
                 [&](std::size_t i) { return budget_of(function.points[i], results); });
  SharedPhaseUncertainty shared = shared_phase_uncertainty(budgets);
  add_delay_of_sweeps(u_delay_of_sweeps(phases_of_sweeps(function.points, chosen, results)),
                      shared.common);
  std::vector<analysis::PhasePoint> phases;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const FrequencyPoint& point = function.points[chosen[i]];
    const double u = std::hypot(point.mean.u_independent_phase_rad, shared.beyond_rad[i]);
    phases.push_back(
        {point.frequency_hz, point.mean.phase_rad, u,
         known_to(u, independent_phase(point.mean, budgets[i].budget), shared.beyond_rad[i])});
  }
  auto delay = analysis::evaluate_group_delay(phases, shared.common);
  if (!delay) {
    function.group_delay_problem = delay.error().message;
    return;
  }
  place_phases(chosen, delay->unwrapped_rad, function.points);
  if (recipe_.dut_phase == DutPhase::any) {
    function.group_delay_problem =
        R"(the bench file says that the phase is not that of a delay (dut_phase = "any"))";
    return;
  }
  if (!delay->alternatives_s.empty()) {
    function.flags.push_back(ambiguous_delay(*delay));
  }
  const bool is_opposite = std::abs(delay->intercept_rad) > opposite_from_rad &&
                           recipe_.dut_phase != DutPhase::delay_from_180;
  if (is_opposite && !opposite_repetitions(function.points)) {
    function.flags.push_back(make_flag(ResultFlag::polarity_inverted));
  }
  if (delay->delay_s < -before_excitation * delay->u_delay_s()) {
    function.flags.push_back(make_flag(ResultFlag::answers_before_excitation));
  }
  function.group_delay = std::move(*delay);
}

TransferFunction TransferSummary::function_of(const std::string& channel) const {
  const ChannelResults& results = results_.at(channel);
  TransferFunction function;
  function.channel = channel;
  function.method = recipe_.method();
  std::vector<const StepResult*> valid;
  for (const auto& [key, result] : results) {
    if (result.valid) {
      valid.push_back(&result);
      function.unit = result.unit;
      function.excited_axis = result.excited_axis;
      function.lost += result.lost;
    }
  }
  function.points = mean_points(valid);
  if (!function.points.empty()) {
    function.flags = flags_of_unstated(recipe_);
    if (const auto opposite = opposite_repetitions(function.points)) {
      function.flags.push_back(*opposite);
    }
    add_group_delay(valid, function);
  }
  return function;
}

std::vector<StepResult> TransferSummary::results() const {
  std::vector<StepResult> all;
  for (const std::string& channel : channels_) {
    for (const auto& [key, result] : results_.at(channel)) {
      all.push_back(result);
    }
  }
  return all;
}

std::vector<TransferFunction> TransferSummary::transfer_functions() const {
  std::vector<TransferFunction> functions;
  for (const std::string& channel : channels_) {
    TransferFunction function = function_of(channel);
    if (!function.points.empty()) {
      functions.push_back(std::move(function));
    }
  }
  return functions;
}

} // namespace dyncal::inline evaluation
