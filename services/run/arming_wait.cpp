#include "services/run/arming_wait.hpp"

#include <fmt/core.h>

#include "services/run/step_sequence.hpp"

namespace dyncal::inline run {

Expected<void> ArmingWait::wait(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const auto& analysis = watch_.analysis();
    const auto unheard = watch_.clock().now() - watch_.analysis_heard();
    const bool is_silent = analysis && unheard > attention_limit;
    watch_.follow(is_silent ? watch_.silence_of_analysis(StepSequence::away_limit)
                  : analysis && !analysis->message().empty() ? analysis->message()
                                                             : "waiting for the analysis");
    if (is_silent && unheard <= StepSequence::away_limit) {
      attended_ = watch_.clock().now();
    } else if (const auto answered = answer()) {
      return *answered;
    }
  }
  return fail(ErrorCode::interrupted, "interrupted before the first step; nothing was excited");
}

std::optional<Expected<void>> ArmingWait::answer() const {
  const auto& analysis = watch_.analysis();
  const auto waited = watch_.clock().now() - attended_;
  if (analysis && analysis->arm() == wire::ARM_ARMED) {
    return Expected<void>{};
  }
  if (analysis && analysis->arm() == wire::ARM_REFUSED) {
    return fail(ErrorCode::no_source, analysis->message());
  }
  if (!analysis && waited > answer_limit) {
    return fail(ErrorCode::no_analysis,
                fmt::format("no analysis service answers for bench '{}'; is dyncal-analysis "
                            "running in the same DDS domain?",
                            bench_));
  }
  if (waited > limit) {
    return fail(ErrorCode::no_analysis,
                fmt::format("the analysis service {} has not armed for bench '{}'",
                            analysis->service().c_str(), bench_));
  }
  return std::nullopt;
}

} // namespace dyncal::inline run
