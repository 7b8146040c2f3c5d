// What a person should hear of when a source or a run has changed, each in a sentence. Plain
// functions; any thread.
#pragma once

#include <string>
#include <vector>

#include "services/network/condition.hpp"
#include "services/network/run.hpp"
#include "services/network/source.hpp"

namespace dyncal::network {

// `before` has no name if the source is new.
[[nodiscard]] std::vector<Condition> changes_of(const Source& before, const Source& source);

// What of a run is compared.
struct RunBefore {
  RunState state = RunState::unknown;
  std::string message;
  std::optional<AnalysisReport> analysis;
};
[[nodiscard]] RunBefore state_before(const Run& run);
[[nodiscard]] std::vector<Condition> changes_of(const RunBefore& before, const Run& run);

} // namespace dyncal::network
