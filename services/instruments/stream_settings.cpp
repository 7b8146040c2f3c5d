#include "services/instruments/stream_settings.hpp"

#include "drivers/can/time/system_clock.hpp"

namespace dyncal::inline instruments {

namespace {

drivers::can::TimeSource to_driver(CanTimeSource source) {
  switch (source) {
  case CanTimeSource::canopen_sync:
    return drivers::can::TimeSource::canopen_sync;
  case CanTimeSource::payload_time:
    return drivers::can::TimeSource::payload_time;
  case CanTimeSource::counter:
    return drivers::can::TimeSource::counter;
  case CanTimeSource::hardware_stamp:
    return drivers::can::TimeSource::hardware_stamp;
  case CanTimeSource::kernel_stamp:
    return drivers::can::TimeSource::kernel_stamp;
  }
  return drivers::can::TimeSource::kernel_stamp;
}

drivers::can::StampPoint to_driver(CanStampPoint point) {
  switch (point) {
  case CanStampPoint::start_of_frame:
    return drivers::can::StampPoint::start_of_frame;
  case CanStampPoint::end_of_frame:
    return drivers::can::StampPoint::end_of_frame;
  case CanStampPoint::unknown:
    return drivers::can::StampPoint::unknown;
  }
  return drivers::can::StampPoint::unknown;
}

} // namespace

drivers::can::StreamSettings stream_settings(const SourceSettings& source) {
  const auto& can = std::get<CanSourceSettings>(source.driver);
  drivers::can::StreamSettings stream;
  stream.messages = can.messages;
  stream.channels = source.channels;
  stream.units = source.units;
  if (can.time_source) {
    stream.time_source = to_driver(*can.time_source);
  }
  stream.counter = can.counter;
  stream.time_field = can.time_field;
  stream.time_field_tick_s = can.time_field_tick_s;
  stream.nominal_rate_hz = can.nominal_rate_hz;
  stream.sync_id = can.sync_id;
  stream.bit_rates = {can.bit_rate_per_s, can.data_bit_rate_per_s};
  stream.hardware_stamp_point = to_driver(can.hardware_stamp_point);
  stream.hardware_tick_s = can.hardware_tick_s.value_or(stream.hardware_tick_s);
  stream.correct_frame_duration = can.correct_frame_duration;
  stream.bus_is_shared = can.bus_is_shared;
  stream.latency_s = can.latency_s;
  stream.u_latency_s = can.u_latency_s;
  stream.time_base = source.time_base;
  stream.u_utc_s = can.u_utc_s;
  // This host's clock tells nothing of the one that stamped a log.
  if (!can.log.empty() && !stream.u_utc_s) {
    stream.u_utc_s = drivers::can::u_undisciplined_clock_s();
  }
  return stream;
}

} // namespace dyncal::inline instruments
