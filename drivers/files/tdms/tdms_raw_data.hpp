// Where in the raw data of one segment of a TDMS file the values of its channels are
// (tdms_layout.hpp explains the forms). Plain functions, any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "drivers/files/tdms/tdms_layout.hpp"

namespace dyncal::drivers::files {

struct TdmsPlacedChannel {
  TdmsChannel* channel = nullptr; // takes the stretches
  const TdmsIndex* index = nullptr;
};

struct TdmsRawData { // of a segment
  std::uint64_t place = 0;
  std::uint64_t bytes = 0;
  bool big_endian = false;
  bool interleaved = false;
  bool closed = true;
};

// Adds the segment's values to its channels. Fails with the problem in one sentence.
[[nodiscard]] tl::expected<void, std::string>
place_tdms_data(const std::vector<TdmsPlacedChannel>& channels, const TdmsRawData& data);

} // namespace dyncal::drivers::files
