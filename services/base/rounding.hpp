// A value and its standard uncertainty as people read them: u with two significant digits, the
// value rounded to the same place (GUM 7.2.6).
//
//   0.9771834, u 0.000934   "0.97718"     "0.00093"
//   -3.14159,  u 0.00087    "-3.14159"    "0.00087"
//   8.1234e-6, u 1.5e-8     "8.123e-06"   "1.5e-08"     small or large: with exponents
//   2e-7,      u 0.014      "0.000"       "0.014"
//   9814.26,   u 230        "9810"        "230"
//
// Without a usable u (0, NaN, infinite, negative) the value has six significant digits. What is not
// a number is "nan", "inf" or "-inf". For text that people read; files for programs carry every
// digit. Plain functions, any thread.
#pragma once

#include <string>

namespace dyncal::inline base {

struct RoundedValue {
  std::string value;
  std::string u;
};

[[nodiscard]] RoundedValue round_by_uncertainty(double value, double u);

// In both units, each rounded by its own u, and of one turn: what rounds to -180 degrees is stated
// as +180 degrees, the end that belongs to (-180, 180], and in rad with the same sign.
struct RoundedPhase {
  RoundedValue radians;
  RoundedValue degrees;
};

[[nodiscard]] RoundedPhase round_phase(double phase_rad, double u_rad);

// Two significant digits, without exponent where that is readable.
[[nodiscard]] std::string rounded_uncertainty(double u);

} // namespace dyncal::inline base
