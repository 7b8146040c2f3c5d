#include "services/evaluation/method/series_time_stamping.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <string>

#include <fmt/core.h>

#include "analysis/base/chi_squared_limit.hpp"
#include "analysis/uncertainty/coverage.hpp"
#include "services/evaluation/method/flag_of_most.hpp"
#include "services/evaluation/method/series_step_evaluation.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/method/step_task.hpp"

namespace dyncal::inline evaluation {
namespace {

StepAttempt attempt_at(std::size_t step, const RunRecords& records) {
  const StepOrder& order = records.excitation().order();
  return {order.step(step).step, order.attempt(step)};
}

// A drift of the sensor's clock that another step shows.
bool add_disagreement_of_another(const std::map<std::uint32_t, analysis::StepBend>& bends,
                                 const std::string& channel, std::span<StepResult> results) {
  std::vector<analysis::StepBend> steps;
  steps.reserve(bends.size());
  for (const auto& [number, bend] : bends) {
    steps.push_back(bend);
  }
  const std::vector<bool> bend = analysis::steps_that_bend(steps);
  bool added = false;
  for (StepResult& result : results) {
    const auto found = result.channel == channel ? bends.find(result.step) : bends.end();
    if (found == bends.end() || !result.valid ||
        has_flag(result.flags, ResultFlag::shots_disagree) ||
        !bend[static_cast<std::size_t>(std::distance(bends.begin(), found))]) {
      continue;
    }
    result.flags.push_back(flag_of_channel(
        ResultFlag::shots_disagree, channel,
        "the clock drifts within the series, as other steps show; here it is hidden in their "
        "noise"));
    added = true;
  }
  return added;
}

constexpr double once_in_twenty = 1.645; // normal quantile

// What the run says of the sensor's sample clock: the rates of its steps, paper eq. (6), taken
// together.
//
// Mean weighted by their uncertainties; where they scatter by more than these say, its uncertainty
// is what the scatter says (Birge), with n - 1 degrees of freedom from where chance does so once in
// twenty times on. The clock of the ACS, in which all of them were measured, is common to them:
// `u_acs_rate_rel`. REQUIRES: at least one rate.
ClockReport series_clock_report(const std::string& sensor, double u_acs_rate_rel,
                                std::span<const analysis::NominalFrequency> rates) {
  double weights = 0.0;
  double sum = 0.0;
  const auto weight_of = [](const analysis::NominalFrequency& rate) {
    return 1.0 / (rate.u_real_rate_hz * rate.u_real_rate_hz);
  };
  for (const analysis::NominalFrequency& rate : rates) {
    weights += weight_of(rate);
    sum += weight_of(rate) * rate.real_rate_hz;
  }
  const double mean_hz = sum / weights;
  double chi_square = 0.0;
  for (const analysis::NominalFrequency& rate : rates) {
    chi_square += weight_of(rate) * std::pow(rate.real_rate_hz - mean_hz, 2);
  }
  const double freedom = static_cast<double>(rates.size()) - 1.0;
  const double birge = rates.size() > 1 ? std::sqrt(chi_square / freedom) : 1.0;
  analysis::UncertaintyPart of_steps{std::max(1.0, birge) / std::sqrt(weights) / mean_hz};
  if (birge * birge > analysis::chi_squared_limit(std::max(1.0, freedom), once_in_twenty)) {
    of_steps.degrees_of_freedom = freedom; // it is known by their scatter alone
  }
  const std::array parts{of_steps, analysis::UncertaintyPart{u_acs_rate_rel}};
  const analysis::CombinedUncertainty of_rate = analysis::combine(parts);
  ClockReport report;
  report.source = sensor;
  report.clock.nominal_rate_hz = rates.front().real_rate_hz / rates.front().lambda;
  report.clock.mean_rate_hz = mean_hz;
  report.clock.mean_interval_s = 1.0 / mean_hz;
  report.clock.u_mean_interval_s = of_rate.u / mean_hz;
  report.clock.degrees_of_freedom_mean_interval = of_rate.degrees_of_freedom;
  report.clock.k_mean_interval = of_rate.k;
  return report;
}

} // namespace

std::vector<SearchedChannel> SeriesTimeStamping::searches() const {
  return {{roles_.sync_acs, {roles_.sync_acs.source}}};
}

void SeriesTimeStamping::add(const std::string& source, TriggeredRecord record) {
  if (source == roles_.sync_sensor.source) {
    shots_.add_trace(std::move(record));
  } else if (source == roles_.dut.front().source) {
    shots_.add_series(std::move(record));
  }
}

bool SeriesTimeStamping::is_complete(std::size_t step, const RunRecords& records) const {
  const ExcitationProgress& excitation = records.excitation();
  const bool all_there = excitation.is_announced_over(step) &&
                         shots_.of_step(attempt_at(step, records)).size() >= recipe_->series.shots;
  return all_there || records.is_over_in(roles_.sync_acs.source, step);
}

Evaluation SeriesTimeStamping::evaluation(std::size_t step, const RunRecords& records) {
  return [results = evaluate(step, records)](const std::stop_token&) { return results; };
}

std::vector<StepResult> SeriesTimeStamping::evaluate(std::size_t step, const RunRecords& records) {
  const RecipeStep& planned = records.planned(step);
  const StepAttempt attempt = attempt_at(step, records);
  const auto interval = records.interval(0, step);
  if (!interval) {
    return results_without_value(planned, roles_.dut,
                                 no_sine(*recipe_, records, step, roles_.sync_acs));
  }
  const SourceInterval acs = records.samples(roles_.sync_acs.source, *interval);
  SeriesStepOutput evaluated =
      evaluate_series_step({.task = make_step_task(recipe_, step, records, {acs}),
                            .acs = acs,
                            .oscilloscope = records.of(roles_.sync_sensor.source),
                            .sensor = records.of(roles_.dut.front().source),
                            .shots = shots_.of_step(attempt),
                            .lost = shots_.lost_in(attempt),
                            .start_so_far = start_});
  if (evaluated.start != analysis::StartKind::undecided) {
    start_ = evaluated.start;
  }
  if (evaluated.rate) {
    const std::size_t place = records.excitation().order().index(step);
    rates_.insert_or_assign(place, *evaluated.rate);
    starts_.insert_or_assign(place, evaluated.start_evidence);
    for (const auto& [channel, bend] : evaluated.bends) {
      bends_[channel].insert_or_assign(planned.step, bend);
    }
  }
  shots_.forget_step(attempt);
  return std::move(evaluated.results);
}

bool SeriesTimeStamping::settle(std::span<StepResult> results) const {
  bool disagree = false;
  for (const auto& [channel, bends] : bends_) {
    disagree |= add_disagreement_of_another(bends, channel, results);
  }
  disagree |= add_flag_of_most(ResultFlag::shots_disagree, results);
  if (start_ == analysis::StartKind::uniform) {
    return disagree; // its scatter is known, and in u
  }
  std::vector<analysis::StartEvidence> steps;
  for (const auto& [place, evidence] : starts_) {
    steps.push_back(evidence);
  }
  const auto shared = analysis::shared_start_scatter(steps);
  if (!shared) {
    return disagree;
  }
  for (StepResult& result : results) {
    add_shared_start(*shared, result);
  }
  return true;
}

std::vector<ClockReport> SeriesTimeStamping::clock_reports() const {
  if (rates_.empty()) {
    return {};
  }
  std::vector<analysis::NominalFrequency> rates;
  for (const auto& [step, rate] : rates_) {
    rates.push_back(rate);
  }
  return {series_clock_report(roles_.dut.front().source, recipe_->series.u_acs_rate_rel, rates)};
}

} // namespace dyncal::inline evaluation
