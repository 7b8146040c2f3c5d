// Numbers that lie in a file at regular distances, one after the other as doubles.
//
// Integers of 64 bits are rounded to the nearest double. The file outlives the object. One thread.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "drivers/files/tdms/tdms_property.hpp"

namespace dyncal::drivers::files {

// Values of one type at regular distances, in chunks at regular distances.
struct ValueStretch {
  TdmsType type = TdmsType::f64;
  bool big_endian = false;
  int bit = -1;             // of a digital line; -1: the whole number
  std::uint64_t place = 0;  // bytes from the start of the file to the first value
  std::uint64_t stride = 0; // bytes from value to value
  std::uint64_t values = 0; // of a chunk
  std::uint64_t chunks = 1;
  std::uint64_t chunk_bytes = 0; // from chunk to chunk
};

class StridedValues {
public:
  // REQUIRES: the stretches lie within the file, and their values are real numbers.
  StridedValues(std::string_view file, std::vector<ValueStretch> stretches)
      : file_(file), stretches_(std::move(stretches)) {}

  // The next ones. REQUIRES: there are as many.
  void read(std::span<double> to);

private:
  std::string_view file_;
  std::vector<ValueStretch> stretches_;
  std::size_t stretch_ = 0; // of the next value
  std::uint64_t chunk_ = 0;
  std::uint64_t value_ = 0; // within the chunk
};

} // namespace dyncal::drivers::files
