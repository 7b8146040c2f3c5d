// The response of a sensor from a file, so that a published calibration can be put on the bench:
// CSV with a line of names, then a line a frequency.
//
//   frequency_hz,magnitude,phase_rad
//   10,1.019167,-0.0947
//
// Frequencies rise. Magnitude: what the sensor shows over what it feels, both in m/s^2, above 0.
// Phase: lead in radians, so that a delay is negative; between neighbours it changes by less than
// half a turn, whole turns may be left out. Lines that begin with # and empty ones are passed over.
//
// In between, magnitude and phase follow response.hpp: a monotone cubic of the magnitude, and of
// what the phase has beyond the straight line through it, whose slope is the delay. Harmonics of
// the exciter above the table see a magnitude that falls with 1/f^2.
//
// Fails: not_found when it cannot be read; malformed with file and line. Any thread.
#pragma once

#include <filesystem>

#include "drivers/error.hpp"
#include "drivers/virtual_bench/model/response.hpp"

namespace dyncal::drivers::virtual_bench {

struct ResponseTable {
  AxisResponse response;
  double first_hz = 0.0; // it is known from here
  double last_hz = 0.0;  // to here
  double largest_magnitude = 0.0;

  [[nodiscard]] bool covers(double frequency_hz) const {
    return frequency_hz >= first_hz && frequency_hz <= last_hz;
  }
};

[[nodiscard]] Expected<ResponseTable> read_response_file(const std::filesystem::path& path);

} // namespace dyncal::drivers::virtual_bench
