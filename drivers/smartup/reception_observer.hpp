// Who watches an address as a whole: which sensors are received there, wanted or not, and how its
// datagrams fare. The samples themselves go to the sink of each wanted sensor.
//
// All functions are called on the receiver's thread and must not block: the socket waits meanwhile.
#pragma once

#include <cstdint>
#include <string>

#include "drivers/smartup/sensor_counts.hpp"

namespace dyncal::drivers::smartup {

struct SensorReport {
  std::uint32_t sensor = 0;
  std::string name;    // "" as long as no description has come
  std::string sender;  // address and port of the unit
  bool wanted = false; // its samples are handed on, by themselves or as those of a sync sensor
  SensorCounts counts;
};

class ReceptionObserver {
public:
  virtual ~ReceptionObserver() = default;

  // About twice a second, after the sinks were given their counts: each sensor that was ever
  // received, then the address as a whole.
  virtual void on_report(const SensorReport& report) = 0;
  virtual void on_report(const ReceptionCounts& counts) = 0;
};

} // namespace dyncal::drivers::smartup
