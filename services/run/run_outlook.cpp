#include "services/run/run_outlook.hpp"

#include <fmt/core.h>

namespace dyncal::inline run {
namespace {

using Kind = RunOutlook::Kind;

std::string message_of(const wire::ServiceStatus& analysis, const char* otherwise) {
  return analysis.message().empty()
             ? fmt::format("the analysis service {} {}", analysis.service().c_str(), otherwise)
             : analysis.message();
}

// Its last word: it says nothing more of the run, and no other takes the run over.
bool has_ended(const wire::ServiceStatus& analysis) {
  return analysis.arm() == wire::ARM_REFUSED || analysis.arm() == wire::ARM_FINISHED;
}

RunOutlook outlook_by(const wire::ServiceStatus& analysis) {
  if (analysis.arm() == wire::ARM_REFUSED) {
    return {Kind::over, {ErrorCode::no_source, message_of(analysis, "refuses the run")}};
  }
  if (analysis.arm() == wire::ARM_FINISHED) {
    return {Kind::over,
            {ErrorCode::no_analysis, message_of(analysis, "has ended the run before its last "
                                                          "step")}};
  }
  if (analysis.health() == wire::HEALTH_WAITING) {
    return {Kind::waits, {ErrorCode::no_source, message_of(analysis, "waits for a source")}};
  }
  if (analysis.arm() == wire::ARM_WAITING) {
    return {Kind::waits, {ErrorCode::no_analysis, message_of(analysis, "takes the run over")}};
  }
  if (analysis.health() != wire::HEALTH_OK) {
    return {Kind::over, {ErrorCode::no_source, message_of(analysis, "has failed")}};
  }
  return {};
}

// Why the analysis asks the conductor to end: a run that was resumed as it cannot go on.
Error refusal_of_resumed(const wire::ServiceStatus& analysis) {
  if (analysis.health() == wire::HEALTH_WAITING) {
    return {ErrorCode::no_source, message_of(analysis, "waits for a source")};
  }
  return {ErrorCode::bad_file, "the analysis evaluates this run by another bench file than it is "
                               "conducted by; begin a new run"};
}

} // namespace

RunOutlook run_outlook(const std::optional<wire::ServiceStatus>& analysis,
                       const std::string& analysis_participant, std::chrono::nanoseconds unheard,
                       const RunCommands& commands) {
  if (const auto& by = commands.aborted_by()) {
    if (analysis && by->participant == analysis_participant) {
      return {Kind::over, refusal_of_resumed(*analysis)};
    }
    return {Kind::over,
            {ErrorCode::no_result, fmt::format("ended by a command of {}", by->sentence)}};
  }
  RunOutlook outlook;
  if (analysis && !has_ended(*analysis) && unheard > attention_limit) {
    outlook = {Kind::waits,
               {ErrorCode::no_analysis, fmt::format("the analysis service {} has gone silent",
                                                    analysis->service().c_str())}};
  } else if (analysis) {
    outlook = outlook_by(*analysis);
  }
  if (outlook.kind == Kind::well && commands.paused_by()) {
    outlook = {Kind::paused,
               {ErrorCode::no_result,
                fmt::format("paused by a command of {}", commands.paused_by()->sentence)}};
  }
  return outlook;
}

} // namespace dyncal::inline run
