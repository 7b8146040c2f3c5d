// Whether stamps of ticks of about a sample period went a tick further as regularly as ticks make
// them, or at random as losses do.
//
// A sample clock of the period p goes against its ticks T by one every T / |p - T| samples, but for
// what latencies move that: a few per cent of the distance. Such slips may have been taken for
// samples that are missing, where latencies hide the line on which they lie (tick_line.hpp). So all
// slips and losses are looked at together, the first 64 of them: fewer than four, or such that lie
// on a line within 0.35 of their distance, may all be ticks. One thread.
#pragma once

#include <cstdint>
#include <vector>

namespace dyncal::analysis {

class SlipSpacing {
public:
  // A tick further than the samples, at this one; `missing` samples were taken for the reason, or
  // none.
  void add(std::uint64_t sample, std::uint64_t missing);
  // A tick back: the last slip was a latency.
  void take_back();
  // Samples that were taken for missing although ticks may be the reason.
  [[nodiscard]] std::uint64_t unsure_losses() const;

private:
  [[nodiscard]] bool are_regular() const;

  std::vector<double> samples_;
  std::uint64_t missing_ = 0;
};

} // namespace dyncal::analysis
