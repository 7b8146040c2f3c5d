// What must hold over a whole run, and whether it does: one comparison of numbers that were
// measured independently of each other.
//
// `value` is what was found against what must hold there (a difference of clocks: 0), `limit` what
// chance and the tolerances of instruments leave it, both in `unit`; `u` is the standard
// uncertainty of the value, 0 where the limit is a tolerance alone. `closes`: |value| <= limit.
// What is not possible says why in its sentence, and its numbers are 0. Plain data and functions;
// any thread.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace dyncal::inline evaluation {

enum class ClosureKind {
  clock_rate,           // of the sensor's clock, against what crystals are
  clock_ratio,          // of the two clocks in a step, against all other steps
  excitation_frequency, // of the fit, against the generator's
  level,                // measured, against asked
  samples_counted,      // evaluated and lost, against the time they took
  repetitions,          // of a point, against each other
  repetition_scatter,   // of repetitions, against the mean's u
  first_repeated,       // the first point, at the end once more
  delay_fit,            // phases, against a straight line
  delay_alternatives,   // other delays that the frequencies leave open
  phase_at_zero,        // towards 0 Hz, against 0 or pi
  channel_delays,       // of channels of one kind, against each other
  channel_clocks,       // of channels of one sensor, each by its own samples
  clock_links           // sync, against stamps of both clocks in UTC
};

inline constexpr auto last_closure_kind = ClosureKind::clock_links;

enum class Verdict { closes, open, not_possible };

struct Closure {
  ClosureKind kind = ClosureKind::clock_rate;
  std::string subject{}; // what was compared: a source, a channel, a frequency
  Verdict verdict = Verdict::not_possible;
  double value = 0.0;
  double u = 0.0;
  double limit = 0.0;
  std::string unit{};
  std::string sentence{}; // for people, with what to do where it is open
};

// "clock_rate"; "clock rate" for people; "not_possible".
[[nodiscard]] std::string_view to_string(ClosureKind kind);
[[nodiscard]] std::string_view title_of(ClosureKind kind);
[[nodiscard]] std::string_view to_string(Verdict verdict);

// "dau/x: phase towards 0 Hz: ...", in one line for people.
[[nodiscard]] std::string closure_line(const std::string& channel, const Closure& closure);

[[nodiscard]] bool is_open(const Closure& closure);

} // namespace dyncal::inline evaluation
