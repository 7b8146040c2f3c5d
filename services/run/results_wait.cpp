#include "services/run/results_wait.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "services/run/step_sequence.hpp"

namespace dyncal::inline run {
namespace {

using Kind = RunOutlook::Kind;

} // namespace

Expected<void> ResultsWait::wait(const std::stop_token& stop) {
  const bool already_stopped = stop.stop_requested();
  while (!has_everything()) {
    const bool attended = has_finished() || is_attended();
    watch_.follow(attended ? "evaluating" : watch_.silence_of_analysis(StepSequence::away_limit));
    if (!already_stopped && stop.stop_requested() &&
        watch_.measurement().state() != wire::MEASUREMENT_ABORTED) {
      watch_.set_state(wire::MEASUREMENT_ABORTED, interrupted_by_user);
    }
    const RunOutlook outlook = watch_.outlook();
    if (watch_.analysis()->arm() == wire::ARM_REFUSED && !plays_files()) {
      return fail(outlook.reason);
    }
    note_work(attended, outlook, stop.stop_requested());
    if (watch_.clock().now() - at_work_ > StepSequence::missed_limit &&
        !std::exchange(collected_again_, true)) {
      watch_.collect_again();
    }
    if (auto ended = ending(); !ended) {
      return ended;
    }
    abort_of(outlook);
  }
  return {};
}

void ResultsWait::note_work(bool is_attended, const RunOutlook& outlook, bool stopped) {
  const bool is_at_work = watch_.signs_of_work() != signs_before_;
  const bool is_waited_for = (!is_attended || outlook.kind == Kind::waits) && !stopped;
  const bool may_still_come = is_waited_for || (plays_files() && outlook.kind != Kind::over);
  if (is_at_work || may_still_come) {
    signs_before_ = watch_.signs_of_work();
    changed_ = watch_.clock().now();
  }
  if (is_at_work || (is_attended && !has_finished())) {
    at_work_ = watch_.clock().now();
  }
}

Expected<void> ResultsWait::ending() const {
  if (auto other = watch_.other_recipe()) {
    return fail(std::move(*other));
  }
  if (watch_.clock().now() - watch_.analysis_heard() > StepSequence::away_limit) {
    return fail(ErrorCode::no_analysis, fmt::format("the analysis service {} has gone silent",
                                                    watch_.analysis()->service().c_str()));
  }
  if (watch_.clock().now() - changed_ > StepSequence::results_limit) {
    return fail(ErrorCode::no_result, "the last results have not come from the analysis service");
  }
  return {};
}

void ResultsWait::abort_of(const RunOutlook& outlook) {
  if (plays_files() && outlook.kind == Kind::over && !has_finished()) {
    watch_.outcome().problem = outlook.reason.message;
    watch_.set_state(wire::MEASUREMENT_ABORTED, outlook.reason.message);
  }
}

// Topics have no order among each other: FINISHED may come before results that were written before
// it; but not before those that come once more (run_publisher.cpp).
bool ResultsWait::has_everything() const {
  const auto& analysis = watch_.analysis();
  const RunOutcome& outcome = watch_.outcome();
  return analysis && has_finished() && outcome.results.size() >= analysis->results_published() &&
         std::none_of(outcome.results.begin(), outcome.results.end(),
                      [](const StepResult& one) { return one.provisional; }) &&
         outcome.transfer_functions.size() >= analysis->transfer_functions_published() &&
         outcome.clock_reports.size() >= analysis->clock_reports_published();
}

bool ResultsWait::has_finished() const {
  return watch_.analysis()->arm() == wire::ARM_FINISHED;
}

bool ResultsWait::is_attended() const {
  return watch_.clock().now() - watch_.analysis_heard() <= attention_limit;
}

bool ResultsWait::plays_files() const {
  return !excites_ && watch_.measurement().state() == wire::MEASUREMENT_RUNNING;
}

} // namespace dyncal::inline run
