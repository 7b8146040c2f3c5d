// The unit of a sensitivity or gain as people write it: output over input, "mV/(m/s^2)", "pC/g",
// "mV/pC", "V/(m/s)", or "1".
//
// Factors are to SI: 1 pC/g is 1e-12 / 9.80665 C/(m/s^2); g is the standard acceleration of free
// fall (ISO 80000-3). Plain data; any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace dyncal::inline bench {

struct SensitivityUnit {
  double factor = 1.0;
  std::string output; // in SI: "V", "C", "m/s^2"; "1" without a unit
  std::string input;

  // Written as "1": not "V/V", which is a gain of any size.
  [[nodiscard]] bool is_one() const { return output == "1"; }
};

// Nothing: not known.
[[nodiscard]] std::optional<SensitivityUnit> parse_sensitivity_unit(std::string_view text);

// "C, nC, pC, V, ..." for those who are to write another one.
[[nodiscard]] std::string known_sensitivity_units();

} // namespace dyncal::inline bench
