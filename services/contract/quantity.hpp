// Which physical quantity a channel is of: by the dimension of its unit, else by the word that its
// source has for it.
//
// The dimension of a unit in D-SI (or a short form, unit.hpp) is the exponents of metre, kilogram,
// second, ampere, kelvin, mole and candela; prefixes do not count, so that mV is a voltage. A word
// is what instruments send beside the unit: "Voltage", "X Acceleration".
//
// What neither tells is unknown: no unit, \one, a unit that is not D-SI ("LSB"), a word that is not
// known. Any thread.
#pragma once

#include <string>

namespace dyncal::inline contract {

enum class Quantity {
  unknown,
  displacement,
  velocity,
  acceleration,
  angle,
  angular_velocity,
  angular_acceleration,
  force,
  torque,
  pressure,
  frequency,
  magnetic_flux_density,
  voltage,
  current,
  charge,
  other_electrical, // with ampere in its unit
  temperature,
  time,
  other
};

// For sentences: "an acceleration", "a voltage"; "not known".
[[nodiscard]] const char* to_string(Quantity quantity);

[[nodiscard]] Quantity quantity_of_unit(const std::string& unit);

// `word` may be a unit, too: what a file says where the bench file says another.
[[nodiscard]] Quantity quantity_of_word(const std::string& word);

} // namespace dyncal::inline contract
