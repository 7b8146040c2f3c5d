#include "drivers/can/dbc/signal_unit.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace dyncal::drivers::can {

namespace {

constexpr double standard_gravity_m_s2 = 9.80665;

struct Entry {
  std::string_view written; // without blanks
  std::string_view d_si;
  std::string_view quantity;
  double factor = 1.0;
};

constexpr std::string_view metre_per_second_squared = "\\metre\\second\\tothe{-2}";
constexpr std::string_view degree_per_second = "\\degree\\second\\tothe{-1}";
constexpr std::string_view radian_per_second = "\\radian\\second\\tothe{-1}";

constexpr std::array table = {
    Entry{"m/s^2", metre_per_second_squared, "acceleration"},
    Entry{"m/s2", metre_per_second_squared, "acceleration"},
    Entry{"m/s/s", metre_per_second_squared, "acceleration"},
    Entry{"m/s\u00b2", metre_per_second_squared, "acceleration"},
    Entry{"m*s^-2", metre_per_second_squared, "acceleration"},
    Entry{"m/sec^2", metre_per_second_squared, "acceleration"},
    Entry{"mm/s^2", metre_per_second_squared, "acceleration", 1e-3},
    Entry{"g", metre_per_second_squared, "acceleration", standard_gravity_m_s2},
    Entry{"G", metre_per_second_squared, "acceleration", standard_gravity_m_s2},
    Entry{"mg", metre_per_second_squared, "acceleration", standard_gravity_m_s2 * 1e-3},
    Entry{"deg/s", degree_per_second, "angular velocity"},
    Entry{"deg/sec", degree_per_second, "angular velocity"},
    Entry{"dps", degree_per_second, "angular velocity"},
    Entry{"\u00b0/s", degree_per_second, "angular velocity"},
    Entry{"\u00b0/sec", degree_per_second, "angular velocity"},
    Entry{"rad/s", radian_per_second, "angular velocity"},
    Entry{"rad/sec", radian_per_second, "angular velocity"},
    Entry{"deg", "\\degree", "angle"},
    Entry{"degree", "\\degree", "angle"},
    Entry{"\u00b0", "\\degree", "angle"},
    Entry{"rad", "\\radian", "angle"},
    Entry{"degC", "\\degreecelsius", "temperature"},
    Entry{"\u00b0C", "\\degreecelsius", "temperature"},
    Entry{"C", "\\degreecelsius", "temperature"}, // what DBC files mean by it; none gives a charge
    Entry{"degK", "\\kelvin", "temperature"},
    Entry{"K", "\\kelvin", "temperature"},
    Entry{"V", "\\volt", "voltage"},
    Entry{"mV", "\\volt", "voltage", 1e-3},
    Entry{"A", "\\ampere", "current"},
    Entry{"mA", "\\ampere", "current", 1e-3},
    Entry{"s", "\\second", "time"},
    Entry{"sec", "\\second", "time"},
    Entry{"ms", "\\second", "time", 1e-3},
    Entry{"us", "\\second", "time", 1e-6},
    Entry{"\u00b5s", "\\second", "time", 1e-6},
    Entry{"ns", "\\second", "time", 1e-9},
    Entry{"Hz", "\\hertz", "frequency"},
    Entry{"kHz", "\\hertz", "frequency", 1e3},
    Entry{"m", "\\metre", "length"},
    Entry{"mm", "\\metre", "length", 1e-3},
    Entry{"km", "\\metre", "length", 1e3},
    Entry{"m/s", "\\metre\\second\\tothe{-1}", "velocity"},
    Entry{"km/h", "\\metre\\second\\tothe{-1}", "velocity", 1.0 / 3.6},
    Entry{"kmh", "\\metre\\second\\tothe{-1}", "velocity", 1.0 / 3.6},
    Entry{"N", "\\newton", "force"},
    Entry{"kN", "\\newton", "force", 1e3},
    Entry{"Nm", "\\newton\\metre", "torque"},
    Entry{"Pa", "\\pascal", "pressure"},
    Entry{"kPa", "\\pascal", "pressure", 1e3},
    Entry{"bar", "\\pascal", "pressure", 1e5},
    Entry{"mbar", "\\pascal", "pressure", 1e2},
    Entry{"T", "\\tesla", "magnetic flux density"},
    Entry{"uT", "\\tesla", "magnetic flux density", 1e-6},
    Entry{"\u00b5T", "\\tesla", "magnetic flux density", 1e-6},
    Entry{"%", "\\percent", ""},
    Entry{"", "\\one", ""},
    Entry{"-", "\\one", ""},
    Entry{"1", "\\one", ""},
};

} // namespace

std::optional<SignalUnit> signal_unit(const std::string& dbc_unit) {
  std::string written;
  for (const char c : dbc_unit) {
    if (c != ' ' && c != '\t') {
      written += c;
    }
  }
  if (written.starts_with('\\')) {
    return SignalUnit{written, "", 1.0}; // D-SI already
  }
  const auto* const found = std::find_if(
      table.begin(), table.end(), [&](const Entry& entry) { return entry.written == written; });
  if (found == table.end()) {
    return std::nullopt;
  }
  return SignalUnit{std::string(found->d_si), std::string(found->quantity), found->factor};
}

} // namespace dyncal::drivers::can
