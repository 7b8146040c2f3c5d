// Closed loop of the excitation level: which voltage to set next, from the levels that the
// reference has shown.
//
//   V_0 = 1/2 wanted / r,   V_{n+1} = V_n wanted / measured_n
//
//   r: level per volt as the bench file gives it. Levels in m/s^2, voltages in V, both amplitudes
//   (zero to peak).
//
// The first voltage is half of the expected one, since the exciter's response at a frequency is not
// known before; where an earlier step has shown it, it is used in full. A voltage above a limit is
// never returned. A reference that ends at its range, or an amplifier at its limit, shows ever less
// per volt: a loop that believed it would drive without end.
//
// Fails: invalid_setting (a limit would be passed, or is: the reference shows more than the maximum
// or the plausible level), refused (the exciter does not follow: the reference shows less than a
// twentieth of what is expected, or per volt less than 0.8 of what it showed before the voltage
// rose, or the level is not within the tolerance after `corrections` changes). The caller then
// switches the output off. Pure arithmetic; one thread.
#pragma once

#include <limits>

#include "drivers/error.hpp"

namespace dyncal::drivers::generator {

struct LevelLimits {
  double maximum_voltage_v = std::numeric_limits<double>::infinity();
  double maximum_level_m_s2 = std::numeric_limits<double>::infinity();
  // There is no more, and no level needs more, while level_per_volt is about right, whatever the
  // reference shows.
  double plausible_level_m_s2 = std::numeric_limits<double>::infinity();
  double plausible_voltage_v = std::numeric_limits<double>::infinity();
};

// 1.5 times the highest.
[[nodiscard]] double plausible_level_m_s2(double highest_level_m_s2);

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
  // Returns true if the level is within the tolerance: keep the voltage. Otherwise set voltage_v(),
  // which has changed, and measure again.
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
  double measured_at_v_ = 0.0; // the voltage at which level_per_volt_ was measured; 0: it was not
  int changes_ = 0;
};

} // namespace dyncal::drivers::generator
