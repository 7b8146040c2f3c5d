// What a new bench consists of: the kinds of its instruments, where they are, and what is excited.
// The method follows from the kind of the sensor:
//
//   smartup    a sensor of a SmartUp Unit     sample time stamping, sync over the unit's ADC
//   file       a recorded series of a DAU     the same, from files
//   can        a sensor with CAN output       absolute time: ACS and host both keep UTC
//   series     a time series sensor           series time stamping, triggered by an oscilloscope
//   analogue   an analogue sensor of the ACS  comparison of two channels of one system
//
// Plain data; any thread.
#pragma once

#include "services/base/per_enumerator.hpp"

#include <string>
#include <vector>

namespace dyncal::inline bench::bench_draft {

enum class SensorKind { smartup, file, can, series, analogue };
[[nodiscard]] inline const char* to_string(SensorKind kind) {
  return per_enumerator(kind, {"smartup", "file", "can", "series", "analogue"});
}

enum class AcsKind { socket, file };
[[nodiscard]] inline const char* to_string(AcsKind kind) {
  return per_enumerator(kind, {"socket", "file"});
}

enum class GeneratorKind { scpi, by_hand, none };
[[nodiscard]] inline const char* to_string(GeneratorKind kind) {
  return per_enumerator(kind, {"scpi", "by-hand", "none"});
}

struct BenchDraft {
  std::string name;
  SensorKind sensor = SensorKind::smartup;
  AcsKind acs = AcsKind::socket;
  GeneratorKind generator = GeneratorKind::scpi;

  std::vector<std::string> frequencies_hz{"10", "20", "40", "80", "160"}; // decimal text
  double level_m_s2 = 10.0;
  int repetitions = 3;
  double settling_s = 1.0;
  double duration_s = 3.0;
  double multisine_period_s = 0.0; // all frequencies at once; 0: one after the other

  std::string reference = "reference"; // channels of the ACS
  std::string reference_file;          // of its calibration; empty: not known yet
  std::string sync = "sync";
  std::string sensor_sync = "sync"; // of the sensor's record
  std::string sensor_channel;       // empty: as usual for the kind of sensor

  std::string listen = "0.0.0.0:7654"; // smartup
  std::string sensor_id = "0xbccb0100";
  std::string sensor_file;                        // file
  std::string interface = "can0";                 // can
  std::string dbc;                                // empty: one is made
  std::vector<std::string> dbc_channels;          // of `dbc`, as channels
  std::string sensor_address = "192.0.2.43:5027"; // series
  std::string dso_address = "192.0.2.42:5555";
  std::string acs_address = "192.0.2.30:5026";
  std::string acs_file;
  std::string generator_address = "192.0.2.20:5025";
  double level_per_volt = 10.0; // m/s^2
  double maximum_voltage_v = 5.0;
};

// Of the sensor: "acceleration_z", or "sensor" for an analogue one, unless it is named.
[[nodiscard]] inline std::string channel_of(const BenchDraft& draft) {
  const char* usual = draft.sensor == SensorKind::analogue ? "sensor" : "acceleration_z";
  return draft.sensor_channel.empty() ? usual : draft.sensor_channel;
}
} // namespace dyncal::inline bench::bench_draft
