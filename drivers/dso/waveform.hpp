// What :WAVeform:PREamble? and :WAVeform:DATA? tell of one trace, one byte a sample (format BYTE).
//
// The preamble is ten numbers: format, type, points, count, xincrement, xorigin, xreference,
// yincrement, yorigin, yreference. Sample i lies at
//
//   (i - xreference) * xincrement + xorigin      seconds from the trigger
//
// and volts follow the family's VoltageRule.
//
// Fails: malformed when a field is missing or impossible (no increment, more points than an
// oscilloscope holds, another format than bytes). Pure functions; any thread.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "drivers/dso/scope_commands.hpp"
#include "drivers/error.hpp"

namespace dyncal::drivers::dso {

struct Preamble {
  std::size_t points = 0;
  double x_increment_s = 0.0;
  double x_origin_s = 0.0;
  double x_reference = 0.0;
  double y_increment_v = 0.0;
  double y_origin = 0.0; // codes (Rigol) or volt (Keysight)
  double y_reference = 0.0;

  [[nodiscard]] double first_sample_s() const { return x_origin_s - x_reference * x_increment_s; }
};

[[nodiscard]] Expected<Preamble> parse_preamble(std::string_view answer);

// Appends one value per byte.
void append_volts(const Preamble& preamble, VoltageRule rule, std::span<const char> codes,
                  std::vector<double>& volts);

} // namespace dyncal::drivers::dso
