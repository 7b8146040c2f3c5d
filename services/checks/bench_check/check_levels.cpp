#include <algorithm>
#include <map>
#include <string_view>

#include <fmt/core.h>

#include "analysis/base/frequency.hpp"
#include "analysis/base/sine_motion.hpp"
#include "services/checks/bench_check/checks.hpp"

namespace dyncal::inline checks::bench_check {
namespace {

struct PlannedLevel {
  std::size_t entry = 0; // of excitation.frequencies_hz
  double frequency_hz = 0.0;
  double level_m_s2 = 0.0;
};

// Of the steps whose frequency and level are valid.
std::vector<PlannedLevel> planned_levels(const ExcitationSettings& excitation) {
  std::vector<PlannedLevel> levels;
  const std::size_t steps =
      std::min(excitation.frequencies_hz.size(), excitation.levels_m_s2.size());
  for (std::size_t i = 0; i < steps; ++i) {
    const auto frequency = analysis::Frequency::parse(excitation.frequencies_hz[i]);
    if (frequency && excitation.levels_m_s2[i] > 0.0) {
      levels.push_back({i, frequency->hz(), excitation.levels_m_s2[i]});
    }
  }
  return levels;
}

// A level alone counts for all frequencies.
std::optional<std::size_t> level_entry(const BenchView& view, const PlannedLevel& planned) {
  const auto& levels = view.bench.excitation.levels_m_s2;
  const bool alike = std::ranges::all_of(levels, [&](double one) { return one == levels.front(); });
  return alike ? std::nullopt : std::optional(planned.entry);
}

// The voltage that the generator has to give; nothing when it gives none, or nobody knows.
std::optional<double> voltage_v(const BenchView& view, const PlannedLevel& planned) {
  const GeneratorSettings& generator = view.bench.generator;
  if (generator.driver == GeneratorDriver::none || !(generator.level_per_volt > 0.0) ||
      view.refused("generator.level_per_volt")) {
    return std::nullopt;
  }
  return planned.level_m_s2 / generator.level_per_volt;
}

struct Limit {
  const char* key = nullptr;
  std::optional<double> largest{};
  double planned = 0.0; // in the same unit
  const char* unit = nullptr;
  bool is_level = false; // as it was asked for
};

std::vector<Limit> limits_of(const BenchView& view, const PlannedLevel& planned) {
  const GeneratorSettings& generator = view.bench.generator;
  const double level_m_s2 = planned.level_m_s2;
  std::vector<Limit> limits{
      {"maximum_level_m_s2", generator.maximum_level_m_s2, level_m_s2, "m/s^2", true},
      {"maximum_velocity_m_s", generator.maximum_velocity_m_s,
       analysis::velocity_m_s(level_m_s2, planned.frequency_hz), "m/s"},
      {"maximum_displacement_mm", generator.maximum_displacement_mm,
       1e3 * analysis::displacement_m(level_m_s2, planned.frequency_hz), "mm"}};
  if (const auto voltage = voltage_v(view, planned)) {
    limits.push_back({"maximum_voltage_v", generator.maximum_voltage_v, *voltage, "V"});
  }
  return limits;
}

Finding beyond_limit(const BenchView& view, const PlannedLevel& planned, const Limit& limit) {
  const std::string needed =
      limit.is_level
          ? fmt::format("has {:g} m/s^2 at {:g} Hz", planned.level_m_s2, planned.frequency_hz)
          : fmt::format("of {:g} m/s^2 at {:g} Hz needs {:.4g} {}", planned.level_m_s2,
                        planned.frequency_hz, limit.planned, limit.unit);
  return view.at(Severity::error, {"excitation", "level"},
                 fmt::format("{}, above generator.{} = {:g}", needed, limit.key, *limit.largest),
                 level_entry(view, planned));
}

// Where one level holds for all frequencies, only the frequency that is farthest beyond a limit.
void check_limits(const BenchView& view, const std::vector<PlannedLevel>& levels,
                  Findings& findings) {
  std::map<std::string_view, std::pair<double, Finding>> farthest;
  for (const PlannedLevel& planned : levels) {
    for (const Limit& limit : limits_of(view, planned)) {
      if (!limit.largest || limit.planned <= *limit.largest) {
        continue;
      }
      Finding finding = beyond_limit(view, planned, limit);
      if (level_entry(view, planned)) {
        findings.push_back(std::move(finding));
      } else if (auto& [planned_most, kept] = farthest[limit.key]; limit.planned > planned_most) {
        planned_most = limit.planned;
        kept = std::move(finding);
      }
    }
  }
  for (auto& [key, kept] : farthest) {
    findings.push_back(std::move(kept.second));
  }
}

void check_missing_limits(const BenchView& view, Findings& findings) {
  const GeneratorSettings& generator = view.bench.generator;
  if (!is_instrument(generator.driver)) {
    return;
  }
  std::string missing;
  if (!generator.maximum_voltage_v) {
    missing = "maximum_voltage_v";
  }
  if (!generator.maximum_level_m_s2) {
    missing += missing.empty() ? "maximum_level_m_s2" : " and maximum_level_m_s2";
  }
  if (!missing.empty()) {
    findings.push_back(view.at(Severity::warning, {"generator"},
                               fmt::format("has no {}: nothing keeps a wrong level from exciter "
                                           "and sensor; write what they can bear",
                                           missing)));
  }
}

// The stroke of the lowest frequencies is what an exciter cannot do.
void report_extremes(const BenchView& view, const std::vector<PlannedLevel>& levels,
                     Findings& findings) {
  const auto stroke_m = [](const PlannedLevel& planned) {
    return analysis::displacement_m(planned.level_m_s2, planned.frequency_hz);
  };
  const auto widest = std::ranges::max_element(levels, {}, stroke_m);
  const auto strongest = std::ranges::max_element(levels, {}, &PlannedLevel::level_m_s2);
  const auto volts = voltage_v(view, *strongest);
  const std::string voltage =
      volts ? fmt::format(", {:.3g} V of the generator", *volts) : std::string();
  findings.push_back(view.at(
      Severity::note, {"excitation", "level"},
      fmt::format("is {:g} m/s^2 at the most (amplitude{}); the longest stroke is {:.3g} mm "
                  "(amplitude) at {:g} Hz",
                  strongest->level_m_s2, voltage, 1e3 * stroke_m(*widest), widest->frequency_hz)));
}

} // namespace

Findings check_levels(const BenchView& view) {
  Findings findings;
  const auto levels = planned_levels(view.bench.excitation);
  if (levels.empty()) {
    return findings;
  }
  check_limits(view, levels, findings);
  check_missing_limits(view, findings);
  report_extremes(view, levels, findings);
  return findings;
}

} // namespace dyncal::inline checks::bench_check
