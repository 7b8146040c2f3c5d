#include "services/views/lab_file/tolerance_table.hpp"

#include <array>
#include <cmath>

#include <fmt/core.h>

#include "services/base/per_enumerator.hpp"
#include "services/base/whole_file.hpp"
#include "services/views/lab_file/contact_table.hpp"
#include "services/views/lab_file/table_file.hpp"

namespace dyncal::inline views {
namespace {

constexpr std::uintmax_t max_file_bytes = 1U << 20U;

struct LimitsKey {
  const char* key;
  const char* unit;
  ToleranceUnit of;
};
constexpr std::array limits_keys{LimitsKey{"limits_percent", "%", ToleranceUnit::percent},
                                 LimitsKey{"limits_db", "dB", ToleranceUnit::decibel},
                                 LimitsKey{"limits_deg", "deg", ToleranceUnit::degree}};

// One number counts in both directions.
void take_limits(TomlTable& table, const LimitsKey& of, const std::vector<double>& limits,
                 ToleranceRow& row) {
  row.unit = of.of;
  if (limits.size() == 1) {
    row.lower = -limits.front();
    row.upper = limits.front();
  } else if (limits.size() == 2) {
    row.lower = limits.front();
    row.upper = limits.back();
  }
  if (limits.empty() || limits.size() > 2 || !(row.lower < row.upper)) {
    table.refuse(of.key, "must be one number above 0, as 5.0 for -5 to +5, or the lower and the "
                         "upper limit, as [-5.0, 3.0]");
  } else if (of.of == ToleranceUnit::degree && !(row.lower >= -180.0 && row.upper <= 180.0)) {
    table.refuse(of.key, "must be within -180 and 180: phase is known modulo one turn");
  }
}

void read_limits(TomlTable& table, ToleranceRow& row) {
  const char* known = nullptr;
  for (const LimitsKey& one : limits_keys) {
    const std::vector<double> limits = table.numbers(one.key, one.unit);
    if (!table.has(one.key) || table.refused(one.key)) {
      known = table.refused(one.key) ? one.key : known;
      continue;
    }
    if (known != nullptr) {
      table.refuse(one.key, fmt::format("stands beside '{}': a row has limits of one kind", known));
    }
    known = one.key;
    take_limits(table, one, limits, row);
  }
  if (known == nullptr) {
    table.refuse("limits_percent", "is missing: limits_percent or limits_db of the magnitude, or "
                                   "limits_deg of the phase");
  }
}

void read_range(TomlTable& table, ToleranceRow& row) {
  const auto from = table.optional_number("from_hz", "Hz");
  const auto to = table.optional_number("to_hz", "Hz");
  for (const auto& [key, value] : {std::pair("from_hz", from), std::pair("to_hz", to)}) {
    if (!value) {
      table.refuse(key, "is missing: the range of frequencies, whose ends belong to it");
    }
  }
  row.from_hz = from.value_or(1.0);
  row.to_hz = to.value_or(row.from_hz);
  if (!(row.from_hz > 0.0)) {
    table.refuse("from_hz", "must be above 0");
  }
  if (row.to_hz < row.from_hz) {
    table.refuse("to_hz", fmt::format("= {} Hz is below from_hz = {} Hz", row.to_hz, row.from_hz));
  }
  row.from_level_m_s2 = table.optional_number("from_level_m_s2", "m/s^2");
  row.to_level_m_s2 = table.optional_number("to_level_m_s2", "m/s^2");
  if (row.from_level_m_s2 && row.to_level_m_s2 && *row.to_level_m_s2 < *row.from_level_m_s2) {
    table.refuse("to_level_m_s2", "is below from_level_m_s2");
  }
}

void read_nominal(TomlTable& table, ToleranceRow& row) {
  const auto nominal = table.optional_number("nominal", "");
  row.nominal = nominal.value_or(1.0);
  row.nominal_deg = table.number("nominal_deg", 0.0, "deg");
  row.nominal_delay_s = table.number("nominal_delay_s", 0.0, "s");
  row.relative_to_hz = table.optional_number("relative_to_hz", "Hz");
  const bool is_of_phase = row.is_of_phase();
  if (!is_of_phase && !nominal && !row.relative_to_hz) {
    table.refuse("nominal", "is missing: the magnitude that the limits are of, in the unit of the "
                            "channel; or relative_to_hz, to compare with the value there");
  }
  if (nominal && (is_of_phase || row.relative_to_hz)) {
    table.refuse("nominal", "belongs to a magnitude without relative_to_hz");
  }
  if (!(row.nominal > 0.0)) {
    table.refuse("nominal", "must be above 0");
  }
  if (table.has("nominal_deg") && (!is_of_phase || row.relative_to_hz)) {
    table.refuse("nominal_deg", "belongs to limits_deg without relative_to_hz");
  }
  if (table.has("nominal_delay_s") && !is_of_phase) {
    table.refuse("nominal_delay_s", "belongs to limits_deg");
  }
  if (row.relative_to_hz && !(*row.relative_to_hz > 0.0)) {
    table.refuse("relative_to_hz", "must be above 0");
  }
}

ToleranceRow read_row(TomlTable& table) {
  ToleranceRow row{.channel = line_of(table, "channel")};
  read_range(table, row);
  read_limits(table, row);
  read_nominal(table, row);
  return row;
}

void read_rule(TomlTable& table, Tolerances& tolerances) {
  using analysis::DecisionRule;
  tolerances.specification = required_line(table, "specification");
  const std::string rule =
      table.one_of("rule", {"simple-acceptance", "guard-band", "guard-band-non-binary"}, "");
  tolerances.rule = parse_enumerator<DecisionRule>(rule).value_or(DecisionRule::guard_band);
  tolerances.guard_factor = table.number("guard_factor", 1.0, "");
  if (!(tolerances.guard_factor > 0.0)) {
    table.refuse("guard_factor", "must be above 0: the guard band is that many times U");
  }
  if (table.has("guard_factor") && tolerances.rule == DecisionRule::simple_acceptance) {
    table.refuse("guard_factor", "belongs to a rule with a guard band");
  }
}

Tolerances read_file(const toml::table& parsed, const std::filesystem::path& path,
                     BenchProblems& problems) {
  TomlTable root(parsed, "", path.string(), problems);
  auto tolerances = read_tolerances(root, path.string(), problems);
  if (!tolerances) {
    root.refuse("conformity", "is missing: the table [conformity] with specification and rule");
  }
  root.finish();
  return std::move(tolerances).value_or(Tolerances{});
}

} // namespace

std::string symbol_of(ToleranceUnit unit) {
  return per_enumerator(unit, {"%", "dB", "deg"});
}

std::optional<Tolerances> read_tolerances(TomlTable& root, const std::string& file,
                                          BenchProblems& problems) {
  Tolerances tolerances;
  auto rule = root.table("conformity");
  tolerances.rows = read_tables_of(root, "tolerance", file, problems, read_row);
  if (rule) {
    read_rule(*rule, tolerances);
    rule->finish();
  }
  if (!rule && root.has("tolerance")) {
    root.refuse("conformity", "is missing: a decision rule is agreed with the customer, as "
                              "rule = \"guard-band\" in [conformity], with its specification");
  }
  if (rule && tolerances.rows.empty()) {
    root.refuse("tolerance", "is missing: limits in rows, each begun by [[tolerance]]");
  }
  return rule ? std::optional(std::move(tolerances)) : std::nullopt;
}

Expected<Tolerances> parse_tolerance_file(std::string_view text,
                                          const std::filesystem::path& path) {
  return parse_tables(text, path, read_file);
}

Expected<Tolerances> read_tolerance_file(const std::filesystem::path& path) {
  DYNCAL_TRY(const auto text, read_whole_file(path, max_file_bytes));
  return parse_tolerance_file(text, path);
}

} // namespace dyncal::inline views
