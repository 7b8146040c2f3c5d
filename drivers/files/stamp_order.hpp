// Flags the stamps of a file that are not later than the last one in order, so that one of them
// does not cost the whole file.
//
// A stamp that repeats the last one in order is stamp_repeated, an earlier one stamp_backwards;
// samples keep their values and numbers. After eight of them in a row that rise among themselves
// time was set back, and stamps are trusted again. One thread.
#pragma once

#include <cstdint>
#include <optional>

#include "drivers/sample_block.hpp"

namespace dyncal::drivers::files {

class StampOrder {
public:
  // The next samples of the file; sets their flags when one of them is not in order.
  void check(SampleBlock& block);

private:
  [[nodiscard]] std::uint8_t flag_of(std::int64_t stamp_ns);

  std::optional<std::int64_t> last_ns_; // in order
  std::int64_t before_ns_ = 0;          // the stamp before, in order or not
  unsigned behind_ = 0;                 // rising ones since, behind the last in order
};

} // namespace dyncal::drivers::files
