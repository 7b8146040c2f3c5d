// Which sample periods are possible where all stamps are whole ticks: the lines on which samples
// may lie.
//
//   t_n = a + p n,  s_n <= t_n < s_n + T,  L more on both sides
//
// with T the tick, s_n the stamp, n the number of the sample, L a bound of the latency of stamps:
// T / 16, T / 2 where stamps go back and forth between two ticks. Every sample cuts two sides from
// the plane of (p, t_n); what is left is a convex polygon with a few corners. An empty one: no such
// line, samples are missing or stamps are wrong. The polygon grows about its middle by 3e-5 a
// sample, so that a sample clock may wander. Units: ns. One thread.
#pragma once

#include <cstdint>
#include <vector>

namespace dyncal::analysis {

struct PeriodRange {
  double min_ns = 0.0;
  double max_ns = 0.0;
};

class TickLine {
public:
  static constexpr double least_latency_ticks = 1.0 / 16.0;
  static constexpr double most_latency_ticks = 1.0 / 2.0;
  static constexpr double least_tick_periods = 1.0 / 4.0; // finer ones are told by the distances

  TickLine(double tick_ns, const PeriodRange& periods, double latency_ticks = least_latency_ticks);

  // The sample from which on all lie on one line; the periods that are possible stay, but for a
  // margin.
  void begin(std::uint64_t number, std::int64_t stamp_ns);
  // From here on with the most latency.
  void widen(std::uint64_t number, std::int64_t stamp_ns);
  [[nodiscard]] bool is_wide() const { return latency_ns_ >= most_latency_ticks * tick_ns_; }
  [[nodiscard]] bool admits(std::uint64_t number, std::int64_t stamp_ns) const;
  // Whether it was admitted; one that is not changes nothing. REQUIRES (both): begin().
  bool add(std::uint64_t number, std::int64_t stamp_ns);

  [[nodiscard]] PeriodRange periods() const;
  [[nodiscard]] double period_ns() const; // the middle of these
  [[nodiscard]] double tick_ns() const { return tick_ns_; }
  // How far a stamp is behind the middle of the lines.
  [[nodiscard]] double late_ns(std::uint64_t number, std::int64_t stamp_ns) const;

private:
  struct Corner {
    double period_ns = 0.0;
    double from_stamp_ns = 0.0; // of the line at the newest sample
  };
  [[nodiscard]] std::vector<Corner> cut(std::uint64_t number, std::int64_t stamp_ns) const;
  [[nodiscard]] Corner moved(const Corner& corner, std::uint64_t number,
                             std::int64_t stamp_ns) const;
  void grow(double samples);

  double tick_ns_;
  double latency_ns_;
  std::vector<Corner> corners_;
  std::uint64_t number_ = 0;
  std::int64_t stamp_ns_ = 0;
};

} // namespace dyncal::analysis
