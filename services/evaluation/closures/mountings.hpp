// What repetitions of a run have in common, each by itself: a sensor that is mounted anew for every
// repetition has another sensitivity by some parts in a thousand, and another delay by some
// microseconds, at all frequencies alike. That is no fault of a single result.
//
//   ln m_i = median over f of ln|H_i / H_1|,  tau_i = median over f of arg(H_i / H_1) / (2 pi f)
//
// both against the repetition in the middle of all. They are known from three common points on;
// with fewer, or where they are not known, mountings may differ by a tenth. The first step once
// more at the end is of the mounting before it. Plain data and functions; any thread.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "services/evaluation/closures/channel_run.hpp"

namespace dyncal::inline evaluation {

inline constexpr double mounting_tolerance = 0.1; // of the magnitude; rad of the phase

struct Mounting {
  double magnitude_log = 0.0; // ln m_i
  double delay_s = 0.0;       // tau_i; a later phase is negative
  double u_magnitude_rel = 0.0;
};

class Mountings {
public:
  explicit Mountings(const ChannelRun& run);

  // Whether that of every repetition could be told.
  [[nodiscard]] bool are_known() const { return known_; }
  // Its value as of the mounting in the middle.
  [[nodiscard]] analysis::Repetition value_of(const StepResult& result) const;
  [[nodiscard]] std::vector<PointRepetitions> points(const ChannelRun& run) const;
  // That which is farthest from the others, by its repetition.
  [[nodiscard]] std::pair<std::uint32_t, Mounting> farthest() const;

private:
  void centre();

  std::map<std::uint32_t, Mounting> of_repetitions_;
  bool known_ = true;
};

} // namespace dyncal::inline evaluation
