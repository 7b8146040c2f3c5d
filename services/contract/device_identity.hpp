// What a laboratory states of an instrument, for its certificates: in place of what the instrument
// or the file says of itself, which may be nothing. Plain data, any thread.
#pragma once

#include <string>

#include "drivers/sample_block.hpp"

namespace dyncal::services {

struct DeviceIdentity { // empty: what the instrument says
  std::string device;
  std::string serial;
  std::string firmware;
};

[[nodiscard]] drivers::SourceDescription with_identity(drivers::SourceDescription description,
                                                       const DeviceIdentity& identity);

} // namespace dyncal::services
