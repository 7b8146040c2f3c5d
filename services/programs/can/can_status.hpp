// The sentence of the status of a CAN source: what is wrong with its bus, and what to do about it.
// Plain functions, any thread.
#pragma once

#include <chrono>
#include <string>

#include "drivers/can/sensor_stream.hpp"

namespace dyncal::inline programs::can {

// "" when the bus is as it should be. `listened`: for how long frames have been waited for.
[[nodiscard]] std::string to_message(const drivers::can::SensorStream& stream,
                                     std::chrono::nanoseconds listened);

} // namespace dyncal::inline programs::can
