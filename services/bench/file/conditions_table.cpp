#include "services/bench/file/conditions_table.hpp"

#include <toml++/toml.h>

#include "services/bench/file/run_end_table.hpp"
#include "services/bench/file/toml_text.hpp"

namespace dyncal::inline bench {
namespace {

double positive(TomlTable& table, const std::string& key, double otherwise,
                const std::string& unit) {
  const double value = table.number(key, otherwise, unit);
  if (!(value > 0.0)) {
    table.refuse(key, "must be above 0");
  }
  return value;
}

// What a quantity is found as, and the key of its uncertainty.
struct QuantityKeys {
  const char* quantity;
  const char* unit;
  const char* expanded;
};
constexpr QuantityKeys quantity_keys[] = {{"temperature", "degC", "U_temperature_k"},
                                          {"humidity", "%", "U_humidity_percent"},
                                          {"pressure", "hPa", "U_pressure_hpa"}};

void read_quantity(TomlTable& table, const QuantityKeys& keys, ConditionSettings& settings) {
  ConditionQuantity one{keys.quantity, keys.unit, table.text(keys.quantity)};
  const auto expanded = table.optional_number(keys.expanded, keys.unit);
  if (expanded && !(*expanded > 0.0)) {
    table.refuse(keys.expanded, "must be above 0: it is the expanded uncertainty, k = 2");
  }
  if (one.place.empty() && !expanded) {
    return;
  }
  if (one.place.empty() || !expanded) {
    table.refuse(one.place.empty() ? keys.quantity : keys.expanded,
                 "is missing: where a quantity is found, and its expanded uncertainty (k = 2), go "
                 "together");
  } else if (settings.kind == "channel" && one.place.find('/') == std::string::npos) {
    table.refuse(keys.quantity, "must be \"SOURCE/CHANNEL\"");
  }
  one.expanded = expanded.value_or(0.0);
  settings.quantities.push_back(std::move(one));
}

void read_kind(TomlTable& table, ConditionSettings& settings) {
  settings.kind = table.one_of("kind", {"file", "channel", "command"}, "");
  if (settings.kind == "file") {
    settings.file = table.required_text("file");
  }
  if (settings.kind == "command") {
    if (!table.has("command")) {
      table.refuse("command", "is missing: a program and its arguments");
    }
    settings.command = read_local_command(table, "command");
  }
}

} // namespace

std::optional<ConditionSettings> read_condition_settings(TomlTable& root) {
  auto table = root.table("conditions");
  if (!table) {
    return std::nullopt;
  }
  ConditionSettings settings;
  read_kind(*table, settings);
  settings.name = table->text("name");
  settings.every_s = positive(*table, "every_s", settings.every_s, "s");
  settings.max_age_s = positive(*table, "max_age_s", settings.max_age_s, "s");
  for (const QuantityKeys& keys : quantity_keys) {
    read_quantity(*table, keys, settings);
  }
  table->finish();
  return settings;
}

std::optional<ConditionSettings> condition_settings_of(const std::string& bench_text) {
  const auto parsed = parse_toml(bench_text, "bench.toml");
  if (!parsed) {
    return std::nullopt;
  }
  BenchProblems problems;
  TomlTable root(*parsed, "", "bench.toml", problems);
  return read_condition_settings(root);
}

} // namespace dyncal::inline bench
