// Tables that laboratory and sensor file may both have: whom to write to, and the conditions of a
// calibration. Texts are UTF-8 without control characters but line breaks.
//
// Functions add what is wrong to the problems of the table. Any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/bench/file/toml_lines.hpp"

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

// Keys of a contact; name, city and country are needed.
[[nodiscard]] Contact read_contact(TomlTable& table);
[[nodiscard]] Conditions read_conditions(TomlTable& table);

} // namespace dyncal::inline views
