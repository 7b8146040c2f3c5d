// What the status of a CAN source says: counts with their causes, the state of the bus in words.
// Plain functions, any thread.
#pragma once

#include <chrono>
#include <string>

#include "drivers/can/sensor_stream.hpp"
#include "services/source/source_publisher.hpp"

namespace dyncal::services::can {

[[nodiscard]] SourceCounts to_counts(const drivers::can::SensorStream& stream);

// "" when the bus is as it should be. `listened`: for how long frames have been waited for.
[[nodiscard]] std::string to_message(const drivers::can::SensorStream& stream,
                                     std::chrono::nanoseconds listened);

} // namespace dyncal::services::can
