// Units as the contract carries them: D-SI text (https://ptb.de/si), TeX-like words without spaces,
// for example \metre\second\tothe{-2}. Short forms that people write ("m/s^2", "V", "degC") are
// translated, anything else is refused. Any thread.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

namespace dyncal::inline contract {

// The D-SI form, or nothing when `unit` is neither D-SI nor a known short form.
[[nodiscard]] std::optional<std::string> to_d_si(const std::string& unit);

// For people: "m/s^2" for \metre\second\tothe{-2}; the D-SI text itself where no short form is
// known.
[[nodiscard]] std::string short_form(const std::string& d_si);

struct Dimension {
  std::array<double, 7> exponents{}; // of m, kg, s, A, K, mol, cd
  bool has_angle = false;
};

// Without prefixes. Nothing: `text` is not D-SI.
[[nodiscard]] std::optional<Dimension> dimension_of(std::string_view text);

// m/s^2, the unit in which levels are planned.
[[nodiscard]] bool is_acceleration(const std::string& d_si);

} // namespace dyncal::inline contract
