#include "services/bench/file/excitation_levels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "analysis/base/frequency.hpp"
#include "analysis/base/sine_motion.hpp"

namespace dyncal::inline bench {
namespace {

constexpr double nothing_asked = std::numeric_limits<double>::infinity();

struct LevelKey {
  const char* key;
  const char* unit;
  double (*level_m_s2)(double value, double frequency_hz);
};

// Down to four digits, but not below what is such a number already but for the last bit.
double rounded_down(double value) {
  constexpr double digits = 3.0;
  constexpr double last_bits = 1.0 + 1e-12;
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - digits);
  return std::strtod(fmt::format("{:.4g}", std::floor(value / unit * last_bits) * unit).c_str(),
                     nullptr);
}

double as_it_is(double level_m_s2, double /*frequency_hz*/) {
  return level_m_s2;
}

double of_velocity(double velocity_m_s, double frequency_hz) {
  return rounded_down(analysis::acceleration_of_velocity_m_s2(velocity_m_s, frequency_hz));
}

double of_displacement(double displacement_mm, double frequency_hz) {
  return rounded_down(
      analysis::acceleration_of_displacement_m_s2(1e-3 * displacement_mm, frequency_hz));
}

constexpr std::array level_keys{LevelKey{"level", "m/s^2", as_it_is},
                                LevelKey{"level_velocity_m_s", "m/s", of_velocity},
                                LevelKey{"level_displacement_mm", "mm", of_displacement}};

// One for each frequency; empty: the key is not there, or was refused.
std::vector<double> spread_values(TomlTable& table, const LevelKey& key, std::size_t frequencies) {
  std::vector<double> values = table.numbers(key.key, key.unit);
  if (!table.has(key.key) || table.refused(key.key)) {
    return {};
  }
  const std::string must_be_positive = fmt::format("must be positive, in {}", key.unit);
  if (values.size() == 1) {
    if (values.front() <= 0.0) {
      table.refuse(key.key, must_be_positive);
      return {};
    }
    values.resize(frequencies, values.front());
  }
  if (values.size() != frequencies) {
    if (!table.refused("frequencies_hz")) {
      table.refuse(key.key,
                   fmt::format("lists {} levels for {} frequencies", values.size(), frequencies));
    }
    return {};
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] <= 0.0) {
      table.refuse_entry(key.key, i, must_be_positive);
    }
  }
  return values;
}

void take_least(const LevelKey& key, const std::vector<double>& values,
                const std::vector<std::string>& frequencies_hz, std::vector<double>& levels_m_s2) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto frequency = analysis::Frequency::parse(frequencies_hz[i]);
    if (frequency && values[i] > 0.0) {
      levels_m_s2[i] = std::min(levels_m_s2[i], key.level_m_s2(values[i], frequency->hz()));
    }
  }
}

} // namespace

std::vector<double> read_levels(TomlTable& table, const std::vector<std::string>& frequencies_hz) {
  std::vector<double> levels_m_s2(frequencies_hz.size(), nothing_asked);
  bool is_asked = false;
  for (const LevelKey& key : level_keys) {
    is_asked = is_asked || table.has(key.key);
    take_least(key, spread_values(table, key, frequencies_hz.size()), frequencies_hz, levels_m_s2);
  }
  if (!is_asked) {
    table.refuse("level", "is missing: an amplitude in m/s^2, or level_velocity_m_s, or "
                          "level_displacement_mm");
  }
  std::ranges::replace(levels_m_s2, nothing_asked, 0.0); // refused above
  return levels_m_s2;
}

} // namespace dyncal::inline bench
