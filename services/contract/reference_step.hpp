// What an analogue system that evaluates its own samples says of one step of a run, read from and
// written to the contract's AcsStep.
//
// a_T is the amplitude (peak) of the excitation, psi_T = theta_sync - theta_reference in radians of
// lead; u are standard uncertainties. A step that has no value says why in `problem`: its message
// has NaN for an amplitude, and the sentence as its origin. Plain data; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace dyncal::wire {
class AcsStep;
class Measurement;
} // namespace dyncal::wire

namespace dyncal::inline contract {

inline constexpr const char* reference_step_unit = R"(\metre\second\tothe{-2})";

struct ReferenceStep {
  std::uint32_t step = 0; // of the run, as its Measurement numbers it
  std::uint32_t repetition = 0;
  std::string frequency_text_hz{};
  double amplitude_m_s2 = 0.0; // a_T
  double u_amplitude_m_s2 = 0.0;
  double phase_rad = 0.0; // psi_T
  double u_phase_rad = 0.0;
  std::int64_t window_begin_utc_ns = 0; // that it was evaluated in; 0: not known
  std::int64_t window_end_utc_ns = 0;
  double distortion_reference_rel = 0.0; // 0: not known
  double distortion_sync_rel = 0.0;
  double coverage = 1.0; // standard uncertainties in a deviation, as the system stated it
  std::string origin{};  // file and line
  std::string problem{}; // why it has no value; empty: it has one
  bool operator==(const ReferenceStep&) const = default;
};

// A step of a run, as whoever reads a table for it needs it.
struct PlannedReferenceStep {
  std::uint32_t step = 0;
  std::uint32_t repetition = 0;
  std::string frequency_text_hz{};
  double length_s = 0.0; // with its settling
};
[[nodiscard]] std::vector<PlannedReferenceStep>
planned_reference_steps(const wire::Measurement& measurement);

// Everything but bench, source, run and session.
[[nodiscard]] wire::AcsStep to_message(const ReferenceStep& step);
[[nodiscard]] ReferenceStep from_message(const wire::AcsStep& message);

} // namespace dyncal::inline contract
