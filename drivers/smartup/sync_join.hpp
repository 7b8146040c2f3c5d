// Joins a sensor with the sync ADCs that later firmware sends as a sensor of its own: both carry
// the same stamps, taken at the same edge.
//
// Samples of the two streams belong together when their stamps are equal; order decides between
// equal ones. A sensor sample whose partner never came goes on without it; a partner without a
// sample is left out and counted. At most max_wait samples wait. One thread at a time; never fails.
#pragma once

#include <cstdint>
#include <deque>

#include "drivers/smartup/sample_row.hpp"

namespace dyncal::drivers::smartup {

class SyncJoin {
public:
  static constexpr std::size_t max_wait = 1024;

  void add(const SampleRow& row);
  void add_sync(std::int64_t stamp_ns, std::uint16_t present,
                const std::array<float, channels_of_unit>& values);

  // The next row that is ready, in order; false when there is none yet.
  bool take(SampleRow& row);

  // Everything that waits is ready now, with or without partner: the numbering ends here.
  void release() { releasing_ = rows_.size(); }

  // Forgets the rows that wait, and says how many they were.
  std::size_t discard();

  [[nodiscard]] std::uint64_t without_sync() const { return without_sync_; }
  [[nodiscard]] std::uint64_t sync_left_out() const { return sync_left_out_; }

private:
  struct SyncSample {
    std::int64_t stamp_ns = 0;
    std::uint16_t present = 0;
    std::array<float, channels_of_unit> values{};
  };
  void drop_sync(std::size_t count);

  std::deque<SampleRow> rows_;
  std::deque<SyncSample> sync_;
  std::size_t releasing_ = 0; // that many rows at the front wait no longer
  std::uint64_t without_sync_ = 0;
  std::uint64_t sync_left_out_ = 0;
};

} // namespace dyncal::drivers::smartup
