// The generator that excites the bench, and the bench's own clock.
//
// Voltage is the amplitude (zero to peak) of the sine in volt; frequency is decimal text in hertz, passed on digit by digit.
// Bench time is what durations of steps are measured in: the host's monotonic clock for a real bench, the virtual bench's own time
// otherwise, so that a run holds its durations however fast the virtual bench goes.
// One thread. Each setting is asked for its outcome: an instrument error is passed on as the instrument words it (refused).
// Destruction switches the output off.
#pragma once

#include <stop_token>
#include <string>

#include "drivers/error.hpp"

namespace dyncal::drivers::generator {

class Generator {
public:
  virtual ~Generator() = default;
  // Manufacturer, model, serial number and firmware as the instrument says them.
  [[nodiscard]] virtual const std::string& identity() const = 0;
  [[nodiscard]] virtual Expected<void> set_frequency(const std::string& decimal_hz) = 0;
  [[nodiscard]] virtual Expected<void> set_amplitude_v(double amplitude_v) = 0;
  [[nodiscard]] virtual Expected<void> set_output(bool on) = 0;
  [[nodiscard]] virtual Expected<double> clock_now_s() = 0;
  // Returns the bench time when it has reached `time_s`, or earlier when a stop is requested.
  [[nodiscard]] virtual Expected<double> wait_until_s(double time_s, std::stop_token stop) = 0;
};

} // namespace dyncal::drivers::generator
