// UTC of the samples of an instrument that records the pulses of a GPS receiver beside its signals.
//
//   t_k = a + b s_k     t_k: the second of pulse k, s_k: its place among the samples
//
// by least squares over the last 32 pulses, referred to the last one. Residuals r give
// u^2(t(s)) = r^2 (1/n + (s - mean)^2 / S) + (w (s - s_n) / b)^2 behind the last pulse, w = 1e-8:
// by so much crystals wander within a minute. What all pulses share (cable, receiver) is not in it.
// NMIJ's way to link an interferometer to UTC (arXiv 2509.01034).
//
// The first pulse is the second that the host's clock is nearest to, so that this has to be right
// within half a second, the way of the samples included. Later ones lie on the grid of whole
// seconds; one that does not (1 ms before eight are known, then 6 u, but 0.1 us and a hundredth of
// a sample at least) is left out. Three in a row that lie on a grid of their own say that the
// pulses have moved, or samples are missing: the clock begins anew with them.
//
// No synchronisation.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/clock/sampled_pulses.hpp"

namespace dyncal::analysis {

inline constexpr std::size_t pulses_of_line = 32;
inline constexpr std::size_t pulses_needed = 8;

class PulseClock {
public:
  explicit PulseClock(double samples_per_second) : samples_per_second_(samples_per_second) {}

  enum class Answer { taken, left_out, moved };
  // `host_utc_ns`: of the host when the pulse was recorded, as well as it is known.
  Answer add(const SampledPulse& pulse, std::int64_t host_utc_ns);

  // Eight pulses and more.
  [[nodiscard]] bool is_known() const { return line_.has_value(); }
  // REQUIRES: is_known().
  [[nodiscard]] std::int64_t utc_ns(std::uint64_t sample) const;
  [[nodiscard]] double u_s(std::uint64_t sample) const;
  // Seconds from the last pulse to the sample.
  [[nodiscard]] double since_pulse_s(std::uint64_t sample) const;

private:
  struct TimedPulse {
    SampledPulse place;
    std::int64_t second = 0;
  };
  struct Line { // about the newest pulse, in seconds and samples
    double offset_s = 0.0;
    double s_per_sample = 0.0;
    double mean_samples = 0.0;
    double spread_samples2 = 0.0;
    double residual_s = 0.0;
    double shared_s = 0.0;
  };

  void fit();
  [[nodiscard]] double samples_from_newest(std::uint64_t sample) const;
  [[nodiscard]] std::optional<std::int64_t> second_of(const SampledPulse& pulse) const;
  Answer take_other(const SampledPulse& pulse, std::int64_t host_utc_ns);

  double samples_per_second_;
  std::deque<TimedPulse> pulses_;
  std::vector<std::pair<SampledPulse, std::int64_t>> others_; // off the grid, with the host's time
  std::optional<Line> line_;
};

} // namespace dyncal::analysis
