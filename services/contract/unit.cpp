#include "services/contract/unit.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <utility>

namespace dyncal::inline contract {
namespace {

using Pair = std::pair<std::string_view, std::string_view>;

constexpr std::array<Pair, 17> short_forms{{
    {"m/s^2", R"(\metre\second\tothe{-2})"},
    {"m/s²", R"(\metre\second\tothe{-2})"},
    {"m/s", R"(\metre\second\tothe{-1})"},
    {"rad/s", R"(\radian\second\tothe{-1})"},
    {"rad", R"(\radian)"},
    {"m", R"(\metre)"},
    {"s", R"(\second)"},
    {"Hz", R"(\hertz)"},
    {"V", R"(\volt)"},
    {"mV", R"(\milli\volt)"},
    {"Pa", R"(\pascal)"},
    {"N", R"(\newton)"},
    {"N m", R"(\newton\metre)"},
    {"uT", R"(\micro\tesla)"},
    {"degC", R"(\degreecelsius)"},
    {"K", R"(\kelvin)"},
    {"1", R"(\one)"},
}};

struct UnitWord {
  std::string_view word;
  std::array<double, 7> exponents; // as in Dimension
  bool is_angle = false;
};

constexpr std::array<UnitWord, 37> unit_words{{
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
    {"radian", {}, true},
    {"degree", {}, true},
    {"arcminute", {}, true},
    {"steradian", {}},
    {"one", {}},
    {"percent", {}},
    {"ppm", {}},
    {"decibel", {}},
}};

constexpr std::array<std::string_view, 16> prefix_words{
    "deca", "hecto", "kilo",  "mega",  "giga", "tera", "peta",  "exa",
    "deci", "centi", "milli", "micro", "nano", "pico", "femto", "atto",
};

bool is_exponent(std::string_view text) { // between the braces of \tothe{...}
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) {
    text.remove_prefix(1);
  }
  return !text.empty() && std::ranges::all_of(text, [](unsigned char c) {
    return std::isdigit(c) != 0 || c == '.';
  });
}

// Of the unit before it: 1 where \tothe{n} does not follow. Nothing: that is malformed.
std::optional<double> take_exponent(std::string_view& text) {
  constexpr std::string_view power = R"(\tothe{)";
  if (!text.starts_with(power)) {
    return 1.0;
  }
  text.remove_prefix(power.size());
  const std::size_t end = std::min(text.find('}'), text.size());
  const std::string number(text.substr(0, end));
  if (end == text.size() || !is_exponent(number)) {
    return std::nullopt;
  }
  text.remove_prefix(end + 1);
  return std::strtod(number.c_str(), nullptr);
}

void add(const UnitWord& unit, double exponent, Dimension& dimension) {
  for (std::size_t i = 0; i < dimension.exponents.size(); ++i) {
    dimension.exponents.at(i) += exponent * unit.exponents.at(i);
  }
  dimension.has_angle |= unit.is_angle;
}

} // namespace

// D-SI: ([\prefix]\unit[\tothe{n}])+ with an optional leading \per or \per between.
std::optional<Dimension> dimension_of(std::string_view text) {
  Dimension dimension;
  bool unit_seen = false;
  bool prefix_open = false;
  bool divides = false; // \per stands before the unit that it divides by
  while (!text.empty()) {
    if (text.front() != '\\') {
      return std::nullopt;
    }
    text.remove_prefix(1);
    const auto length = std::min(text.find_first_of("\\{"), text.size());
    const std::string_view word = text.substr(0, length);
    text.remove_prefix(length);
    const auto* const unit = std::ranges::find(unit_words, word, &UnitWord::word);
    if (unit != unit_words.end()) {
      const auto exponent = take_exponent(text);
      if (!exponent) {
        return std::nullopt;
      }
      add(*unit, divides ? -*exponent : *exponent, dimension);
      unit_seen = true;
      prefix_open = false;
      divides = false;
    } else if (prefix_open) {
      return std::nullopt;
    } else if (word == "per") {
      divides = true;
    } else if (std::ranges::find(prefix_words, word) != prefix_words.end()) {
      prefix_open = true;
    } else {
      return std::nullopt;
    }
  }
  return unit_seen && !prefix_open ? std::optional(dimension) : std::nullopt;
}

std::optional<std::string> to_d_si(const std::string& unit) {
  for (const auto& [short_text, d_si] : short_forms) {
    if (unit == short_text) {
      return std::string(d_si);
    }
  }
  return dimension_of(unit) ? std::optional(unit) : std::nullopt;
}

std::string short_form(const std::string& d_si) {
  for (const auto& [short_text, text] : short_forms) {
    if (d_si == text) {
      return std::string(short_text);
    }
  }
  return d_si;
}

bool is_acceleration(const std::string& d_si) {
  return d_si == R"(\metre\second\tothe{-2})";
}

} // namespace dyncal::inline contract
