// Closed loop of the excitation level: which voltage to set next, from the levels that the
// reference has shown. Pure arithmetic.
//
//   V_0 = 1/2 wanted / r,   V_{n+1} = V_n wanted / measured_n,   r: level per volt as the bench
//   file says it
//
// The first voltage is half of what should do, since the exciter's response at a frequency is not
// known before; where it is known from an earlier step, it is used in full. A voltage that would
// pass a limit is never returned: take() fails instead, and so it does when the reference shows
// more than the highest level (the caller switches the output off), next to nothing (below a
// twentieth of what is expected), or when the level is not within the tolerance after `corrections`
// changes. Levels in m/s^2, voltages in V, both amplitudes (zero to peak). Fails: invalid_setting
// (limits), refused (the exciter does not follow). One thread.
#pragma once

#include <limits>

#include "drivers/error.hpp"

namespace dyncal::drivers::generator {

struct LevelLimits {
  double maximum_voltage_v = std::numeric_limits<double>::infinity();
  double maximum_level_m_s2 = std::numeric_limits<double>::infinity();
};

// The voltage for a level without any control. Fails when it, or the level, is above a limit.
[[nodiscard]] Expected<double> voltage_for_level(double level_m_s2, double level_per_volt,
                                                 const LevelLimits& limits);

struct LevelTarget {
  double level_m_s2 = 0.0;
  double tolerance_rel = 0.01;
  double level_per_volt = 1.0;
  bool response_known = false; // level_per_volt was measured at this frequency
  int corrections = 4;
};

class LevelControl {
public:
  [[nodiscard]] static Expected<LevelControl> start(const LevelTarget& target,
                                                    const LevelLimits& limits);

  [[nodiscard]] double voltage_v() const { return voltage_v_; }
  // True: the level is within the tolerance, keep the voltage. False: set voltage_v(), which has
  // changed, and measure again.
  [[nodiscard]] Expected<bool> take(double measured_m_s2);
  // As last measured.
  [[nodiscard]] double level_per_volt() const { return level_per_volt_; }

private:
  LevelControl(const LevelTarget& target, const LevelLimits& limits)
      : target_(target), limits_(limits) {}

  LevelTarget target_;
  LevelLimits limits_;
  double voltage_v_ = 0.0;
  double level_per_volt_ = 0.0;
  int changes_ = 0;
};

} // namespace dyncal::drivers::generator
