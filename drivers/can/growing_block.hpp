// A block of samples that grows by one sample at a time: numbers without a gap, at most
// `max_span_ns` from its first stamp to its last. A stamp that does not rise gets its flag. Bound:
// the span. One thread; does not fail.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/sample_block.hpp"

namespace dyncal::drivers::can {

struct SampleHead {
  std::uint64_t number = 0;
  std::int64_t stamp_ns = 0;
  double u_stamp_s = 0.0;
  std::uint8_t flags = 0;
  std::int64_t received_utc_ns = 0;
};

class GrowingBlock {
public:
  static constexpr std::int64_t max_span_ns = 50'000'000;

  void begin_session() { last_stamp_ns_.reset(); }
  [[nodiscard]] bool empty() const { return block_.samples == 0; }
  // The block is full, or the next sample does not go on from it.
  [[nodiscard]] bool must_go_before(std::uint64_t number, std::int64_t stamp_ns) const;
  // `values`: one of each channel. False: its stamp is not trusted.
  bool add(SampleHead head, const std::vector<double>& values);
  // Channel after channel, as blocks are; leaves an empty one.
  [[nodiscard]] SampleBlock release();

private:
  SampleBlock block_;
  std::uint64_t next_number_ = 0;
  std::optional<std::int64_t> last_stamp_ns_;
  std::vector<double> rows_; // sample after sample
};

} // namespace dyncal::drivers::can
