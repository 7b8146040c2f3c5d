#include "services/bench/file/check_table.hpp"

#include <toml++/toml.h>

#include "services/bench/file/toml_text.hpp"

namespace dyncal::inline bench {
namespace {

constexpr int least_first = 3;

std::optional<double> positive(TomlTable& table, const std::string& key, const std::string& unit) {
  const auto value = table.optional_number(key, unit);
  if (value && !(*value > 0.0)) {
    table.refuse(key, "must be above 0");
  }
  return value;
}

} // namespace

std::optional<CheckSettings> read_check(TomlTable& root) {
  auto table = root.table("check");
  if (!table) {
    return std::nullopt;
  }
  CheckSettings check;
  check.sensor = table->required_text("sensor");
  const auto max_age_h = positive(*table, "max_age_h", "h");
  if (!max_age_h) {
    table->refuse("max_age_h", "is missing: how old the newest check may be, in hours");
  }
  check.max_age_h = max_age_h.value_or(check.max_age_h);
  check.first = table->whole_number("first", check.first, least_first);
  check.limit_percent = positive(*table, "limit_percent", "%");
  check.limit_deg = positive(*table, "limit_deg", "deg");
  table->finish();
  return check;
}

std::optional<CheckSettings> check_settings_of(const std::string& bench_text) {
  const auto parsed = parse_toml(bench_text, "bench.toml");
  if (!parsed) {
    return std::nullopt;
  }
  BenchProblems problems;
  TomlTable root(*parsed, "", "bench.toml", problems);
  return read_check(root);
}

} // namespace dyncal::inline bench
