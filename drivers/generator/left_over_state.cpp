#include "drivers/generator/left_over_state.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>

#include "analysis/base/text.hpp"
#include "drivers/link/scpi_answer.hpp"

namespace dyncal::drivers::generator {
namespace {

constexpr LeftOverState burst{"burst", ":SOURce1:BURSt:STATe OFF", ":SOURce1:BURSt:STATe?"};
constexpr LeftOverState sweep{"sweep", ":SOURce1:SWEep:STATe OFF", ":SOURce1:SWEep:STATe?"};
constexpr LeftOverState modulation{"modulation", ":SOURce1:MOD:STATe OFF", ":SOURce1:MOD:STATe?"};
constexpr LeftOverState am{"AM", ":SOURce1:AM:STATe OFF", ":SOURce1:AM:STATe?"};
constexpr LeftOverState fm{"FM", ":SOURce1:FM:STATe OFF", ":SOURce1:FM:STATe?"};
constexpr LeftOverState pm{"PM", ":SOURce1:PM:STATe OFF", ":SOURce1:PM:STATe?"};
constexpr LeftOverState sum{"sum", ":SOURce1:SUM:STATe OFF", ":SOURce1:SUM:STATe?"};
constexpr LeftOverState offset{"DC offset", ":SOURce1:VOLTage:OFFSet 0", offset_query};
constexpr LeftOverState phase{"start phase", ":SOURce1:PHASe 0", ":SOURce1:PHASe?"};
constexpr LeftOverState polarity{"polarity", ":OUTPut1:POLarity NORMal", ":OUTPut1:POLarity?"};

// One row a family: name, words of *IDN?, and what may be left in it.
const std::vector<GeneratorFamily>& families() {
  static const std::vector<GeneratorFamily> rows{
      {"keysight", {{",335"}, {",336"}}, {burst, sweep, am, fm, pm, sum, offset, phase, polarity}},
      {"rigol",
       {{"RIGOL", ",DG"}, {"DYNCAL VIRTUAL BENCH"}},
       {burst, sweep, modulation, offset, phase, polarity}},
  };
  return rows;
}

std::string upper(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](char letter) {
    return static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  });
  return result;
}

} // namespace

std::span<const GeneratorFamily> generator_families() {
  return families();
}

const GeneratorFamily& family_of(std::string_view identity, std::span<const GeneratorFamily> rows) {
  static const GeneratorFamily unknown{
      "unknown", {}, {burst, sweep, modulation, am, fm, pm, sum, offset, phase, polarity}, false};
  const std::string text = upper(identity);
  const auto has_all = [&](const std::vector<std::string_view>& words) {
    return std::ranges::all_of(
        words, [&](std::string_view word) { return text.find(word) != std::string::npos; });
  };
  const auto found = std::ranges::find_if(rows, [&](const GeneratorFamily& row) {
    return std::ranges::any_of(row.identities, has_all);
  });
  return found == rows.end() ? unknown : *found;
}

std::optional<bool> says_reset(std::string_view answer) {
  const std::string text = upper(trimmed(answer));
  if (text == "OFF" || text.starts_with("NORM")) {
    return true;
  }
  if (text == "ON" || text.starts_with("INV")) {
    return false;
  }
  const auto number = parse_scpi_number(text);
  return number ? std::optional(std::abs(*number) <= reset_rounding) : std::nullopt;
}

} // namespace dyncal::drivers::generator
