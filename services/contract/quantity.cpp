#include "services/contract/quantity.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <string_view>
#include <utility>

#include "services/base/per_enumerator.hpp"
#include "services/contract/unit.hpp"

namespace dyncal::inline contract {
namespace {

bool are_equal(const std::array<double, 7>& some, const std::array<double, 7>& others) {
  constexpr double rounding = 1e-9; // exponents may be 0.5, and are sums
  return std::ranges::equal(some, others,
                            [](double a, double b) { return std::abs(a - b) < rounding; });
}

Quantity quantity_of(const Dimension& dimension) {
  using Known = std::pair<std::array<double, 7>, Quantity>;
  static constexpr std::array<Known, 14> known{{
      {{1}, Quantity::displacement},
      {{1, 0, -1}, Quantity::velocity},
      {{1, 0, -2}, Quantity::acceleration},
      {{0, 0, -2}, Quantity::angular_acceleration},
      {{1, 1, -2}, Quantity::force},
      {{2, 1, -2}, Quantity::torque},
      {{-1, 1, -2}, Quantity::pressure},
      {{0, 1, -2, -1}, Quantity::magnetic_flux_density},
      {{2, 1, -3, -1}, Quantity::voltage},
      {{0, 0, 0, 1}, Quantity::current},
      {{0, 0, 1, 1}, Quantity::charge},
      {{0, 0, 0, 0, 1}, Quantity::temperature},
      {{0, 0, 1}, Quantity::time},
      {{0, 0, -1}, Quantity::frequency},
  }};
  if (are_equal(dimension.exponents, {})) {
    return dimension.has_angle ? Quantity::angle : Quantity::unknown;
  }
  const auto* const found = std::ranges::find_if(
      known, [&](const Known& one) { return are_equal(dimension.exponents, one.first); });
  if (found == known.end()) {
    const bool has_ampere = std::abs(dimension.exponents[3]) > 0.0;
    return has_ampere ? Quantity::other_electrical : Quantity::other;
  }
  const bool turns = found->second == Quantity::frequency && dimension.has_angle;
  return turns ? Quantity::angular_velocity : found->second;
}

} // namespace

const char* to_string(Quantity quantity) {
  return per_enumerator(quantity,
                        {"not known", "a displacement", "a velocity", "an acceleration", "an angle",
                         "an angular velocity", "an angular acceleration", "a force", "a torque",
                         "a pressure", "a frequency", "a magnetic flux density", "a voltage",
                         "a current", "a charge", "an electrical quantity", "a temperature",
                         "a time", "another quantity"});
}

Quantity quantity_of_unit(const std::string& unit) {
  const auto dimension = dimension_of(to_d_si(unit).value_or(""));
  return dimension ? quantity_of(*dimension) : Quantity::unknown;
}

Quantity quantity_of_word(const std::string& word) {
  if (const Quantity by_unit = quantity_of_unit(word); by_unit != Quantity::unknown) {
    return by_unit;
  }
  std::string lower = word;
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  using Known = std::pair<std::string_view, Quantity>;
  // What another word contains comes behind it.
  static constexpr std::array<Known, 12> known{{
      {"angular acceleration", Quantity::angular_acceleration},
      {"acceleration", Quantity::acceleration},
      {"angular velocity", Quantity::angular_velocity},
      {"angular rate", Quantity::angular_velocity},
      {"velocity", Quantity::velocity},
      {"displacement", Quantity::displacement},
      {"temperature", Quantity::temperature},
      {"voltage", Quantity::voltage},
      {"force", Quantity::force},
      {"torque", Quantity::torque},
      {"pressure", Quantity::pressure},
      {"magnetic flux density", Quantity::magnetic_flux_density},
  }};
  const auto* const found = std::ranges::find_if(
      known, [&](const Known& one) { return lower.find(one.first) != std::string::npos; });
  return found == known.end() ? Quantity::unknown : found->second;
}

} // namespace dyncal::inline contract
