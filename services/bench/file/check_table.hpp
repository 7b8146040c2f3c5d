// [check] of a bench file: the check that the bench demands before it measures another sensor.
//
//   sensor = "SN-4711"      the check sensor: its serial number, device or source
//   max_age_h = 24.0        how old its newest result on this bench may be when a run begins
//   first = 10              how many results its control limits are of, as `dyncal history --check`
//   limit_percent, limit_deg   action limits in their place
//
// Only who conducts a run, and who makes a document of it, asks for it; so it is read from the text
// of the bench file when it is needed. Any thread.
#pragma once

#include <optional>
#include <string>

#include "services/bench/file/toml_table.hpp"

namespace dyncal::inline bench {

struct CheckSettings {
  std::string sensor;
  double max_age_h = 24.0;
  int first = 10;
  std::optional<double> limit_percent;
  std::optional<double> limit_deg;
};

// Nothing: the bench demands no check. Adds what is wrong to the problems of the file.
[[nodiscard]] std::optional<CheckSettings> read_check(TomlTable& root);

// Of the text of a bench file that is valid.
[[nodiscard]] std::optional<CheckSettings> check_settings_of(const std::string& bench_text);

} // namespace dyncal::inline bench
