// Sorts the recorded edges of the pulse-per-second inputs of a DAU: which of them are seconds.
//
// A record lists edges as the unit reported them: input (the GPS receiver's pulse that disciplines
// the unit, or a reference pulse), the edge's running number, and the reading of the capture
// counter. Within one run of the counter the edges of an input lie on a grid of one second, where T
// (ticks a second) follows the crystal from edge to edge:
//
//   c_{i+1} = c_i + k T + e,   k = 1, 2, 3 ...,   |e| <= tolerance
//
// What does not fit is classified by what comes next:
//
//   extra            the edges after it lie on the old grid: this one is not a second
//   missing          k > 1: k - 1 seconds have no edge in the record
//   duplicate        the record repeats an edge
//   pulse step       the edges after it lie on a new grid, those of the other input on its own
//   session restart  the running number goes back, or every input leaves its grid for a new one:
//                    the counter began anew, or a gap is longer than the counter's period
//
// A counter whose readings all fit 32 bits is taken to wrap at 2^32 (43 s at 100 MHz), with any
// number of missing edges shorter than that.
//
// Fails: too_few_samples (fewer than three edges, or most are not whole seconds apart),
// invalid_argument (tolerance). Any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "analysis/base/error.hpp"

namespace dyncal::analysis {

enum class PulseInput { gps, reference };

struct PulseEdge {
  PulseInput input = PulseInput::gps;
  std::uint64_t number = 0;
  std::uint64_t ticks = 0;
};

enum class PulseFault { extra, missing, duplicate, pulse_step, session_restart };

struct PulseEvent {
  PulseFault fault = PulseFault::extra;
  PulseInput input = PulseInput::gps;
  std::size_t edge = 0; // index into the record: the edge rejected, or the first one after what is
                        // missing or moved
  std::uint64_t missing = 0; // seconds without an edge
  std::string reason;        // half a sentence
};

struct Pulse {
  std::int64_t ticks = 0; // from the first edge of the session, unwrapped
  std::int64_t second =
      0;                // counted along the input's own grid, 0 for its first edge of the session
  std::size_t edge = 0; // index into the record
};

struct PulseSession {
  std::vector<Pulse> gps;
  std::vector<Pulse> reference;
};

struct PulseEdgeSettings {
  double tolerance_s = 20e-6; // of an edge's distance from the grid; GPS pulses scatter by 0.1 us
};

struct SortedPulses {
  std::vector<PulseSession> sessions;
  std::vector<PulseEvent> events; // in the order of the record
  double ticks_per_second = 0.0;  // most usual distance of two edges

  [[nodiscard]] std::uint64_t count(PulseFault fault,
                                    PulseInput input) const; // missing: seconds, else events
};

[[nodiscard]] Expected<SortedPulses> sort_pulse_edges(std::span<const PulseEdge> record,
                                                      const PulseEdgeSettings& settings = {});

} // namespace dyncal::analysis
