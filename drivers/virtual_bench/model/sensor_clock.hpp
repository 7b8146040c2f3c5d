// When a sensor takes its samples: the instants of its data-ready edges in bench time, and its
// temperature.
//
// MPU-9250: intervals of 996.955 us
//   + one of four levels (-39, -13, 13, 39) * 0.835 ns, chosen again with p = 0.02 a sample, by the
//     temperature
//   + 1.5 ns/K (T - 28.2 degC)
//   + white noise of 5 ns.
// The edge itself has 3 ns of phase noise and rarely comes 30..163 ns late. Temperature follows a
// warm-up T(x) = 27 + 1.8 (1 - e^{-3x}) + 0.15 sin(14 pi x), x = 0..1 over the cycle and then back.
// The paper's record lasts 8000 s and has about 32 late edges; both scale with the cycle, so that a
// short run shows the whole picture.
//
// BMA280: 485 us + 12 ns of noise; every 2200 (+-2) samples one interval is 4.2 us longer and the
// next one as much shorter. One thread.
#pragma once

#include <cstdint>
#include <memory>

#include "drivers/virtual_bench/model/preset.hpp"
#include "drivers/virtual_bench/model/random.hpp"

namespace dyncal::drivers::virtual_bench {

struct SensorEdge {
  double time_s = 0.0; // of the data-ready edge
  double temperature_degc = 0.0;
};

class SensorClock {
public:
  virtual ~SensorClock() = default;
  // The next edge; times rise.
  [[nodiscard]] virtual SensorEdge next() = 0;
};

[[nodiscard]] std::unique_ptr<SensorClock> make_sensor_clock(SensorKind kind, std::uint64_t seed,
                                                             double thermal_cycle_s);

} // namespace dyncal::drivers::virtual_bench
