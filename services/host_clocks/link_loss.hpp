// What is lost between two programs, in each direction, by numbered probes and their echoes.
//
// The asker numbers its probes, and the program numbers the echoes that it sends back; both are
// best effort. How many came is told of the probes by the program, over a reliable topic, and
// counted of the echoes by the asker. So neither direction hides the other, also where nothing gets
// through.
//
// A way counts from the first that came, for what was sent before two programs had found each other
// is no loss. It counts up to the newest that must have arrived by then, or has.
//
// Plain data and pure functions, any thread.
#pragma once

#include <cstdint>
#include <optional>

#include "idl/dyncal.h"
#include "services/contract/program_identity.hpp"

namespace dyncal::services {

// Of one asker's probes, as the program that gets them tells them; numbers count from 1, 0 is none.
struct ProbeCounts {
  std::uint64_t series = 0; // of the probes; an asker begins a new one with its numbers
  std::uint64_t first = 0;
  std::uint64_t newest = 0;
  std::uint64_t received = 0;
  std::uint64_t echoed = 0;
};

// Of one program's echoes, as the asker has counted them.
struct EchoCounts {
  std::uint64_t first = 0;
  std::uint64_t newest = 0;
  std::uint64_t received = 0;
};

// The asker's probes, as one program concerns them.
struct ProbesSent {
  std::uint64_t series = 0;
  std::uint64_t all = 0;
  std::uint64_t early = 0; // of all: so early that the program may not have been ready for them
  std::uint64_t due = 0;   // of all: so long before the program told its counts that they had come
};

struct Way {
  std::uint64_t sent = 0;
  std::uint64_t arrived = 0;
};

struct LinkLoss {
  ProgramIdentity identity;    // of the other end
  bool answers_probes = false; // otherwise nothing is known
  Way there = {};
  Way back = {};
};

// The fewest that a loss is stated of.
inline constexpr std::uint64_t fewest_probes = 20;

// Counts that contradict each other or what was sent, as no program tells them, are none.
[[nodiscard]] Way way_there(const ProbesSent& sent, const ProbeCounts& told);
[[nodiscard]] Way way_back(const ProbesSent& sent, const ProbeCounts& told,
                           const EchoCounts& echoes);

// 0 to 1; nothing where too few were sent.
[[nodiscard]] std::optional<double> lost_part(const Way& way);

// Nothing if the program answers no probes.
[[nodiscard]] std::optional<ProbeCounts> probe_counts_of(const wire::ClockAnswer& answer);

} // namespace dyncal::services
