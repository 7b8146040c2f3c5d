#include "services/contract/unit.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
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

constexpr std::array<std::string_view, 37> unit_words{
    "metre",   "second", "gram",      "kilogram",  "ampere",        "kelvin", "mole",    "candela",
    "one",     "radian", "steradian", "hertz",     "newton",        "pascal", "joule",   "watt",
    "coulomb", "volt",   "farad",     "ohm",       "siemens",       "weber",  "tesla",   "henry",
    "lumen",   "lux",    "minute",    "hour",      "day",           "degree", "percent", "ppm",
    "bar",     "tonne",  "decibel",   "arcminute", "degreecelsius",
};

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

template <class Words>
bool contains(const Words& words, std::string_view word) {
  return std::ranges::find(words, word) != words.end();
}

// D-SI: ([\prefix]\unit[\tothe{n}])+ with an optional leading \per or \per between.
bool is_d_si(std::string_view text) {
  bool unit_seen = false;
  bool prefix_open = false;
  while (!text.empty()) {
    if (text.front() != '\\') {
      return false;
    }
    text.remove_prefix(1);
    const std::size_t length = static_cast<std::size_t>(
        std::ranges::find_if_not(text, [](unsigned char c) { return std::isalpha(c) != 0; }) -
        text.begin());
    const std::string_view word = text.substr(0, length);
    text.remove_prefix(length);
    if (word == "tothe") {
      const std::size_t close = text.find('}');
      if (!unit_seen || prefix_open || text.empty() || text.front() != '{' ||
          close == std::string_view::npos || !is_exponent(text.substr(1, close - 1))) {
        return false;
      }
      text.remove_prefix(close + 1);
    } else if (contains(unit_words, word)) {
      unit_seen = true;
      prefix_open = false;
    } else if (contains(prefix_words, word) && !prefix_open) {
      prefix_open = true;
    } else if (word != "per" || prefix_open) {
      return false;
    }
  }
  return unit_seen && !prefix_open;
}

} // namespace

std::optional<std::string> to_d_si(const std::string& unit) {
  for (const auto& [short_text, d_si] : short_forms) {
    if (unit == short_text) {
      return std::string(d_si);
    }
  }
  return is_d_si(unit) ? std::optional(unit) : std::nullopt;
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
