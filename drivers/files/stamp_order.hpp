// Flags the stamps of a file that are not in order, so that one of them does not cost the whole
// file.
//
// A stamp that repeats the last one in order is stamp_repeated, an earlier one stamp_backwards;
// samples keep their values and numbers. After eight of them in a row that rise among themselves
// time was set back, and stamps are trusted again.
//
// A stamp more than eight intervals ahead is wrong when one of the 64 behind it comes back to the
// old order: it and those between are stamp_second_slip, less than a second
// stamp_offset_below_second. Where the samples that come next are not in the block, a stamp of more
// than a second ahead is not trusted either: when it was right, this costs one sample. One thread.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "drivers/sample_block.hpp"

namespace dyncal::drivers::files {

class StampOrder {
public:
  // The next samples of the file; sets their flags when one of them is not in order.
  void check(SampleBlock& block);

private:
  [[nodiscard]] std::uint8_t flag_of(std::int64_t stamp_ns);
  // How many of the stamps, from the first on, are ahead of the order.
  [[nodiscard]] std::size_t ahead(std::span<const std::int64_t> stamps_ns) const;

  std::optional<std::int64_t> last_ns_; // in order
  std::uint64_t interval_ns_ = 0;       // of the last two in order
  std::int64_t before_ns_ = 0;          // the stamp before, in order or not
  unsigned behind_ = 0;                 // rising ones since, behind the last in order
};

} // namespace dyncal::drivers::files
