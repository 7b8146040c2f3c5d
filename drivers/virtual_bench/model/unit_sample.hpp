// One sample of the SmartUp Unit and what its channels mean, before they are put into datagrams.
// Plain data; any thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace dyncal::drivers::virtual_bench {

constexpr std::size_t unit_channels = 16; // Data_01..Data_16

struct UnitSample {
  std::uint32_t sample_number = 0; // 1, 2, 3, ... of the sensor; lost samples are counted too
  std::int64_t utc_ns = 0;
  std::uint32_t uncertainty_ns = 0;
  std::uint64_t ticks = 0;
  std::array<std::optional<float>, unit_channels> data; // nothing: not measured
};

struct UnitChannel {
  std::size_t index = 0; // 0 is Data_01
  std::string name;      // as dyncal calls it: acceleration_z
  std::string quantity;  // as DSCP says it
  std::string unit;
  std::string hierarchy;
  double minimum = 0.0;
  double maximum = 0.0;
  double steps = 0.0;   // from minimum to maximum
  bool declared = true; // false: DSCP does not tell of it (the sync ADCs)
};

} // namespace dyncal::drivers::virtual_bench
