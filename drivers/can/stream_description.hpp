// What a sensor's stream says of itself, and what the bus adds to the uncertainty of its stamps.
// Plain functions, any thread.
#pragma once

#include <filesystem>
#include <string>

#include "drivers/can/bus/frame_source.hpp"
#include "drivers/can/sensor_layout.hpp"
#include "drivers/can/stream_settings.hpp"
#include "drivers/sample_sink.hpp"

namespace dyncal::drivers::can {

struct StreamTime {
  TimeSource source = TimeSource::kernel_stamp;
  bool by_adapter = false; // its clock stamps the frames
  double u_s = 0.0;        // standard uncertainty of a stamp
};

[[nodiscard]] SourceDescription describe_stream(const StreamSettings& settings,
                                                const SensorLayout& layout,
                                                const std::filesystem::path& dbc_path,
                                                const std::string& link_name,
                                                const StreamTime& time);

// Standard uncertainty of the wait for a bus that others share: a longest frame of another device
// may have been on it, 0 ... that, one-sided.
[[nodiscard]] double u_bus_wait_s(const LinkState& link, const BitRates& rates);

} // namespace dyncal::drivers::can
