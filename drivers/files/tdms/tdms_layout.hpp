// Where the values of every channel of a TDMS file (LabVIEW, NI-DAQmx) are, and its properties.
//
// A file is a list of segments. Each has a lead-in of 28 bytes, metadata, which amend those of the
// segment before or replace them, and raw data, in chunks:
//
//   contiguous    a a a a b b b b | a a a a b b b b      channel after channel, chunk after chunk
//   interleaved   a b a b a b a b                        row after row
//   DAQmx         rows of a buffer, then those of the next, with a count at a place of the row
//
// The last segment may never have been closed, as when the program that wrote it died: what it has
// counts, but for a row that not all its channels have. Every other end within a segment is that of
// a cut file. The index file (.tdms_index) is not needed. Plain data, any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <tl/expected.hpp>

#include "drivers/files/tdms/strided_values.hpp"
#include "drivers/files/tdms/tdms_index.hpp"

namespace dyncal::drivers::files {

struct TdmsChannel {
  std::string group;
  std::string name;
  TdmsType type = TdmsType::none; // none: it never had data
  TdmsProperties properties{};
  std::uint64_t values = 0;
  std::map<std::uint32_t, std::vector<ValueStretch>> data{}; // by scaler, or tdms_raw_input
};

// What a later segment says of the start of a channel that has values already.
struct TdmsRestart {
  std::size_t channel = 0;  // of TdmsLayout::channels
  std::uint64_t values = 0; // before it
  std::int64_t unix_ns = 0;
};

struct TdmsLayout {
  TdmsProperties properties;
  std::map<std::string, TdmsProperties> groups;
  std::vector<TdmsChannel> channels;
  std::vector<TdmsRestart> restarts;

  // Fails with the problem in one sentence that names the place, for the caller to say in which
  // file.
  [[nodiscard]] static tl::expected<TdmsLayout, std::string> of(std::string_view file);
};

} // namespace dyncal::drivers::files
