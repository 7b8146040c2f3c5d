#include "drivers/generator/left_over_state.hpp"

#include <algorithm>
#include <array>
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

constexpr std::array of_rigol{burst, sweep, modulation, offset, phase, polarity};
constexpr std::array of_keysight{burst, sweep, am, fm, pm, sum, offset, phase, polarity};
constexpr std::array of_unknown{burst, sweep, modulation, am, fm, pm, sum, offset, phase, polarity};

std::string upper(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](char letter) {
    return static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  });
  return result;
}

} // namespace

GeneratorFamily family_of(std::string_view identity) {
  const std::string text = upper(identity);
  const auto names = [&](const char* name) { return text.find(name) != std::string::npos; };
  if (names(",335") || names(",336")) {
    return GeneratorFamily::keysight;
  }
  if ((names("RIGOL") && names(",DG")) || names("DYNCAL VIRTUAL BENCH")) {
    return GeneratorFamily::rigol;
  }
  return GeneratorFamily::unknown;
}

std::span<const LeftOverState> left_over_states(GeneratorFamily family) {
  switch (family) {
  case GeneratorFamily::rigol:
    return of_rigol;
  case GeneratorFamily::keysight:
    return of_keysight;
  case GeneratorFamily::unknown:
    break;
  }
  return of_unknown;
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
