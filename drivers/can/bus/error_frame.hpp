// What an error frame of the kernel reports (linux/can/error.h), as text. Pure function; any
// thread.
#pragma once

#include <cstdint>
#include <span>

#include "drivers/can/bus/frame_source.hpp"

namespace dyncal::drivers::can {

// `classes` is the id of the error frame without its flags, `data` its eight bytes.
[[nodiscard]] BusFault bus_fault(std::uint32_t classes, std::span<const std::uint8_t, 8> data);

} // namespace dyncal::drivers::can
