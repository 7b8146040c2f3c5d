// Whether a run may excite its bench now: the one place where it is decided what a run waits for
// and what ends it, from what the analysis service reports and what others command.
//
// It waits while the analysis is silent, is still taking the run over or waits itself (a source
// that is away), and while it is paused by command. It ends when the analysis reports that the run
// cannot be evaluated (a level far above the plan among others), refuses it, or has ended it, and
// by command; the analysis itself commands it of a run that was resumed with another bench file or
// another instrument. Plain function; any thread.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "idl/dyncal.h"
#include "services/base/error.hpp"
#include "services/run/run_commands.hpp"

namespace dyncal::inline run {

struct RunOutlook {
  enum class Kind {
    well,
    waits,  // for at most RunWatch::away_limit
    paused, // as long as whoever paused it likes
    over
  };
  Kind kind = Kind::well;
  Error reason{}; // unless well
};

// An analysis that was heard less than this ago attends to the run.
inline constexpr std::chrono::seconds attention_limit{3};

// `analysis`: its newest status, `unheard` ago; `analysis_participant`: the id of its participant.
[[nodiscard]] RunOutlook run_outlook(const std::optional<wire::ServiceStatus>& analysis,
                                     const std::string& analysis_participant,
                                     std::chrono::nanoseconds unheard, const RunCommands& commands);

} // namespace dyncal::inline run
