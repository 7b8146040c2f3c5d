#include "services/views/lab_file/contact_table.hpp"

#include <algorithm>

#include <fmt/core.h>

namespace dyncal::inline views {
namespace {

bool is_country(const std::string& text) {
  return text.size() == 2 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
}

struct Bounds {
  double lowest;
  double highest;
};

std::optional<MeasuredCondition> condition(TomlTable& table, const std::string& key,
                                           const std::string& u_key, const std::string& unit,
                                           const Bounds& bounds) {
  const auto value = table.optional_number(key, unit);
  const auto expanded = table.optional_number(u_key, unit);
  if (value && !(*value >= bounds.lowest && *value <= bounds.highest)) {
    table.refuse(key, fmt::format("= {} must be between {} and {} {}", *value, bounds.lowest,
                                  bounds.highest, unit));
  }
  if (expanded && !(*expanded > 0.0)) {
    table.refuse(u_key, "must be above 0: it is the expanded uncertainty, k = 2");
  }
  if (value && !expanded) {
    table.refuse(u_key, fmt::format("is missing: {} needs its expanded uncertainty, k = 2", key));
  }
  if (expanded && !value) {
    table.refuse(key, fmt::format("is missing: {} is given", u_key));
  }
  return value && expanded ? std::optional(MeasuredCondition{*value, *expanded}) : std::nullopt;
}

} // namespace

bool Conditions::empty() const {
  return !temperature_degc && !humidity_percent && !pressure_hpa && mounting.empty() &&
         orientation.empty();
}

Contact read_contact(TomlTable& table) {
  Contact contact{.name = required_line(table, "name"),
                  .street = line_of(table, "street"),
                  .street_number = line_of(table, "street_number"),
                  .post_code = line_of(table, "post_code"),
                  .city = required_line(table, "city"),
                  .country = required_line(table, "country"),
                  .email = line_of(table, "email"),
                  .phone = line_of(table, "phone"),
                  .web = line_of(table, "web")};
  if (!contact.country.empty() && !is_country(contact.country)) {
    table.refuse("country", fmt::format("is \"{}\" but must be two capital letters (ISO 3166-1), "
                                        "for example \"DE\"",
                                        contact.country));
  }
  return contact;
}

Conditions read_conditions(TomlTable& table) {
  constexpr Bounds room_temperature{-100.0, 500.0};
  constexpr Bounds humidity{0.0, 100.0};
  constexpr Bounds pressure{1.0, 2000.0};
  Conditions conditions;
  conditions.temperature_degc =
      condition(table, "temperature_degc", "U_temperature_k", "degC", room_temperature);
  conditions.humidity_percent =
      condition(table, "humidity_percent", "U_humidity_percent", "%", humidity);
  conditions.pressure_hpa = condition(table, "pressure_hpa", "U_pressure_hpa", "hPa", pressure);
  conditions.mounting = line_of(table, "mounting");
  conditions.orientation = line_of(table, "orientation");
  return conditions;
}

} // namespace dyncal::inline views
