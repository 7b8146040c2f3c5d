#include "services/contract/channel_unit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "services/base/parsed_number.hpp"
#include "services/contract/unit.hpp"

namespace dyncal::inline contract {
namespace {

constexpr double standard_gravity_m_s2 = 9.80665;
constexpr std::string_view volt = R"(\volt)";

struct Written {
  std::string_view text;
  std::string_view d_si;
  double factor = 1.0; // one of it in d_si
};

constexpr std::string_view m_s2 = R"(\metre\second\tothe{-2})";
constexpr std::string_view deg_s = R"(\degree\second\tothe{-1})";

// Beside the short forms of unit.hpp.
constexpr std::array units = {
    Written{"m/s2", m_s2},
    Written{"g", m_s2, standard_gravity_m_s2},
    Written{"mg", m_s2, 1e-3 * standard_gravity_m_s2},
    Written{"mm/s^2", m_s2, 1e-3},
    Written{"mm/s²", m_s2, 1e-3},
    Written{"mm/s", R"(\metre\second\tothe{-1})", 1e-3},
    Written{"mm", R"(\metre)", 1e-3},
    Written{"um", R"(\metre)", 1e-6},
    Written{"µm", R"(\metre)", 1e-6},
    Written{"deg", R"(\degree)"},
    Written{"°", R"(\degree)"},
    Written{"deg/s", deg_s},
    Written{"°/s", deg_s},
    Written{"dps", deg_s},
    Written{"°C", R"(\degreecelsius)"},
    Written{"%", R"(\percent)"},
    Written{"uV", volt, 1e-6},
    Written{"µV", volt, 1e-6},
    Written{"kHz", R"(\hertz)", 1e3},
    Written{"kN", R"(\newton)", 1e3},
    Written{"kPa", R"(\pascal)", 1e3},
    Written{"LSB", R"(\one)"},
    Written{"digit", R"(\one)"},
    Written{"count", R"(\one)"},
    Written{"counts", R"(\one)"},
};

// Without spaces at its ends, nor the brackets around all of it.
std::string_view bare(std::string_view text) {
  const auto trim = [&] {
    while (text.starts_with(' ')) {
      text.remove_prefix(1);
    }
    while (text.ends_with(' ')) {
      text.remove_suffix(1);
    }
  };
  trim();
  if (text.starts_with('(') && text.ends_with(')')) {
    text = text.substr(1, text.size() - 2);
    trim();
  }
  return text;
}

std::optional<Written> unit_of(std::string_view text) {
  const auto* const found = std::ranges::find(units, text, &Written::text);
  return found != units.end() ? std::optional(*found) : std::nullopt;
}

std::optional<ChannelUnit> plain_unit(std::string_view text) {
  if (const auto unit = unit_of(text)) {
    return ChannelUnit{std::string(text), std::string(unit->d_si), unit->factor, 0.0, unit->factor};
  }
  const auto d_si = to_d_si(std::string(text));
  return d_si ? std::optional(ChannelUnit{std::string(text), *d_si}) : std::nullopt;
}

// In V; 0: a count. Nothing: values of scale factors are not in it.
std::optional<double> volts_of(std::string_view from) {
  for (const auto& [text, in_v] :
       {std::pair("V", 1.0), std::pair("mV", 1e-3), std::pair("uV", 1e-6), std::pair("µV", 1e-6)}) {
    if (from == text) {
      return in_v;
    }
  }
  const auto unit = unit_of(from);
  return unit && unit->d_si == R"(\one)" ? std::optional(0.0) : std::nullopt;
}

// "16384 LSB/g"; nothing: it is none, or not a known one.
std::optional<ChannelUnit> scale_factor(const std::string& written) {
  const std::string_view whole = bare(written);
  const std::size_t space = whole.find(' ');
  const std::size_t slash = whole.find('/');
  if (space == std::string_view::npos || slash == std::string_view::npos || slash < space) {
    return std::nullopt;
  }
  const auto number = parsed_number<double>(std::string(whole.substr(0, space)));
  const auto from = volts_of(bare(whole.substr(space, slash - space)));
  const auto to = plain_unit(bare(whole.substr(slash + 1)));
  if (!number || !std::isfinite(*number) || *number == 0.0 || !from || !to) {
    return std::nullopt;
  }
  return ChannelUnit{written, to->d_si, to->factor / *number, *from, to->factor};
}

} // namespace

double ChannelUnit::factor_from(const std::string& own) const {
  if (from_v == 0.0) {
    return factor;
  }
  const auto own_v = own == volt               ? std::optional(1.0)
                     : own == R"(\milli\volt)" ? std::optional(1e-3)
                     : own == R"(\micro\volt)" ? std::optional(1e-6)
                                               : volts_of(own); // "V", as a file writes it
  return factor * (own_v.value_or(0.0) > 0.0 ? *own_v : from_v) / from_v;
}

Expected<ChannelUnit> parse_channel_unit(const std::string& written) {
  if (bare(written) == "dB") {
    return fail(ErrorCode::bad_argument,
                "is a logarithm, in which a sine is none: give the channel as a linear quantity");
  }
  if (auto unit = plain_unit(bare(written))) {
    return *unit;
  }
  if (auto scaled = scale_factor(written)) {
    return *scaled;
  }
  return fail(ErrorCode::bad_argument,
              "is neither D-SI nor a known unit such as \"m/s^2\", \"g\" or \"V\", nor a scale "
              "factor such as \"16384 LSB/g\" or \"100 mV/g\"");
}

} // namespace dyncal::inline contract
