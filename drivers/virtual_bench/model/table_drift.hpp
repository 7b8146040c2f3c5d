// How the table moves beside what the generator makes it do, as an interferometer sees it and a
// sensor on the table does not: far too slow to be an acceleration that matters.
//
//   s = v t + sum_i a_i sin(2 pi f_i t + phase_i) + hum
//
// A thermal drift of about 0.1 um/s; five lines from 0.2 Hz to 5 Hz, microns at the lower end, that
// fall with f^-1.5; hum of the mains of 2 nm. All are drawn from the seed. Immutable; any thread.
#pragma once

#include <array>
#include <cstdint>

namespace dyncal::drivers::virtual_bench {

struct SlowMotion {
  double amplitude_m = 0.0;
  double frequency_hz = 0.0;
  double phase_rad = 0.0;
};

class TableDrift {
public:
  explicit TableDrift(std::uint64_t seed);

  [[nodiscard]] double at(double time_s) const; // m
  [[nodiscard]] double velocity_m_s() const { return velocity_m_s_; }
  [[nodiscard]] const std::array<SlowMotion, 6>& motions() const { return motions_; } // hum last

private:
  double velocity_m_s_ = 0.0;
  std::array<SlowMotion, 6> motions_{};
};

} // namespace dyncal::drivers::virtual_bench
