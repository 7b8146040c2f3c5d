#include "services/bench/file/sensitivity_unit.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace dyncal::inline bench {
namespace {

struct Unit {
  std::string_view text;
  double factor;
  std::string_view si;
};

constexpr double standard_gravity_m_s2 = 9.80665;
constexpr std::array units{Unit{"C", 1.0, "C"},
                           Unit{"nC", 1e-9, "C"},
                           Unit{"pC", 1e-12, "C"},
                           Unit{"V", 1.0, "V"},
                           Unit{"mV", 1e-3, "V"},
                           Unit{"uV", 1e-6, "V"},
                           Unit{"m/s^2", 1.0, "m/s^2"},
                           Unit{"m/s²", 1.0, "m/s^2"},
                           Unit{"g", standard_gravity_m_s2, "m/s^2"},
                           Unit{"m/s", 1.0, "m/s"},
                           Unit{"m", 1.0, "m"},
                           Unit{"rad/s^2", 1.0, "rad/s^2"},
                           Unit{"rad/s", 1.0, "rad/s"}};

const Unit* find(std::string_view text) {
  if (text.starts_with('(') && text.ends_with(')')) {
    text = text.substr(1, text.size() - 2);
  }
  const auto* const found = std::ranges::find(units, text, &Unit::text);
  return found == units.end() ? nullptr : found;
}

} // namespace

std::optional<SensitivityUnit> parse_sensitivity_unit(std::string_view text) {
  if (text == "1") {
    return SensitivityUnit{1.0, "1", "1"};
  }
  for (std::size_t slash = text.find('/'); slash != std::string_view::npos;
       slash = text.find('/', slash + 1)) {
    const Unit* const output = find(text.substr(0, slash));
    const Unit* const input = find(text.substr(slash + 1));
    if (output != nullptr && input != nullptr) {
      return SensitivityUnit{output->factor / input->factor, std::string(output->si),
                             std::string(input->si)};
    }
  }
  return std::nullopt;
}

std::string known_sensitivity_units() {
  std::vector<std::string_view> texts;
  for (const Unit& unit : units) {
    texts.push_back(unit.text);
  }
  return fmt::format("{}", fmt::join(texts, ", "));
}

} // namespace dyncal::inline bench
