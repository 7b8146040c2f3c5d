// One sample of one sensor on its way from the datagram to a block. Plain data.
#pragma once

#include <array>
#include <cstdint>

#include "drivers/smartup/datagram.hpp"

namespace dyncal::drivers::smartup {

// The host's clocks at one instant.
struct HostTime {
  std::int64_t monotonic_ns = 0; // for durations
  std::int64_t utc_ns = 0;
};

struct SampleRow {
  std::uint64_t sample = 0; // unwrapped number
  std::int64_t stamp_ns = 0;
  std::uint32_t stamp_uncertainty_ns = 0; // standard uncertainty
  std::uint8_t flags = 0;                 // StampFlag bits
  std::uint16_t present = 0;
  std::array<float, channels_of_unit> values{};
  std::uint16_t sync_present =
      0; // of the sync sensor, when the unit sends its ADCs as a sensor of their own
  std::array<float, channels_of_unit> sync_values{};
};

// The columns of a block: channels of the sensor, then channels of its sync sensor.
struct Columns {
  std::uint16_t own = 0;
  std::uint16_t sync = 0;

  friend bool operator==(const Columns&, const Columns&) = default;
};

} // namespace dyncal::drivers::smartup
