// What a laboratory states of an instrument, for its certificates and of the ranges of its
// channels: in place of what the instrument or the file says of itself, which may be nothing, or
// wrong. Plain data, any thread.
#pragma once

#include <map>
#include <string>

#include "drivers/sample_block.hpp"

namespace dyncal::inline contract {

struct StatedRange { // minimum == maximum: the channel has none
  double minimum = 0.0;
  double maximum = 0.0;

  friend bool operator==(const StatedRange&, const StatedRange&) = default;
};

struct DeviceIdentity { // empty: what the instrument says
  std::string device;
  std::string serial;
  std::string firmware;
  std::map<std::string, StatedRange> ranges{}; // by channel, in its unit
};

[[nodiscard]] drivers::SourceDescription with_identity(drivers::SourceDescription description,
                                                       const DeviceIdentity& identity);

} // namespace dyncal::inline contract
