// The units that people write into DBC files, as D-SI (https://ptb.de/si).
//
// Known ones are translated, with a factor where D-SI has no such unit (g = 9.80665 m/s^2, CGPM
// 1901); unknown ones are refused, so that no number is published in a unit that cannot be named.
// Pure function; any thread.
#pragma once

#include <optional>
#include <string>

namespace dyncal::drivers::can {

struct SignalUnit {
  std::string d_si;
  std::string quantity; // in words, "" when the unit does not tell
  double factor = 1.0;  // value in d_si = value in the file's unit * factor
};

[[nodiscard]] std::optional<SignalUnit> signal_unit(const std::string& dbc_unit);

} // namespace dyncal::drivers::can
