#include "drivers/can/stream_description.hpp"

#include <cmath>

#include "drivers/can/time/frame_duration.hpp"

namespace dyncal::drivers::can {

SourceDescription describe_stream(const StreamSettings& settings, const SensorLayout& layout,
                                  const std::filesystem::path& dbc_path,
                                  const std::string& link_name, const StreamTime& time) {
  SourceDescription description;
  for (const DbcMessage* message : layout.messages) {
    description.device += (description.device.empty() ? "" : ", ") + message->name;
  }
  description.device += " of " + dbc_path.filename().string();
  description.driver = "can " + link_name + ", time by " + to_string(time.source);
  if (time.by_adapter && time.source != TimeSource::hardware_stamp) {
    description.driver += " over hardware-stamp";
  }
  for (const ChannelLayout& channel : layout.channels) {
    description.channels.push_back(channel.description);
  }
  description.nominal_rate_hz = layout.nominal_rate_hz;
  description.time_base = settings.time_base;
  description.stamp_instant =
      time.source == TimeSource::canopen_sync ? StampInstant::frame_end : StampInstant::frame_start;
  description.tick_s = time.by_adapter ? settings.hardware_tick_s : 0.0;
  description.stamp_uncertainty_s = time.u_s;
  return description;
}

double u_bus_wait_s(const LinkState& link, const BitRates& rates) {
  return max_frame_s(link.fd && rates.data_per_s > 0.0, true, link.fd ? 64 : 8, rates) /
         std::sqrt(3.0);
}

} // namespace dyncal::drivers::can
