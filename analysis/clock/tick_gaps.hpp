// Whether gaps of one interval are ticks of the stamps or missing samples, where all intervals seen
// are alike.
//
// Stamps of a tick T of a sample clock with a slightly longer period p are T apart, and 2 T once in
// T / (p - T) samples: regularly. Samples of a period of T exactly, of which one is lost now and
// then, look the same but for the regularity. So the first gaps wait. They are ticks when
// 4 + k of them lie on one line of TickLine with at most k = 0, 1, 2 others left out as losses;
// losses, when 12 have not been understood so. Stamps that went one interval back or forth for some
// samples show a latency at the edge of a tick, and widen the line: three of these for sure. One to
// three gaps say nothing: they are taken for losses. Whatever is not sure, the mean interval is
// uncertain by as many ticks.
// Units: ns. One thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "analysis/clock/tick_line.hpp"

namespace dyncal::analysis {

struct TickGap { // between two samples
  std::uint64_t before = 0;
  std::uint64_t after = 0;
  std::int64_t before_ns = 0;
  std::int64_t after_ns = 0;
  std::uint64_t missing = 0; // whole intervals in it that the numbers do not show
};

struct ExplainedGaps {
  TickLine line; // whose newest sample is that behind the last gap
  std::vector<TickGap> losses;
  bool is_sure = true; // or only so with the latency that one or two stamps show
};

class TickGaps {
public:
  // REQUIRES: `interval_ns` > 0.
  TickGaps(std::int64_t interval_ns, std::uint64_t first, std::int64_t first_ns)
      : interval_ns_(interval_ns), first_(first), first_ns_(first_ns) {}

  void add(const TickGap& gap) { gaps_.push_back(gap); }
  // A stamp was one interval early or late, and the next one was not.
  void add_stray() { ++strays_; }
  [[nodiscard]] bool flicker() const { return strays_ >= strays_that_convince; }
  [[nodiscard]] const std::vector<TickGap>& gaps() const { return gaps_; }
  [[nodiscard]] std::int64_t interval_ns() const { return interval_ns_; }
  // Empty: not, or not yet, to be understood as ticks.
  [[nodiscard]] std::optional<ExplainedGaps> explained() const;
  // On which all gaps are ticks, up to the last sample in order; empty where there is none.
  [[nodiscard]] std::optional<TickLine> line_to(std::uint64_t last, std::int64_t last_ns) const;
  // They may be ticks as well as losses.
  [[nodiscard]] bool are_unsure() const { return gaps_.size() < gaps_that_convince || strays_ > 0; }
  [[nodiscard]] bool are_losses() const { return gaps_.size() >= max_waiting; }

private:
  static constexpr std::size_t gaps_that_convince = 4;
  static constexpr std::size_t strays_that_convince = 3;
  static constexpr std::size_t max_waiting = 12;

  [[nodiscard]] std::optional<TickLine> line_without(std::size_t one, std::size_t other) const;

  std::int64_t interval_ns_;
  std::uint64_t first_;
  std::int64_t first_ns_;
  std::vector<TickGap> gaps_;
  std::size_t strays_ = 0;
};

} // namespace dyncal::analysis
