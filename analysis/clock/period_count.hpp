// How many sample periods lie between the stamps of a record, whatever is missing from it: the mean
// sample interval, and samples that are missing although the numbering does not show it.
//
// What a period is follows from the first 64 intervals, their median m. From then on the distance d
// of a sample from the last one in order is k periods: as many as the numbers say when d lies
// within m/4 + 1e-4 k m of k m, else as many as the stamps say when k is at most 1000 and d within
// m/4 of k m; then k less the numbered ones are missing unnumbered. A stamp that fits neither is
// passed over; after eight of these a new stretch begins, and what lies between counts for nothing.
//
// Mean interval: sum of all d over the sum of all k, exact in integers. Nothing is counted of a
// source whose first intervals are not periods in nine of ten cases. Units: ns. One thread.
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
  // Learns from what there is when that is less than usual.
  void finish();

  // Since the last call; each stands where it was found.
  [[nodiscard]] std::vector<UnnumberedGap> take_gaps();

  [[nodiscard]] bool knows_period() const { return period_ns_ > 0.0; }
  [[nodiscard]] std::uint64_t periods() const { return periods_; }
  [[nodiscard]] std::uint64_t stretches() const { return stretches_; }
  [[nodiscard]] std::uint64_t unnumbered() const { return unnumbered_; }
  [[nodiscard]] double mean_ns() const; // REQUIRES: periods() > 0

private:
  struct Sample {
    std::uint64_t number = 0;
    std::int64_t stamp_ns = 0;
    bool begins_stretch = false;
  };

  void learn();
  void count(const Sample& sample);
  // Of this distance; empty when it is not a whole number of them.
  [[nodiscard]] std::optional<std::uint64_t> periods_in(std::int64_t distance_ns,
                                                        std::uint64_t numbered) const;

  bool learned_ = false;
  double period_ns_ = 0.0;
  std::vector<Sample> first_; // until the period is known
  bool begins_stretch_ = true;
  Sample last_; // in order
  std::uint32_t passed_over_ = 0;
  std::int64_t span_ns_ = 0;
  std::uint64_t periods_ = 0;
  std::uint64_t stretches_ = 0;
  std::uint64_t unnumbered_ = 0;
  std::vector<UnnumberedGap> gaps_;
};

} // namespace dyncal::analysis
