// The DDS implementations that the bus has adapters for. Who uses the bus needs none of their
// names: parse_vendor() and vendors_in_this_build() give them (services/bus/bus.hpp). Plain data.
#pragma once

#include "services/bus/bus.hpp"

namespace dyncal::bus {

enum class Vendor : std::uint8_t { cyclone_dds, fast_dds };

} // namespace dyncal::bus
