// How results are kept while their run goes on. All may be empty; the functions are called by the
// thread that conducts the run and must not make it wait.
#pragma once

#include <functional>
#include <optional>

#include "services/base/error.hpp"
#include "services/run/begun_run.hpp"

namespace dyncal::inline run {

struct RunKeeping {
  // When the run is armed and its sources are known: whether there is room for it. What it fails
  // with is why nothing is excited.
  std::function<Expected<void>(const RunOutcome& planned)> check;
  // With all there is, as soon as results have come.
  std::function<void(const RunOutcome& so_far)> keep;
  std::optional<BegunRun> begun{}; // where the run is resumed
};

} // namespace dyncal::inline run
