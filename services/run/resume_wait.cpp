#include "services/run/resume_wait.hpp"

#include <utility>

#include <fmt/core.h>

#include "services/run/arming_wait.hpp"
#include "services/run/step_sequence.hpp"

namespace dyncal::inline run {
namespace {

using Kind = RunOutlook::Kind;

} // namespace

Expected<void> check_same_instruments(const RunWatch& watch, const std::string& name) {
  const std::string other = watch.other_instrument();
  return other.empty()
             ? Expected<void>{}
             : fail(ErrorCode::no_source, fmt::format("run '{}' is not resumed: {}", name, other));
}

Expected<void> ResumeWait::wait(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const auto& analysis = watch_.analysis();
    watch_.follow(analysis && !analysis->message().empty() ? analysis->message()
                                                           : "waiting for the analysis");
    if (watch_.signs_of_work() != std::exchange(signs_before_, watch_.signs_of_work())) {
      attended_ = watch_.clock().now();
    }
    if (const auto answered = answer()) {
      return *answered;
    }
  }
  return fail(ErrorCode::interrupted,
              "interrupted before the run was resumed; nothing was excited");
}

bool ResumeWait::may_be_another_recipe() const {
  return !begun_ && watch_.outcome().results.empty() &&
         watch_.clock().now() - began_ < recipe_limit;
}

std::optional<Expected<void>> ResumeWait::answer() const {
  const auto& analysis = watch_.analysis();
  if (watch_.other_recipe()) {
    return fail(other_bench_file(name_));
  }
  if (analysis && analysis->arm() == wire::ARM_REFUSED) {
    return fail(refusal());
  }
  if (analysis && analysis->arm() == wire::ARM_FINISHED) {
    watch_.notice(fmt::format("run '{}' has ended at the analysis service {}; its results are "
                              "collected",
                              name_, analysis->service().c_str()));
    return Expected<void>{};
  }
  if (auto same = check_same_instruments(watch_, name_); analysis && !same) {
    return same;
  }
  // Without the guard, which has heard nothing since the other conductor died: it hears this one
  // when a step is announced.
  const RunOutlook outlook =
      run_outlook(analysis, watch_.analysis_participant(),
                  watch_.clock().now() - watch_.analysis_heard(), watch_.commands());
  if (analysis && outlook.kind == Kind::over && watch_.commands().aborted_by()) {
    return fail(outlook.reason.code,
                fmt::format("run '{}' is not resumed: {}", name_, outlook.reason.message));
  }
  const std::size_t results = watch_.outcome().results.size();
  if (analysis && outlook.kind == Kind::well && !may_be_another_recipe() &&
      results >= analysis->results_published()) {
    watch_.notice(fmt::format("run '{}' is resumed, with {} results so far", name_, results));
    return Expected<void>{};
  }
  if (watch_.clock().now() - attended_ <=
      (analysis ? StepSequence::away_limit : ArmingWait::limit)) {
    return std::nullopt;
  }
  return analysis && outlook.kind == Kind::waits
             ? fail(outlook.reason)
             : fail(ErrorCode::no_analysis,
                    fmt::format("no analysis service holds run '{}' of bench '{}'; begin a new run",
                                name_, bench_));
}

// An analysis that takes a run over cannot know whether anything was measured; its folder does.
Error ResumeWait::refusal() const {
  const Error refusal = watch_.outlook().reason;
  const bool has_results = !watch_.outcome().results.empty() || !begun_ || begun_->has_results;
  return has_results ? refusal
                     : Error{refusal.code, fmt::format("run '{}' ended before its first result: "
                                                       "nothing was measured; begin a new run",
                                                       name_)};
}

} // namespace dyncal::inline run
