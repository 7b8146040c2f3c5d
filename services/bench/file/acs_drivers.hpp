// The one table of drivers of analogue calibration systems that are made by the description in
// their own folder (drivers/acs_driver.hpp): a new one is a row of acs_drivers.cpp. Immutable; any
// thread.
#pragma once

#include <span>
#include <string_view>

#include "drivers/acs_driver.hpp"

namespace dyncal::inline bench {

[[nodiscard]] std::span<const drivers::AcsDriver* const> acs_drivers();

// nullptr: there is none of that word.
[[nodiscard]] const drivers::AcsDriver* acs_driver_named(std::string_view name);

} // namespace dyncal::inline bench
