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
// Mean interval: (last - first) / periods, exact in integers. Stamps that move five times and more,
// by a fifth of the time at most, or by one tick of their own, do so as they are made (coarse
// ticks, FIFO read in batches): that is part of the mean. Others are jumps of the clock, or long
// pauses; they are left out, and counted. Nothing is counted of a source whose first intervals are
// not periods in nine of ten cases, or not most of the time. Units: ns. One thread.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

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
  void restart();
  // Learns from what there is when that is less than usual, and counts what waits for a next one.
  void finish();

  // Since the last call; each stands where it was found.
  [[nodiscard]] std::vector<UnnumberedGap> take_gaps();

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
  // of the FIFO and ends before one, and so is wrong by the mean move, and moves scatter. 0:
  // nothing of the kind.
  [[nodiscard]] double u_ends_ns() const;

private:
  struct Sample {
    std::uint64_t number = 0;
    std::int64_t stamp_ns = 0;
    bool begins_stretch = false;
  };

  void learn();
  void learn_tick(const std::vector<double>& intervals_ns);
  void count(const Sample& sample);
  void count_behind_doubtful(const Sample& sample);
  void accept(const Sample& sample, std::uint64_t periods);
  void begin_stretch(const Sample& sample);
  void accept_missing();
  void accept_move(const Sample& sample);
  void follow_tick(std::int64_t distance_ns);
  [[nodiscard]] bool moves_as_made() const;
  [[nodiscard]] bool in_order(const Sample& before, const Sample& sample) const;
  // Periods from the last one in order to the doubtful one; empty when these are as many as the
  // numbers say, or not known.
  [[nodiscard]] std::optional<std::uint64_t> periods_to_doubtful() const;
  [[nodiscard]] double margin_ns() const;
  [[nodiscard]] double best_period_ns() const;

  bool learned_ = false;
  double period_ns_ = 0.0;
  double scatter_ns_ = 0.0;     // of the first intervals
  double coarse_tick_ns_ = 0.0; // that the first intervals show; 0: none
  std::int64_t tick_ns_ = 0;    // all distances are multiples of it; 0: of no tick worth naming
  std::vector<Sample> first_;   // until the period is known
  bool begins_stretch_ = true;
  Sample last_;                    // in order
  std::optional<Sample> doubtful_; // that does not follow in order
  std::uint32_t followers_ = 0;    // of it, in its order
  std::uint32_t passed_over_ = 0;
  std::int64_t span_ns_ = 0;
  std::uint64_t periods_ = 0;
  std::uint64_t stretches_ = 0;
  std::uint64_t unnumbered_ = 0;
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
