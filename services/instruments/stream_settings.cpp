#include "services/instruments/stream_settings.hpp"

#include "drivers/can/time/system_clock.hpp"

namespace dyncal::inline instruments {

drivers::can::StreamSettings stream_settings(const SourceSettings& source) {
  const auto& can = std::get<CanSourceSettings>(source.driver);
  drivers::can::StreamSettings stream = can;
  stream.channels = source.channels;
  stream.units = source.units;
  stream.time_base = source.time_base;
  // This host's clock tells nothing of the one that stamped a log.
  if (!can.log.empty() && !stream.u_utc_s) {
    stream.u_utc_s = drivers::can::u_undisciplined_clock_s();
  }
  return stream;
}

} // namespace dyncal::inline instruments
