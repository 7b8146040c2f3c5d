#include "drivers/virtual_bench/model/table_drift.hpp"

#include <cmath>
#include <numbers>

#include "drivers/virtual_bench/model/random.hpp"

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr double usual_velocity_m_s = 0.1e-6;
constexpr double lowest_hz = 0.2;
constexpr double step_of_frequencies = 2.2;
constexpr double amplitude_at_lowest_m = 4e-6;
constexpr double hum_hz = 49.98; // as the ACS hears it
constexpr double hum_m = 2e-9;

} // namespace

TableDrift::TableDrift(std::uint64_t seed) {
  Random random(seed, "drift of the table");
  velocity_m_s_ =
      usual_velocity_m_s * random.uniform(0.5, 1.5) * (random.happens(0.5) ? 1.0 : -1.0);
  double frequency_hz = lowest_hz;
  for (SlowMotion& motion : motions_) {
    motion.frequency_hz = frequency_hz * random.uniform(0.8, 1.25);
    motion.amplitude_m = amplitude_at_lowest_m * random.uniform(0.5, 1.5) *
                         std::pow(lowest_hz / motion.frequency_hz, 1.5);
    motion.phase_rad = random.uniform(0.0, two_pi);
    frequency_hz *= step_of_frequencies;
  }
  motions_.back().frequency_hz = hum_hz;
  motions_.back().amplitude_m = hum_m;
}

double TableDrift::at(double time_s) const {
  double position_m = velocity_m_s_ * time_s;
  for (const SlowMotion& motion : motions_) {
    position_m +=
        motion.amplitude_m * std::sin(two_pi * motion.frequency_hz * time_s + motion.phase_rad);
  }
  return position_m;
}

} // namespace dyncal::drivers::virtual_bench
