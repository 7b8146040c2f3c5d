// SENSOR.toml: the sensor under calibration, and what only this calibration has: the number of its
// certificate, its customer and its conditions, in place of those of the laboratory file, and the
// tolerances that it is held against.
//
// Fails (bad_file) with file, line and key, as the laboratory file does. Any thread.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "services/base/error.hpp"
#include "services/views/lab_file/contact_table.hpp"
#include "services/views/lab_file/tolerance_table.hpp"

namespace dyncal::inline views {

struct SensorFile {
  std::filesystem::path path;
  std::string name; // "digital accelerometer"
  std::string manufacturer;
  std::string model;
  std::string serial;
  std::string electronic_model;       // as it calls itself, where that is another; may be empty
  std::string electronic_serial;      // likewise
  std::string firmware;               // may be empty
  std::string owner_identification;   // the customer's own number; may be empty
  std::optional<int> interval_months; // from one calibration to the next
  std::string certificate_number;     // may be empty
  std::string received;               // YYYY-MM-DD; may be empty
  std::string condition;              // as it came: "no visible damage"; may be empty
  std::string positive_direction;     // of its axis; may be empty
  std::map<std::string, std::string> settings; // by name: "range" is "+-4 g"
  std::optional<Contact> customer;
  Conditions conditions;
  std::optional<Tolerances> tolerances;
};

[[nodiscard]] Expected<SensorFile> read_sensor_file(const std::filesystem::path& path);
[[nodiscard]] Expected<SensorFile> parse_sensor_file(std::string_view text,
                                                     const std::filesystem::path& path);

} // namespace dyncal::inline views
