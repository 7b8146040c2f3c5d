// What has to be known about a sensor on CAN besides its DBC file, so that its frames become a
// stream of samples. Plain data; any thread.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/can/bus/bit_rates.hpp"
#include "drivers/can/time/stamp_point.hpp"
#include "drivers/sample_block.hpp"

namespace dyncal::drivers::can {

// Where the time of a sample comes from, best first.
enum class TimeSource {
  canopen_sync,   // end of the CANopen SYNC frame before it: the sensor samples on it
  payload_time,   // a time field in the sample, through the line between the sensor's clock and the
                  // host's
  counter,        // a message counter times the nominal interval, through the same line
  hardware_stamp, // start of frame from the adapter's clock, through the line between it and the
                  // host's
  kernel_stamp    // start of frame from the kernel's stamp
};

[[nodiscard]] const char* to_string(TimeSource source);

struct StreamSettings {
  // Messages whose frames make up one sample, by name; the time of the sample is that of the first.
  // Empty: all of the DBC file, which must then be one.
  std::vector<std::string> messages;
  std::map<std::string, std::string>
      channels; // signal -> our name; when not empty only these signals become channels
  std::map<std::string, std::string>
      units; // our name -> D-SI, where the DBC file's unit is missing or unknown

  std::optional<TimeSource>
      time_source;        // nothing: the best that the settings and the adapter allow
  std::string counter;    // signal in every message of a sample that counts samples
  std::string time_field; // signal in every message of a sample that tells the sensor's time
  double time_field_tick_s =
      0.0; // s per raw step; 0: by the DBC file's factor and unit, which must be a time
  double nominal_rate_hz = 0.0;  // 0: from GenMsgCycleTime, or not known
  std::uint32_t sync_id = 0x080; // of the CANopen SYNC

  BitRates bit_rates; // zero: what the interface says
  StampPoint hardware_stamp_point = StampPoint::unknown;
  double hardware_tick_s = 1e-6;
  bool correct_frame_duration = true; // off only to show what it is worth
  // Other devices send on the bus too: stamps that are taken as they are may be late by one of
  // their frames.
  bool bus_is_shared = true;
  // From the stamped instant to the stamp, what the smallest of the delays is; and its standard
  // uncertainty, by default that of the kind.
  double latency_s = 0.0;
  std::optional<double> u_latency_s;
  // utc: stamps are compared with those of other clocks, and the host clock's distance from UTC
  // counts. local: only with stamps of this very clock.
  TimeBase time_base = TimeBase::utc;
  // Standard uncertainty of the host clock against UTC; nothing: what the kernel's clock discipline
  // says.
  std::optional<double> u_utc_s;
};

} // namespace dyncal::drivers::can
