// How many sample periods lie between the stamps of a record, whatever is missing from it: the mean
// sample interval, and samples that are missing although the numbering does not show it.
//
// The first 64 intervals tell the period m: their median; where all stamps are multiples of a tick
// T of m/8 and more, the mean of what lies within a tick of it, and T widens every margin below. A
// sample whose distance d from the last one in order is as many periods as the numbers say, within
// m/4 + 1e-4 k m, follows in order. One that does not waits for the next:
//
//   the next one fits the old order         its stamp was wrong, it counts for nothing
//   d is k > numbered periods within m/4    samples are missing; k up to 1000, or as far as m is
//                                           known to 1/8 of a period
//   eight others follow it in order         the stamps moved against the samples by e = d - k m
//
// With ticks above m/4 the order is that of ticked_samples.hpp; where the intervals are alike, gaps
// of one wait until it is known whether these are ticks (tick_gaps.hpp).
//
// Mean interval: (last - first) / periods, exact in integers. Stamps that move five times and more,
// by a fifth of the time at most, or by one tick of their own, do so as they are made (FIFO read in
// batches): that is part of the mean. Others are jumps of the clock, or long pauses; they are left
// out, and counted. Nothing is counted of a source whose first intervals are not periods in nine of
// ten cases, or not most of the time. Units: ns. One thread.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "analysis/clock/first_stamps.hpp"
#include "analysis/clock/slip_spacing.hpp"
#include "analysis/clock/tick_gaps.hpp"
#include "analysis/clock/ticked_samples.hpp"

namespace dyncal::analysis {

struct UnnumberedGap { // between these stamps, both excluded
  std::int64_t before_ns = 0;
  std::int64_t after_ns = 0;
  std::uint64_t missing = 0;
};

class PeriodCount {
public:
  // The next sample with a trusted stamp.
  void add(std::uint64_t sample, std::int64_t stamp_ns);
  // The numbering begins anew: the next sample begins a stretch.
  void restart() { begins_stretch_ = true; }
  // Learns from what there is when that is less than usual, and counts what waits for a next one.
  void finish();

  // Since the last call; each stands where it was found.
  [[nodiscard]] std::vector<UnnumberedGap> take_gaps() { return std::exchange(gaps_, {}); }

  [[nodiscard]] bool knows_period() const { return period_ns_ > 0.0; }
  [[nodiscard]] std::uint64_t periods() const;
  [[nodiscard]] std::uint64_t stretches() const { return stretches_ + left_out_jumps(); }
  [[nodiscard]] std::uint64_t unnumbered() const { return unnumbered_; }
  [[nodiscard]] double mean_ns() const; // REQUIRES: periods() > 0
  // Jumps of the clock that the mean leaves out, and the largest of them with its sign.
  [[nodiscard]] std::uint64_t left_out_jumps() const { return moves_as_made() ? 0 : moves_; }
  [[nodiscard]] double largest_jump_ns() const { return largest_ns_; }
  // Standard uncertainty of the distance of the first from the last stamp by how stamps are made:
  // both ends lie anywhere within a tick T (T^2 / 6); a record begins, as a rule, behind a read-out
  // of the FIFO and ends before one, and so is wrong by the mean move, and moves scatter; as many
  // ticks as there are gaps that may be ticks or losses: all losses, where ticks are of about a
  // period and losses have hidden the line on which they lie. 0: nothing of the kind.
  [[nodiscard]] double u_ends_ns() const;
  // Stamps are whole ticks of more than a quarter of a period; 0: not so.
  [[nodiscard]] double coarse_tick_ns() const {
    return ticked_ ? static_cast<double>(tick_ns_) : 0.0;
  }

private:
  void learn();
  void settle();
  void count(const TimedSample& sample);
  void count_behind_doubtful(const TimedSample& sample);
  void accept(const TimedSample& sample, std::uint64_t periods);
  void begin_stretch(const TimedSample& sample);
  void accept_missing();
  void accept_move(const TimedSample& sample);
  void count_move(std::int64_t across_ns, std::uint64_t numbered);
  void count_ticked(std::span<const TickedSample> samples);
  void watch_slip(const TickedSample& sample);
  void count_in_order(const TimedSample& sample);
  void explain_gaps();
  [[nodiscard]] bool turn_to_ticks(std::int64_t distance_ns);
  void take_waiting_as_losses();
  void add_missing(std::int64_t before_ns, std::int64_t after_ns, std::uint64_t missing);
  void follow_tick(std::int64_t distance_ns);
  [[nodiscard]] bool moves_as_made() const;
  [[nodiscard]] std::uint64_t losses_like_ticks() const;
  [[nodiscard]] bool in_order(const TimedSample& before, const TimedSample& sample) const;
  // Periods from the last one in order to the doubtful one; empty when these are as many as the
  // numbers say, or not known.
  [[nodiscard]] std::optional<std::uint64_t> periods_to_doubtful() const;
  [[nodiscard]] double margin_ns() const;
  [[nodiscard]] double best_period_ns() const;

  bool learned_ = false;
  double period_ns_ = 0.0;
  double scatter_ns_ = 0.0;        // of the first intervals
  double coarse_tick_ns_ = 0.0;    // that the first intervals show; 0: none
  std::int64_t tick_ns_ = 0;       // all distances are multiples of it; 0: of no tick worth naming
  std::vector<TimedSample> first_; // until the period is known
  std::optional<TickGaps> alike_;  // while all intervals are alike
  std::optional<TickedSamples> ticked_;
  bool begins_stretch_ = true;
  TimedSample last_;                    // in order
  std::optional<TimedSample> doubtful_; // that does not follow in order
  std::uint32_t followers_ = 0;         // of it, in its order
  std::uint32_t passed_over_ = 0;
  std::int64_t span_ns_ = 0;
  std::uint64_t periods_ = 0;
  std::uint64_t stretches_ = 0;
  std::uint64_t unnumbered_ = 0;
  std::uint64_t unsure_ticks_ = 0;    // that were taken for losses
  std::uint64_t unsure_as_ticks_ = 0; // that may be losses, until more ticks follow on their line
  std::uint64_t ticks_on_line_ = 0;
  SlipSpacing slips_; // of ticks of about a period
  std::uint64_t moves_ = 0;
  std::int64_t span_across_moves_ns_ = 0;
  std::uint64_t periods_across_moves_ = 0;
  double sum_of_moves_ns_ = 0.0;
  double size_of_moves_ns_ = 0.0; // sum without signs
  double squares_of_moves_ns2_ = 0.0;
  double largest_ns_ = 0.0;
  std::vector<UnnumberedGap> gaps_;
};

} // namespace dyncal::analysis
