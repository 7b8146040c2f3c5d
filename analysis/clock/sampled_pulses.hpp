// Where the pulses of a pulse-per-second output are among the samples of a channel that records
// them.
//
// A filter with gain 1 delays a step, by its area, by the group delay that it has towards 0 Hz:
//
//   e = k_1 - 1/2 + sum_(k = k_1)^(k_2) (h - x_k) / (h - l)
//
// l, h are the means of 32 samples before k_1 and after k_2, which are 16 samples before and after
// the crossing of the middle. The channels of the instrument whose filter is the same are delayed
// alike, so that e is the instant for their samples. Of noise s it has 8 s / (h - l) samples or so.
//
// Samples of a channel without a filter against aliasing jump from one level to the other: then
// nobody knows where between two samples, u = 1 / sqrt(12) of a sample, the same from pulse to
// pulse. They are told by levels that are as quiet beside the edge as far from it.
//
// What is no pulse: an edge whose levels are not a quarter of the largest step apart or wander by a
// hundredth of it within their 32 samples (an AC-coupled input: `restless`), or that another one is
// nearer to than 48 samples. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dyncal::analysis {

struct SampledPulse {
  std::uint64_t sample = 0; // and `part` of the distance to the next one
  double part = 0.0;
  double u_samples = 0.0; // that all pulses share: 0, or that of a channel without a filter
};

class SampledPulses {
public:
  enum class Edge { rising, falling };

  // Levels are learnt from the first `samples_per_second` and a quarter.
  SampledPulses(double samples_per_second, Edge edge);

  // Consecutive samples; a pulse is there once 48 samples have followed its edge.
  [[nodiscard]] std::vector<SampledPulse> push(std::span<const double> values);
  // Samples are missing before the one of this number, which comes next.
  void restart(std::uint64_t sample);

  [[nodiscard]] std::uint64_t restless() const { return restless_; }

private:
  void learn_levels();
  void find(std::vector<SampledPulse>& pulses);
  void take(std::size_t crossing, std::vector<SampledPulse>& pulses);

  std::size_t learnt_samples_;
  double sign_; // falling edges rise with it
  std::vector<double> kept_;
  std::uint64_t first_ = 0;  // number of kept_[0]
  std::size_t searched_ = 0; // of kept_
  bool knows_levels_ = false;
  bool is_high_ = false;
  double low_ = 0.0, high_ = 0.0;
  std::uint64_t restless_ = 0;
};

} // namespace dyncal::analysis
