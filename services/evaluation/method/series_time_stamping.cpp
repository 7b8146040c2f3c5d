#include "services/evaluation/method/series_time_stamping.hpp"

#include <algorithm>
#include <iterator>
#include <string>

#include <fmt/core.h>

#include "services/evaluation/method/flag_of_most.hpp"
#include "services/evaluation/method/series_clock.hpp"
#include "services/evaluation/method/series_step_evaluation.hpp"
#include "services/evaluation/method/step_results.hpp"
#include "services/evaluation/method/step_task.hpp"

namespace dyncal::inline evaluation {
namespace {

StepAttempt attempt_at(std::size_t step, const RunRecords& records) {
  const StepOrder& order = records.excitation().order();
  return {order.step(step).step, order.attempt(step)};
}

bool has_shots_that_disagree(const StepResult& result) {
  return std::any_of(result.flags.begin(), result.flags.end(),
                     [](const Flag& flag) { return flag.kind == ResultFlag::shots_disagree; });
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
    if (found == bends.end() || !result.valid || has_shots_that_disagree(result) ||
        !bend[static_cast<std::size_t>(std::distance(bends.begin(), found))]) {
      continue;
    }
    result.flags.push_back(
        {ResultFlag::shots_disagree,
         fmt::format("{}: {}: the clock drifts within the series, as other steps show; here it is "
                     "hidden in their noise",
                     channel, to_string(ResultFlag::shots_disagree))});
    added = true;
  }
  return added;
}

} // namespace

std::vector<SearchedChannel> SeriesTimeStamping::searches() const {
  return {{roles_.sync_acs, {roles_.sync_acs.source}}};
}

void SeriesTimeStamping::add(const std::string& source, TriggeredRecord record) {
  if (source == roles_.sync_dso.source) {
    shots_.add_trace(std::move(record));
  } else if (source == roles_.dut.front().source) {
    shots_.add_series(std::move(record));
  }
}

bool SeriesTimeStamping::is_complete(std::size_t step, const RunRecords& records) const {
  const ExcitationProgress& excitation = records.excitation();
  const bool all_there = excitation.is_announced_over(step) &&
                         shots_.of_step(attempt_at(step, records)).size() >= roles_.shots;
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
                            .oscilloscope = records.of(roles_.sync_dso.source),
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
  return {series_clock_report(roles_.dut.front().source, roles_.u_acs_rate_rel, rates)};
}

} // namespace dyncal::inline evaluation
