// [conditions] of a bench file: what logs the surroundings of a run.
//
//   kind = "file"           file = "logger.csv": of a data logger
//   kind = "channel"        channels of the bench's sources
//   kind = "command"        command = ["program", "argument"]: lines "NAME VALUE" that it prints
//   name = "data logger, SN 4711"   for documents
//   temperature = "Temp"    the column, the channel ("dau/temperature") or NAME; degC
//   U_temperature_k = 0.4   expanded uncertainty of a reading, k = 2
//   humidity, U_humidity_percent, pressure, U_pressure_hpa    likewise, in % and hPa
//   every_s = 60.0          between readings; the first is at the begin, the last at the end
//   max_age_s = 600.0       an older reading is none
//
// Only who conducts a run asks for it, from a file of this computer; so it is read from the text of
// the bench file when it is needed. Any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

struct ConditionQuantity {
  std::string quantity; // "temperature", "humidity", "pressure"
  std::string unit;     // "degC", "%", "hPa"
  std::string place;    // column, channel or name
  double expanded = 0.0;
};

struct ConditionSettings {
  std::string kind;                   // "file", "channel", "command"
  std::string name;                   // may be empty
  std::string file;                   // a path, relative to the bench file
  std::vector<std::string> command{}; // program and arguments
  double every_s = 60.0;
  double max_age_s = 600.0;
  std::vector<ConditionQuantity> quantities{};
};

// Nothing: nothing is logged. Adds what is wrong to the problems of the file.
[[nodiscard]] std::optional<ConditionSettings> read_condition_settings(TomlTable& root);

// Of the text of a bench file that is valid.
[[nodiscard]] std::optional<ConditionSettings> condition_settings_of(const std::string& bench_text);

} // namespace dyncal::inline bench
