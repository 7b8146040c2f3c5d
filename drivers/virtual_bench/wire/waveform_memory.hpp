// The volatile memory of the virtual generator for one arbitrary waveform, as a Rigol DG800 or
// DG1000Z has it, and the lines that its waveform consists of.
//
//   packet   VOLATILE,CON|END,#<n><n digits><points>
//            two bytes a point, low byte first, 0 to 3FFF
//
// A packet after END begins another waveform. Lines are those of the discrete Fourier transform
// that have a ten-thousandth of the largest one or more; the converter's steps are taken to be
// smoothed, so that nothing is above half of the rate. One thread.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "drivers/virtual_bench/model/excitation.hpp"

namespace dyncal::drivers::virtual_bench {

class WaveformMemory {
public:
  static constexpr std::size_t max_packet_points = 16384;
  static constexpr std::size_t max_points = std::size_t{1} << 20U;

  // False for what is no packet; nothing of it is kept then.
  bool take(std::string_view packet);
  void set_rate(double points_per_s) { rate_hz_ = points_per_s; }
  void clear() { *this = WaveformMemory(); }

  [[nodiscard]] bool is_complete() const { return is_complete_; }
  // Of a waveform between -1 V and 1 V, in ascending order. REQUIRES: it is complete.
  [[nodiscard]] std::vector<DriveLine> lines() const;

private:
  std::vector<std::uint16_t> codes_;
  bool is_complete_ = false;
  double rate_hz_ = 1e6;
};

// Where the line that begins here ends with a '\n' that is not within a block of definite length;
// npos: it has not all come.
[[nodiscard]] std::size_t end_of_line(std::string_view received);

} // namespace dyncal::drivers::virtual_bench
