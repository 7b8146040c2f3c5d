#include "drivers/generator/level_control.hpp"

#include <cmath>
#include <cstdio>
#include <string>

namespace dyncal::drivers::generator {
namespace {

constexpr double first_fraction = 0.5;  // of the expected voltage
constexpr double min_response = 0.05;   // of the one expected
constexpr double rounding = 1.0 + 1e-9; // a limit may be reached
constexpr double beyond_highest = 1.5;  // of the highest level, and of its voltage
constexpr double falling = 0.8;         // of the response before the voltage rose

std::string number(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%.4g", value);
  return text;
}

} // namespace

double plausible_level_m_s2(double highest_level_m_s2) {
  return beyond_highest * highest_level_m_s2;
}

Expected<double> voltage_for_level(double level_m_s2, double level_per_volt,
                                   const LevelLimits& limits) {
  const double voltage_v = level_m_s2 / level_per_volt;
  if (!(voltage_v > 0.0) || !std::isfinite(voltage_v)) {
    return fail(ErrorCode::invalid_setting, "no voltage gives a level of " + number(level_m_s2) +
                                                " m/s^2 at " + number(level_per_volt) +
                                                " m/s^2 per volt: both must be above 0");
  }
  if (level_m_s2 > limits.maximum_level_m_s2 * rounding) {
    return fail(ErrorCode::invalid_setting, "a level of " + number(level_m_s2) +
                                                " m/s^2 is above generator.maximum_level_m_s2 = " +
                                                number(limits.maximum_level_m_s2));
  }
  if (voltage_v > limits.maximum_voltage_v * rounding) {
    return fail(ErrorCode::invalid_setting,
                "a level of " + number(level_m_s2) + " m/s^2 needs " + number(voltage_v) +
                    " V, above generator.maximum_voltage_v = " + number(limits.maximum_voltage_v));
  }
  if (voltage_v > limits.plausible_voltage_v * rounding) {
    return fail(ErrorCode::invalid_setting,
                "a level of " + number(level_m_s2) + " m/s^2 would need " + number(voltage_v) +
                    " V by what the reference shows, and the highest level is expected at " +
                    number(limits.plausible_voltage_v / beyond_highest) +
                    " V: is generator.level_per_volt right, and does the reference show all of "
                    "the motion?");
  }
  return voltage_v;
}

Expected<LevelControl> LevelControl::start(const LevelTarget& target, const LevelLimits& limits) {
  if (!(target.tolerance_rel > 0.0) || target.corrections < 1) {
    return fail(ErrorCode::invalid_setting,
                "the level needs a tolerance above 0 and at least one correction");
  }
  const double level_m_s2 = target.level_m_s2 * (target.response_known ? 1.0 : first_fraction);
  const auto possible = voltage_for_level(target.level_m_s2, target.level_per_volt,
                                          {.maximum_level_m_s2 = limits.maximum_level_m_s2});
  DYNCAL_TRY(possible);
  DYNCAL_TRY(const auto voltage_v, voltage_for_level(level_m_s2, target.level_per_volt, limits));
  LevelControl control(target, limits);
  control.voltage_v_ = voltage_v;
  control.level_per_volt_ = target.level_per_volt;
  return control;
}

Expected<bool> LevelControl::take(double measured_m_s2) {
  if (!std::isfinite(measured_m_s2) ||
      measured_m_s2 < min_response * voltage_v_ * level_per_volt_) {
    return fail(ErrorCode::refused,
                "the reference shows " + number(measured_m_s2) + " m/s^2 at " + number(voltage_v_) +
                    " V where " + number(voltage_v_ * level_per_volt_) +
                    " are expected: is the amplifier on, and the reference connected?");
  }
  if (measured_m_s2 > limits_.maximum_level_m_s2 * rounding) {
    return fail(ErrorCode::invalid_setting,
                "the reference shows " + number(measured_m_s2) + " m/s^2 at " + number(voltage_v_) +
                    " V, above generator.maximum_level_m_s2 = " +
                    number(limits_.maximum_level_m_s2) + ": is generator.level_per_volt right?");
  }
  if (measured_m_s2 > limits_.plausible_level_m_s2 * rounding) {
    return fail(ErrorCode::invalid_setting,
                "the reference shows " + number(measured_m_s2) + " m/s^2 at " + number(voltage_v_) +
                    " V, and the highest level is " +
                    number(limits_.plausible_level_m_s2 / beyond_highest) +
                    ": is generator.level_per_volt right?");
  }
  const double response = measured_m_s2 / voltage_v_;
  if (measured_at_v_ > 0.0 && voltage_v_ > measured_at_v_ && response < falling * level_per_volt_) {
    return fail(ErrorCode::refused,
                "the reference shows " + number(level_per_volt_) + " m/s^2 per volt at " +
                    number(measured_at_v_) + " V and " + number(response) + " at " +
                    number(voltage_v_) +
                    " V: does it end at its range, or the amplifier at its limit?");
  }
  level_per_volt_ = response;
  measured_at_v_ = voltage_v_;
  if (std::abs(measured_m_s2 / target_.level_m_s2 - 1.0) <= target_.tolerance_rel) {
    return true;
  }
  if (changes_ == target_.corrections) {
    return fail(ErrorCode::refused,
                "the level is " + number(measured_m_s2) + " m/s^2 in place of " +
                    number(target_.level_m_s2) + " after " + std::to_string(changes_) +
                    " corrections: is the exciter steady, or level_tolerance_rel = " +
                    number(target_.tolerance_rel) + " too narrow?");
  }
  DYNCAL_TRY(voltage_v_, voltage_for_level(target_.level_m_s2, level_per_volt_, limits_));
  ++changes_;
  return false;
}

} // namespace dyncal::drivers::generator
