// What a segment of a TDMS file says of the raw data of one channel: type and number of its values
// in a chunk, or, for raw data of DAQmx, where in which buffer its counts are. Plain data.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "drivers/files/tdms/tdms_property.hpp"

namespace dyncal::drivers::files {

// The channel's own values, where no scaler of DAQmx has a number.
inline constexpr std::uint32_t tdms_raw_input = 0xFFFFFFFF;

struct TdmsScaler {
  std::uint32_t id = tdms_raw_input; // as scalings name it
  TdmsType type = TdmsType::none;
  std::uint32_t buffer = 0;
  std::uint32_t byte_in_row = 0;
  int bit = -1; // of a digital line, in its lowest byte; -1: the whole number
};

struct TdmsIndex {
  TdmsType type = TdmsType::none;
  std::uint64_t values = 0; // in a chunk
  std::uint64_t bytes = 0;  // in a chunk, not of DAQmx
  bool is_daqmx = false;
  std::vector<TdmsScaler> scalers{};      // of DAQmx
  std::vector<std::uint32_t> row_bytes{}; // of every buffer of DAQmx
};

// `header` stands before it and tells its kind: 20, 28, or one of the two of DAQmx. Fails with the
// problem in one sentence.
[[nodiscard]] tl::expected<TdmsIndex, std::string> read_tdms_index(TdmsCursor& cursor,
                                                                   std::uint32_t header);

} // namespace dyncal::drivers::files
