// Tolerances of a calibration: the table [conformity] (what they are from, and by which rule it is
// decided) and rows [[tolerance]], each with limits over a range of frequencies and levels. They
// stand in the sensor file, or in a file of their own.
//
// Magnitude has limits of the relative deviation from `nominal`, in per cent or dB, phase of the
// deviation from nominal_deg - 360 f nominal_delay_s in degrees; either also from the value at
// `relative_to_hz` in place of the nominal one. A decision rule is agreed with the customer
// (ISO/IEC 17025, 7.1.3): there is no default.
//
// Functions add what is wrong to the problems of the table; read_tolerance_file() fails (bad_file)
// with the first of them. Any thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/response/conformity.hpp"
#include "services/base/error.hpp"
#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline views {

enum class ToleranceUnit { percent, decibel, degree };

// "%", "dB", "deg"
[[nodiscard]] std::string symbol_of(ToleranceUnit unit);

struct ToleranceRow {
  std::string channel{}; // empty: every channel
  double from_hz = 0.0;  // both ends belong to it
  double to_hz = 0.0;
  std::optional<double> from_level_m_s2{}; // nothing: any
  std::optional<double> to_level_m_s2{};
  ToleranceUnit unit = ToleranceUnit::percent;
  double lower = 0.0; // of the deviation, in that unit
  double upper = 0.0;
  double nominal = 0.0;     // of the magnitude, in the unit of the channel
  double nominal_deg = 0.0; // of the phase
  double nominal_delay_s = 0.0;
  std::optional<double> relative_to_hz{};

  [[nodiscard]] bool is_of_phase() const { return unit == ToleranceUnit::degree; }
};

struct Tolerances {
  std::string specification{}; // what is met or not met
  analysis::DecisionRule rule = analysis::DecisionRule::guard_band;
  double guard_factor = 1.0; // w = guard_factor U
  std::vector<ToleranceRow> rows{};
};

// Nothing: the file has none. `file` is for messages.
[[nodiscard]] std::optional<Tolerances> read_tolerances(TomlTable& root, const std::string& file,
                                                        BenchProblems& problems);

[[nodiscard]] Expected<Tolerances> read_tolerance_file(const std::filesystem::path& path);
// The same from text; `path` is for messages.
[[nodiscard]] Expected<Tolerances> parse_tolerance_file(std::string_view text,
                                                        const std::filesystem::path& path);

} // namespace dyncal::inline views
