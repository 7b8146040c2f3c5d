#include "services/contract/quantity.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "services/base/per_enumerator.hpp"
#include "services/contract/unit.hpp"

namespace dyncal::inline contract {
namespace {

struct Dimension {
  std::array<double, 7> exponents{}; // of m, kg, s, A, K, mol, cd
  bool has_angle = false;

  [[nodiscard]] bool is(const std::array<double, 7>& others) const {
    constexpr double rounding = 1e-9; // exponents may be 0.5, and are sums
    return std::equal(exponents.begin(), exponents.end(), others.begin(),
                      [](double a, double b) { return std::abs(a - b) < rounding; });
  }
};

struct UnitWord {
  std::string_view word;
  std::array<double, 7> exponents;
};

// Words that are not here have none: \one, \percent, \decibel, angles.
constexpr std::array<UnitWord, 29> unit_words{{
    {"metre", {1}},
    {"gram", {0, 1}},
    {"kilogram", {0, 1}},
    {"tonne", {0, 1}},
    {"second", {0, 0, 1}},
    {"minute", {0, 0, 1}},
    {"hour", {0, 0, 1}},
    {"day", {0, 0, 1}},
    {"ampere", {0, 0, 0, 1}},
    {"kelvin", {0, 0, 0, 0, 1}},
    {"degreecelsius", {0, 0, 0, 0, 1}},
    {"mole", {0, 0, 0, 0, 0, 1}},
    {"candela", {0, 0, 0, 0, 0, 0, 1}},
    {"lumen", {0, 0, 0, 0, 0, 0, 1}},
    {"lux", {-2, 0, 0, 0, 0, 0, 1}},
    {"hertz", {0, 0, -1}},
    {"newton", {1, 1, -2}},
    {"pascal", {-1, 1, -2}},
    {"bar", {-1, 1, -2}},
    {"joule", {2, 1, -2}},
    {"watt", {2, 1, -3}},
    {"coulomb", {0, 0, 1, 1}},
    {"volt", {2, 1, -3, -1}},
    {"farad", {-2, -1, 4, 2}},
    {"ohm", {2, 1, -3, -2}},
    {"siemens", {-2, -1, 3, 2}},
    {"weber", {2, 1, -2, -1}},
    {"tesla", {0, 1, -2, -1}},
    {"henry", {2, 1, -2, -2}},
}};

constexpr std::array<std::string_view, 3> angle_words{"radian", "degree", "arcminute"};

void add(std::string_view word, double exponent, Dimension& dimension) {
  const auto* const found = std::ranges::find(unit_words, word, &UnitWord::word);
  if (found != unit_words.end()) {
    for (std::size_t i = 0; i < dimension.exponents.size(); ++i) {
      dimension.exponents.at(i) += exponent * found->exponents.at(i);
    }
  }
  dimension.has_angle |= std::ranges::find(angle_words, word) != angle_words.end();
}

bool is_unit_word(std::string_view word) {
  return std::ranges::find(unit_words, word, &UnitWord::word) != unit_words.end() ||
         std::ranges::find(angle_words, word) != angle_words.end();
}

// REQUIRES: D-SI
Dimension dimension_of(std::string_view text) {
  Dimension dimension;
  bool divides = false; // \per stands before the unit that it divides by
  while (!text.empty()) {
    text.remove_prefix(1);
    const auto length = std::min(text.find_first_of("\\{"), text.size());
    const std::string_view word = text.substr(0, length);
    text.remove_prefix(length);
    if (word == "per") {
      divides = true;
      continue;
    }
    double exponent = divides ? -1.0 : 1.0;
    constexpr std::string_view power = R"(\tothe{)";
    if (text.starts_with(power)) {
      text.remove_prefix(power.size());
      exponent *= std::strtod(std::string(text.substr(0, text.find('}'))).c_str(), nullptr);
      text.remove_prefix(text.find('}') + 1);
    }
    if (is_unit_word(word)) {
      add(word, exponent, dimension);
      divides = false;
    }
  }
  return dimension;
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
  if (dimension.is({})) {
    return dimension.has_angle ? Quantity::angle : Quantity::unknown;
  }
  const auto* const found =
      std::ranges::find_if(known, [&](const Known& one) { return dimension.is(one.first); });
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
  const auto d_si = to_d_si(unit);
  return d_si ? quantity_of(dimension_of(*d_si)) : Quantity::unknown;
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
