#include "services/views/lab_file/contact_table.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include <fmt/core.h>
#include <toml++/toml.h>

namespace dyncal::inline views {
namespace {

bool is_control(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return (byte < 0x20 && c != '\n' && c != '\t') || byte == 0x7f;
}

// Text that would vanish or break a document.
bool is_printable(const std::string& text) {
  return std::none_of(text.begin(), text.end(), is_control);
}

bool is_blank(const std::string& text) {
  return text.find_first_not_of(" \t\n") == std::string::npos;
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\n");
  return first == std::string::npos
             ? std::string()
             : text.substr(first, text.find_last_not_of(" \t\n") - first + 1);
}

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

bool is_date(const std::string& text) {
  const std::string pattern = "0000-00-00";
  if (text.size() != pattern.size() ||
      !std::equal(text.begin(), text.end(), pattern.begin(),
                  [](char c, char p) { return p == '-' ? c == '-' : c >= '0' && c <= '9'; })) {
    return false;
  }
  const auto number = [&](std::size_t from, std::size_t digits) {
    return std::atoi(text.substr(from, digits).c_str());
  };
  return std::chrono::year_month_day{std::chrono::year{number(0, 4)},
                                     std::chrono::month{static_cast<unsigned>(number(5, 2))},
                                     std::chrono::day{static_cast<unsigned>(number(8, 2))}}
      .ok();
}

std::string required_line(TomlTable& table, const std::string& key) {
  const std::string text = table.required_text(key);
  if (!text.empty() && is_blank(text)) {
    table.refuse(key, "must not be empty");
  }
  if (!is_printable(text)) {
    table.refuse(key, "holds a control character");
  }
  return trimmed(text);
}

std::string line_of(TomlTable& table, const std::string& key) {
  const std::string text = table.text(key);
  if (!is_printable(text)) {
    table.refuse(key, "holds a control character");
  }
  return trimmed(text);
}

std::vector<std::string> lines_of(TomlTable& table, const std::string& key) {
  std::vector<std::string> lines;
  for (const std::string& text : table.texts(key)) {
    if (!is_printable(text)) {
      table.refuse(key, "holds a control character");
    }
    if (!is_blank(text)) {
      lines.push_back(trimmed(text));
    }
  }
  return lines;
}

std::string date_of(TomlTable& table, const std::string& key) {
  const toml::node* node = table.node(key);
  if (node == nullptr) {
    return {};
  }
  if (const auto date = node->value_exact<toml::date>()) {
    return fmt::format("{:04}-{:02}-{:02}", date->year, int{date->month}, int{date->day});
  }
  const std::string text = line_of(table, key);
  if (!is_date(text)) {
    table.refuse(key, "must be a date, for example 2026-03-01");
  }
  return text;
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

Equipment read_equipment(TomlTable& table) {
  return {.name = required_line(table, "name"),
          .manufacturer = line_of(table, "manufacturer"),
          .model = line_of(table, "model"),
          .serial = line_of(table, "serial")};
}

} // namespace dyncal::inline views
