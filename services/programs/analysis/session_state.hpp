// The states of a run at the analysis service, each with what it alone has to know, and what a
// ServiceStatus reports of each.
//
//   Arming      sources have yet to describe themselves and to answer           WAITING  OK
//   TakingOver  armed; what was measured before this service is not evaluated   ARMED    WAITING
//   Attending   armed; steps are evaluated as they come                         ARMED    OK
//   Held        armed; a source is away, and waited for                         ARMED    WAITING
//   Failed      it cannot go on; it finishes with what there is                 ARMED    FAILED
//   Ended       the last result is published, or the run was refused            FINISHED, REFUSED
//
// services/programs/analysis/README.md has what leads from one to the other. Plain values.
#pragma once

#include <chrono>
#include <variant>

#include "idl/dyncal.h"
#include "services/bus/clock.hpp"
#include "services/programs/analysis/source_stream.hpp"

namespace dyncal::inline programs {

struct Arming {
  static constexpr std::chrono::seconds limit{10};
  static constexpr std::chrono::seconds present_limit{15}; // of a source that is there

  bus::Clock::Instant since;      // since when it has the bench to itself
  bus::Clock::Instant starting{}; // when a source had yet to describe itself, the last time

  // Whether what is missing is waited for no longer.
  [[nodiscard]] bool is_over(const MissingSource& missing, bus::Clock::Instant now);
};

struct TakingOver {
  bus::Clock::Instant all_there; // when no source was away, the last time
};

struct Attending {};

struct Held {
  bus::Clock::Instant since;
};

struct Failed {
  bool was_armed = true;
};

struct Ended {
  wire::ArmState arm = wire::ARM_FINISHED;
  wire::HealthState health = wire::HEALTH_OK; // as it was before
};

using SessionState = std::variant<Arming, TakingOver, Attending, Held, Failed, Ended>;

[[nodiscard]] wire::ArmState arm_of(const SessionState& state);
[[nodiscard]] wire::HealthState health_of(const SessionState& state);
// Since when a source is away; `now` where none was.
[[nodiscard]] bus::Clock::Instant waits_since(const SessionState& state, bus::Clock::Instant now);

} // namespace dyncal::inline programs
