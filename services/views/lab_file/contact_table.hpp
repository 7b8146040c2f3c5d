// Tables that laboratory and sensor file may both have: whom to write to, and the conditions of a
// calibration. Texts are UTF-8 without control characters but line breaks.
//
// Functions add what is wrong to the problems of the table. Any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline views {

struct Contact {
  std::string name;
  std::string street;
  std::string street_number;
  std::string post_code;
  std::string city;
  std::string country; // ISO 3166-1, two capital letters
  std::string email;
  std::string phone;
  std::string web;
};

// A condition with its expanded uncertainty, k = 2.
struct MeasuredCondition {
  double value = 0.0;
  double expanded = 0.0;
};

struct Conditions {
  std::optional<MeasuredCondition> temperature_degc;
  std::optional<MeasuredCondition> humidity_percent;
  std::optional<MeasuredCondition> pressure_hpa;
  std::string mounting;
  std::string orientation;

  [[nodiscard]] bool empty() const;
};

struct Equipment {
  std::string name;
  std::string manufacturer;
  std::string model;
  std::string serial;
};

// Like TomlTable::required_text() and text(), and refuses control characters.
[[nodiscard]] std::string required_line(TomlTable& table, const std::string& key);
[[nodiscard]] std::string line_of(TomlTable& table, const std::string& key);
[[nodiscard]] std::vector<std::string> lines_of(TomlTable& table, const std::string& key);

// YYYY-MM-DD, and a day that there is.
[[nodiscard]] bool is_date(const std::string& text);

// YYYY-MM-DD, from a text or a date of TOML; empty if it is not there.
[[nodiscard]] std::string date_of(TomlTable& table, const std::string& key);

// Keys of a contact; name, city and country are needed.
[[nodiscard]] Contact read_contact(TomlTable& table);
[[nodiscard]] Conditions read_conditions(TomlTable& table);
[[nodiscard]] Equipment read_equipment(TomlTable& table);

} // namespace dyncal::inline views
