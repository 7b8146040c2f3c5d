#include "services/network/changes.hpp"

#include <fmt/core.h>

namespace dyncal::network {

std::vector<Condition> changes_of(const Source& before, const Source& source) {
  if (before.name.empty()) {
    return {{Severity::note, fmt::format("{} is there", source.name)}};
  }
  std::vector<Condition> changes;
  if (before.is_silent) {
    changes.push_back({Severity::note, fmt::format("{} is heard again", source.name)});
  }
  if (before.state != SourceState::unknown && before.session != source.session) {
    changes.push_back({Severity::note, fmt::format("{} has restarted", source.name)});
  }
  const bool is_bad = source.state == SourceState::failed || source.state == SourceState::silent;
  const bool is_news = before.state != source.state || before.message != source.message;
  if (is_news && (is_bad || !source.message.empty())) {
    const std::string text =
        source.message.empty() ? std::string(to_string(source.state)) : source.message;
    changes.push_back(
        {is_bad ? Severity::error : Severity::warning, fmt::format("{}: {}", source.name, text)});
  }
  return changes;
}

RunBefore state_before(const Run& run) {
  return {run.state(), run.message, run.analysis};
}

std::vector<Condition> changes_of(const RunBefore& before, const Run& run) {
  std::vector<Condition> changes;
  const RunState state = run.state();
  if (state != before.state) {
    const Severity severity = state == RunState::aborted ? Severity::error : Severity::note;
    const std::string reason =
        state == RunState::aborted && !run.message.empty() ? ": " + run.message : "";
    changes.push_back({severity, fmt::format("run {} {}{}", run.name, to_string(state), reason)});
  } else if (state == RunState::running && run.message != before.message) {
    changes.push_back({run.message.empty() ? Severity::note : Severity::warning,
                       fmt::format("run {} {}", run.name,
                                   run.message.empty() ? "goes on" : "is paused: " + run.message)});
  }
  const bool analysis_changed =
      before.analysis && run.analysis && run.analysis->health != before.analysis->health;
  if (analysis_changed && run.analysis->health != Health::ok) {
    const bool has_failed = run.analysis->health == Health::failed;
    changes.push_back({has_failed ? Severity::error : Severity::warning,
                       fmt::format("{}: the analysis {}: {}", run.name,
                                   has_failed ? "has failed" : "waits", run.analysis->message)});
  }
  return changes;
}

} // namespace dyncal::network
